//! What calibration takes as known.

use surepose::estimation::HeadingMeasurement;
use surepose_config::Config;
use surepose_io::mines_rover::{ROVER, Rover};

use super::parameter::{CalibrationParameter, Geometry};

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

    pub(super) fn are_sound(&self) -> bool {
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
