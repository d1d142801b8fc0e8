//! Calibration: wheel radii, track, noise factor, sensor mountings and latencies, from a recording.
//!
//! Wheel ticks say how far the wheels turned, walls seen again say how far the robot came. Poses, walls and parameters
//! are found together, by maximum likelihood:
//!
//! 1. *line observations*: the lines of every scan, as the core finds them, each with its covariance;
//! 2. *association*: a line near where a wall was last seen is that wall; a wall out of sight for 1.5 s is forgotten, so
//!    no map is needed and a place that looks like another does no harm;
//! 3. *fit*: Gauss–Newton over all poses, walls and parameters at once. Unknowns leave in the order of time, so the cost
//!    grows with the length of the recording only. Residuals far out count less [Huber1964];
//! 4. *scatter*: δ and the scatter of the walls by restricted maximum likelihood [Harville1977], and 2 to 4 once more;
//! 5. *standard errors*: the inverse normal matrix, enlarged where stretches of the recording disagree by more [White1980].
//!
//! # What it cannot tell
//! All lengths are in the laser's metres: a laser whose ranges are 1 % long makes wheels and track 1 % too large.
//! The standard errors do not contain that.
//!
//! The compass' offset is that against the map, so a heading in the map must be known: [`Options::start_heading`].
//! Without scans nothing is known but the ratio of radii to track, and only with a compass: scans are required.
//!
//! δ belongs to the period of the wheel counters: see `Slip` of `surepose-sim`.
//!
//! # Tested by
//! `true_values_lie_in_their_intervals`, `two_runs_of_the_rover_agree`.

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
pub use recording::{CalibrationRecording, StampedHeading};

use association::AssociationThresholds;
use error::MIN_RECORDS;
use fit::Fit;
use surepose_sim::CancelToken;
use uncertainty::{Uncertainty, uncertainty};

/// How many stages a calibration has.
pub const STAGES: usize = 9;

/// Fits the parameters to a recording; `cancel` counts the [`STAGES`], and may end it between two.
///
/// # Errors
/// A recording that does not allow it, see [`CalibrationError`]. A parameter that the motion did not excite is no error:
/// its [`ParameterEstimate`] says so.
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
        fit.noise.wall,
        (scans.len(), line_observations.len()),
    ))
}
