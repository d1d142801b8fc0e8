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

use surepose::estimation::HeadingMeasurement;
use surepose_config::Config;
use surepose_io::mines_rover::{ROVER, Rover};

pub use outcome::{Calibration, ParameterEstimate};
pub use parameter::{COUNT, CalibrationParameter, Geometry};
pub use recording::{CalibrationRecording, StampedHeading};

use association::AssociationThresholds;
use fit::Fit;
use frontal::Singular;
use surepose_sim::CancelToken;
use uncertainty::{Uncertainty, uncertainty};

/// The fewest line observations of walls that are worth a try.
const MIN_RECORDS: usize = 50;

/// What is known beforehand.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Where to begin; within some 10 % of the truth, and the laser's heading within some 20°.
    pub nominal: Geometry<f64>,
    /// Where δ begins.
    pub delta: f64,
    /// Standard deviation of a range \[m].
    pub range_std: f64,
    /// Standard deviation of a beam's direction \[rad].
    pub bearing_std: f64,
    /// Nearer returns are none \[m].
    pub range_min: f64,
    /// Farther returns are none \[m].
    pub range_max: f64,
    /// How a wall's distance scatters from scan to scan beyond what the beams' noise explains \[m]: walls that are not
    /// quite straight, ranges that depend on what is met.
    pub wall_distance_std: f64,
    /// How a wall's direction does \[rad].
    pub wall_direction_std: f64,
    /// How long the mirror takes for one turn \[s]; 0 for scans that are taken at one moment.
    pub sweep_period: f64,
    /// Whether the scanner turns evenly and the stamps do not, because the host noted scans when it had the time.
    pub scans_are_even: bool,
    /// Standard deviation of the compass \[rad].
    pub compass_std: f64,
    /// The robot's heading in the map at the first record, where it is known.
    pub start_heading: Option<HeadingMeasurement<f64>>,
}

/// Why there is no calibration.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CalibrationError {
    /// A number in the options is not finite, or a standard deviation or radius not positive.
    #[error(
        "the options hold a number that is not finite, or a radius, track, tick count or noise that is not positive"
    )]
    BadOptions,
    /// The wheels' counters have no two records of different times.
    #[error("the wheel counters have no two records of different times; are the stamps right?")]
    NoTicks,
    /// Too few walls were seen.
    #[error(
        "walls were seen {found} times, and it takes {MIN_RECORDS}: calibration needs a laser among walls"
    )]
    FewWalls {
        /// How often.
        found: usize,
    },
    /// Something is not determined at all.
    #[error("the measurements determine no solution")]
    Singular,
    /// The fit left what a robot can be.
    #[error("the fit diverged: begin nearer to the truth")]
    Diverged,
    /// Somebody ended it before it was done.
    #[error("ended before it was done")]
    Stopped,
    /// The fit did not settle.
    #[error("the fit did not settle: walls and odometry contradict each other")]
    Unsettled,
}

impl From<Singular> for CalibrationError {
    fn from(_: Singular) -> Self {
        Self::Singular
    }
}

impl Options {
    /// What a configuration says.
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

    /// What is known of the `mines_rover` recordings and their Hokuyo URG-04LX: 600 turns a minute, 5.6 m.
    ///
    /// Its ranges scatter by 5 to 10 mm and are up to 1 % off by what they meet: hence the scatter of walls.
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
