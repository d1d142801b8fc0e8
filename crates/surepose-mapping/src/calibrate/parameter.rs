//! Calibrated parameters of the geometry and their order.

use core::f64::consts::PI;

use surepose::geometry::{Angle, Body, Laser, Pose};
use surepose::kinematics::{DiffDrive, WheelPair};
use surepose::param;
use surepose::param::Unit;
use surepose::scalar::Scalar;

/// Number of geometry parameters.
pub const COUNT: usize = 9;

/// Maximum ratio of posterior to prior standard deviation of an excited parameter.
const EXCITED: f64 = 0.1;

/// A parameter of the geometry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CalibrationParameter {
    /// Radius of the left drive wheel.
    LeftWheelRadius,
    /// Radius of the right drive wheel.
    RightWheelRadius,
    /// Distance between the wheels' contact points.
    WheelSeparation,
    /// Position of the laser ahead of the axle.
    LaserX,
    /// Position of the laser to the left of the robot's center line.
    LaserY,
    /// Direction of the laser's zero bearing.
    LaserHeading,
    /// Time from measurement to stamp of a scan.
    LaserLatency,
    /// Compass reading of a robot that faces along the map's x axis.
    CompassOffset,
    /// Time from measurement to stamp of a heading.
    CompassLatency,
}

impl CalibrationParameter {
    /// Every parameter, in the order of [`Geometry`].
    pub const ALL: [Self; COUNT] = [
        Self::LeftWheelRadius,
        Self::RightWheelRadius,
        Self::WheelSeparation,
        Self::LaserX,
        Self::LaserY,
        Self::LaserHeading,
        Self::LaserLatency,
        Self::CompassOffset,
        Self::CompassLatency,
    ];

    /// Returns the name in JSON, with its display unit.
    pub const fn name(self) -> &'static str {
        match self {
            Self::LeftWheelRadius => "left_wheel_radius_m",
            Self::RightWheelRadius => "right_wheel_radius_m",
            Self::WheelSeparation => "track_m",
            Self::LaserX => "laser_x_m",
            Self::LaserY => "laser_y_m",
            Self::LaserHeading => "laser_heading_deg",
            Self::LaserLatency => "laser_latency_s",
            Self::CompassOffset => "compass_offset_deg",
            Self::CompassLatency => "compass_latency_s",
        }
    }

    /// Returns the display unit.
    pub const fn unit(self) -> Unit {
        match self {
            Self::LaserHeading | Self::CompassOffset => Unit::Degree,
            Self::LaserLatency | Self::CompassLatency => Unit::Second,
            _ => Unit::Meter,
        }
    }

    /// Returns the key of the configuration; `None` for the radii, which have mean and ratio instead, see
    /// [`super::Calibration`].
    pub const fn key(self) -> Option<&'static param::Parameter> {
        match self {
            Self::LeftWheelRadius | Self::RightWheelRadius => None,
            Self::WheelSeparation => Some(&param::WHEEL_SEPARATION),
            Self::LaserX => Some(&param::LASER_X),
            Self::LaserY => Some(&param::LASER_Y),
            Self::LaserHeading => Some(&param::LASER_HEADING),
            Self::LaserLatency => Some(&param::LASER_LATENCY),
            Self::CompassOffset => Some(&param::COMPASS_OFFSET),
            Self::CompassLatency => Some(&param::COMPASS_LATENCY),
        }
    }

    /// Describes the motion that excites the parameter.
    pub const fn excitation(self) -> &'static str {
        match self {
            Self::LeftWheelRadius | Self::RightWheelRadius | Self::LaserHeading => {
                "driving in sight of walls that lie across the way"
            }
            Self::WheelSeparation => "turning in sight of walls",
            Self::LaserX => "turning in sight of walls on several sides",
            Self::LaserY => "turning both ways in sight of walls",
            Self::LaserLatency => "turning with a changing rate in sight of walls",
            Self::CompassOffset => "a compass, and a start whose heading in the map is known",
            Self::CompassLatency => "a compass, and turning with a changing rate",
        }
    }

    /// Returns whether a standard error of `std` is much smaller than the prior.
    pub(super) fn is_excited(self, std: f64, nominal: &Geometry<f64>) -> bool {
        std <= EXCITED * self.prior_std(nominal)
    }

    /// Returns the standard deviation of the nearly uninformative prior.
    pub(super) fn prior_std(self, nominal: &Geometry<f64>) -> f64 {
        match self {
            Self::LeftWheelRadius | Self::RightWheelRadius | Self::WheelSeparation => {
                0.3 * nominal.0[self as usize]
            }
            Self::LaserX | Self::LaserY => 0.3,
            Self::LaserHeading => PI / 6.0,
            Self::LaserLatency | Self::CompassLatency => 0.2,
            Self::CompassOffset => PI,
        }
    }
}

/// Values of all parameters in SI units and radians, in the order of [`CalibrationParameter::ALL`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geometry<S>(pub [S; COUNT]);

impl<S: Scalar> Geometry<S> {
    /// Returns the value of `parameter`.
    pub fn get(&self, parameter: CalibrationParameter) -> S {
        self.0[parameter as usize]
    }

    /// Returns the wheel geometry.
    pub fn drive(&self) -> DiffDrive<S> {
        let (right, left) = (
            self.get(CalibrationParameter::RightWheelRadius),
            self.get(CalibrationParameter::LeftWheelRadius),
        );
        DiffDrive {
            radius: WheelPair::new(right, left),
            wheel_separation: self.get(CalibrationParameter::WheelSeparation),
        }
    }

    /// Replaces the mounting of the laser.
    #[must_use]
    pub fn with_laser(mut self, body_from_laser: Pose<Body, Laser, S>) -> Self {
        let Pose { x, y, heading, .. } = body_from_laser;
        self.0[CalibrationParameter::LaserX as usize] = x;
        self.0[CalibrationParameter::LaserY as usize] = y;
        self.0[CalibrationParameter::LaserHeading as usize] = heading.radians();
        self
    }

    /// Returns the mounting of the laser.
    pub fn body_from_laser(&self) -> Pose<Body, Laser, S> {
        let heading = Angle::from_radians(self.get(CalibrationParameter::LaserHeading));
        Pose::new(self.get(CalibrationParameter::LaserX), self.get(CalibrationParameter::LaserY), heading)
    }
}
