//! Options of a calibration: initial values and sensor noise.

use surepose::estimation::HeadingMeasurement;
use surepose_config::Config;
use surepose_io::mines_rover::{ROVER, Rover};

use super::parameter::{CalibrationParameter, Geometry};

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
    /// Time from the first beam of a scan to its last \[s], negative for beams in reverse order; 0 if all beams of a scan are
    /// taken at once.
    pub sweep: f64,
    /// Whether the latency of the laser is relative to the beam that the driver stamps, which is then determined; otherwise it
    /// is relative to the middle one.
    pub finds_stamp: bool,
    /// Whether scans are evenly spaced in time although their stamps, taken by the host, are not.
    pub scans_are_even: bool,
    /// Standard deviation of the compass \[rad].
    pub compass_std: f64,
    /// Heading of the robot in the map at the first record; `None` if it is not known.
    pub start_heading: Option<HeadingMeasurement<f64>>,
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
            sweep: 0.0,
            finds_stamp: false,
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
            // 682 of the 1024 steps of a mirror turn of 0.1 s.
            sweep: 0.1 * 681.0 / 1024.0,
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
        let rest = [self.bearing_std, self.wall_distance_std, self.wall_direction_std, self.sweep.abs()];
        positive.iter().all(|v| v.is_finite() && *v > 0.0)
            && rest.iter().all(|v| v.is_finite() && *v >= 0.0)
            && self.nominal.0.iter().all(|v| v.is_finite())
            && self.start_heading.is_none_or(|s| s.heading.radians().is_finite() && s.std.is_finite())
    }
}
