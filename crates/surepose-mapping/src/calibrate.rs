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

mod association;
mod clock;
mod fit;
mod frontal;
mod line_observation;
mod model;
mod outcome;
mod parameter;
mod recording;
pub mod simulated;
mod trajectory;
mod uncertainty;

use surepose::HeadingMeasurement;
use surepose_config::Config;
use surepose_io::mines_rover::{ROVER, Rover};

pub use outcome::{Calibration, ParameterEstimate};
pub use parameter::{COUNT, CalibrationParameter, Geometry};
pub use recording::{CalibrationRecording, StampedHeading};

use association::AssociationThresholds;
use fit::Fit;
use frontal::Singular;
use uncertainty::{Uncertainty, uncertainty};

use surepose_sim::CancelToken;

/// Minimum number of line observations for a calibration.
const MIN_RECORDS: usize = 50;

/// Initial values and sensor noise of a calibration.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Initial geometry: within about 10 % of the truth, and the laser's heading within about 20°.
    pub nominal: Geometry<f64>,
    /// Initial δ.
    pub delta: f64,
    /// Standard deviation of a range \[m].
    pub range_std: f64,
    /// Standard deviation of a beam's direction \[rad].
    pub bearing_std: f64,
    /// Minimum range of a valid return \[m].
    pub range_min: f64,
    /// Maximum range of a valid return \[m].
    pub range_max: f64,
    /// Standard deviation of a wall's distance from scan to scan, beyond the noise of the beams \[m]. Causes
    /// are uneven walls and ranges that depend on the surface.
    pub wall_distance_std: f64,
    /// Standard deviation of a wall's direction from scan to scan, beyond the noise of the beams \[rad].
    pub wall_direction_std: f64,
    /// Duration of one mirror turn \[s]; 0 if all beams of a scan are taken at once.
    pub sweep_period: f64,
    /// Whether scans are evenly spaced in time although their stamps, taken by the host, are not.
    pub scans_are_even: bool,
    /// Standard deviation of the compass \[rad].
    pub compass_std: f64,
    /// Heading of the robot in the map at the first record; `None` if it is not known.
    pub start_heading: Option<HeadingMeasurement<f64>>,
}

/// Reasons for which a calibration fails.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CalibrationError {
    /// A number in the options is not finite, or a standard deviation or radius is not positive.
    #[error(
        "options: every number must be finite, and radii, track, tick count and noise positive; check the configuration"
    )]
    BadOptions,
    /// The wheel counters have no two records at different times.
    #[error("wheel counters: no two records with different stamps; check the stamps")]
    NoTicks,
    /// Too few wall observations.
    #[error(
        "walls: too few observations (got {found}, expected at least {MIN_RECORDS}); record scans near walls"
    )]
    FewWalls {
        /// Number of wall observations.
        found: usize,
    },
    /// The normal matrix is singular.
    #[error("fit: the measurements do not determine a solution; record more motion in sight of walls")]
    Singular,
    /// The fit left the range of plausible geometries.
    #[error("fit: diverged; start with nominal values nearer to the truth")]
    Diverged,
    /// Canceled before completion.
    #[error("calibration: canceled before completion")]
    Stopped,
    /// The fit did not converge.
    #[error(
        "fit: did not converge, walls and odometry contradict each other; check the nominal geometry and the stamps"
    )]
    Unsettled,
}

impl From<Singular> for CalibrationError {
    fn from(_: Singular) -> Self {
        Self::Singular
    }
}

impl Options {
    /// Takes the initial values from a configuration.
    pub fn from_config(config: &Config) -> Self {
        let (drive, laser, compass) = (config.drive(), config.laser(), config.compass());
        let mount = laser.body_from_laser;
        Self {
            nominal: Geometry([
                drive.radius.left,
                drive.radius.right,
                drive.wheel_separation,
                mount.x,
                mount.y,
                mount.heading.radians(),
                laser.latency,
                compass.offset.radians(),
                compass.latency,
            ]),
            delta: config.ekf().delta,
            range_std: laser.range_std,
            bearing_std: laser.bearing_std,
            range_min: 0.02,
            range_max: 50.0,
            wall_distance_std: 0.0,
            wall_direction_std: 0.0,
            sweep_period: 0.0,
            scans_are_even: false,
            compass_std: compass.std,
            start_heading: None,
        }
    }

    /// Returns the options for the `mines_rover` recordings and their Hokuyo URG-04LX: 10 scans per second,
    /// 5.6 m.
    ///
    /// Its ranges scatter by 5 to 10 mm and depend on the surface by up to 1 %, hence the scatter of walls.
    pub fn rover() -> Self {
        let Rover { wheel_radius, wheel_separation, mount, .. } = ROVER;
        Self {
            nominal: Geometry([
                wheel_radius,
                wheel_radius,
                wheel_separation,
                mount.x,
                mount.y,
                mount.heading,
                0.1,
                0.0,
                0.0,
            ]),
            range_std: 0.015,
            bearing_std: 0.15_f64.to_radians(),
            range_max: 5.6,
            wall_distance_std: 0.01,
            wall_direction_std: 0.5_f64.to_radians(),
            sweep_period: 0.1,
            scans_are_even: true,
            ..Self::from_config(&Config::default())
        }
    }

    fn are_sound(&self) -> bool {
        let positive = [
            self.nominal.get(CalibrationParameter::LeftWheelRadius),
            self.nominal.get(CalibrationParameter::RightWheelRadius),
            self.nominal.get(CalibrationParameter::WheelSeparation),
            self.delta,
            self.range_std,
            self.compass_std,
        ];
        let rest = [self.bearing_std, self.wall_distance_std, self.wall_direction_std, self.sweep_period];
        positive.iter().all(|v| v.is_finite() && *v > 0.0)
            && rest.iter().all(|v| v.is_finite() && *v >= 0.0)
            && self.nominal.0.iter().all(|v| v.is_finite())
            && self.start_heading.is_none_or(|s| s.heading.radians().is_finite() && s.std.is_finite())
    }
}

/// Number of stages of a calibration.
pub const STAGES: usize = 9;

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
