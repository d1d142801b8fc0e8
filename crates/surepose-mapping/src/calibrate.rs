//! Calibration of wheel radii, wheel separation, noise factor, sensor mountings and latencies from a
//! recording.
//!
//! Wheel ticks measure how far the wheels turned; walls that are observed repeatedly measure how far the
//! robot moved. Poses, walls and parameters are estimated jointly by maximum likelihood:
//!
//! 1. *line observations*: the core extracts lines from every scan, each with its covariance;
//! 2. *association*: a line near the last observation of a wall belongs to that wall. Walls expire 1.5 s
//!    after their last observation, so no map is needed and places that look alike are not confused;
//! 3. *fit*: Gauss–Newton over all poses, walls and parameters. Variables are eliminated in order of time, so
//!    the cost is linear in the length of the recording. Outliers have reduced weight [Huber1964];
//! 4. *scatter*: δ and the scatter of the walls by restricted maximum likelihood [Harville1977]. Steps 2 to 4
//!    run twice;
//! 5. *standard errors*: the inverse normal matrix, enlarged where segments of the recording disagree by more
//!    [White1980].
//!
//! 6. *actuator*: from velocity commands, where they were recorded, delay, lag, limits and minimum speeds of the base.
//!
//! # Limitations
//! All lengths are scaled by the laser's ranges: ranges that are 1 % long make radii and wheel separation 1 %
//! too large. The standard errors do not include this scale error.
//!
//! The compass offset is relative to the map, so it requires a known map heading: [`Options::start_heading`].
//! Scans are required. Without them only the ratio of radii to wheel separation is observable, and only with
//! a compass.
//!
//! δ applies to the sampling period of the wheel counters; see `Slip` of `surepose-sim`.
//!
//! # Tested by
//! `true_values_lie_in_their_intervals`, `two_runs_of_the_rover_agree`.

mod actuator;
mod association;
mod clock;
mod error;
mod fit;
mod frontal;
mod line_observation;
mod model;
mod options;
mod outcome;
mod parameter;
mod recording;
pub mod simulated;
mod trajectory;
mod uncertainty;

pub use error::CalibrationError;
pub use options::Options;
pub use outcome::{Calibration, ParameterEstimate};
pub use parameter::{COUNT, CalibrationParameter, Geometry};
pub use recording::{CalibrationRecording, StampedCommand, StampedHeading};

use association::AssociationThresholds;
use error::MIN_RECORDS;
use fit::Fit;
use surepose_sim::CancelToken;
use uncertainty::{Uncertainty, uncertainty};

/// Number of stages of a calibration.
pub const STAGES: usize = 10;

/// Fits the parameters to a recording; `cancel` counts the [`STAGES`] and is polled between them.
///
/// # Errors
/// [`CalibrationError`], if the recording does not allow a calibration. A parameter that the motion does not
/// excite is not an error: its [`ParameterEstimate`] reports it.
pub fn calibrate(
    recording: &CalibrationRecording,
    options: &Options,
    cancel: &CancelToken,
) -> Result<Calibration, CalibrationError> {
    let stage = || {
        cancel.count();
        if cancel.is_cancelled() { Err(CalibrationError::Stopped) } else { Ok(()) }
    };
    let counts = recording.ticks_per_turn.is_finite() && recording.ticks_per_turn > 0.0;
    if !counts || !options.are_sound() {
        return Err(CalibrationError::BadOptions);
    }
    let steps = recording.steps();
    if steps.is_empty() {
        return Err(CalibrationError::NoTicks);
    }
    let even = if options.scans_are_even { clock::regularize_stamps(&recording.scans) } else { Vec::new() };
    let scans = if options.scans_are_even { &even } else { &recording.scans };
    let line_observations = line_observation::line_observations(scans, &steps, &options.nominal, options);
    if line_observations.len() < MIN_RECORDS {
        return Err(CalibrationError::FewWalls { found: line_observations.len() });
    }

    stage()?;
    let mut fit = Fit::begin(recording, &steps, &line_observations, options);
    fit.associate(AssociationThresholds { direction: 0.08, distance: 0.1, memory: 1.5 });
    fit.converge(false)?;
    stage()?;
    for _ in 0..2 {
        fit.associate(AssociationThresholds { direction: 0.06, distance: 0.1, memory: 1.5 });
        fit.converge(false)?;
        stage()?;
        fit.fit_scatter()?;
        stage()?;
        fit.converge(true)?;
        stage()?;
    }

    let Uncertainty { mut covariance, log_delta_std } = uncertainty(&fit)?;
    stage()?;
    let actuator = actuator::calibrate_actuator(recording, &options.nominal.drive());
    cancel.count();
    if let Some(start) = options.start_heading {
        let offset = CalibrationParameter::CompassOffset as usize;
        covariance[(offset, offset)] += start.std * start.std;
    }
    Ok(Calibration::new(
        fit.geometry,
        covariance,
        options.nominal,
        (fit.noise.delta, log_delta_std),
        options.start_heading.is_some(),
        options.finds_stamp.then(|| options.sweep.abs()),
        fit.noise.wall,
        (scans.len(), line_observations.len()),
    )
    .with_actuator(actuator))
}
