//! Sensor input of one step.

use crate::estimation::{Measurement, WheelOdometry};
use crate::kinematics::WheelPair;
use crate::lidar::Scan;
use crate::time::{Stamp, Stamped};

/// Everything that the sensors reported since the previous step.
#[derive(Clone, Copy, Debug)]
pub struct SensorInput<'a, S> {
    /// Time of this step, which is that of the odometry.
    pub stamp: Stamp,
    /// Travel of the wheels since the previous step.
    pub odometry: Odometry<S>,
    /// Readings that arrived since the previous step, in any order, each with the time of its measurement.
    pub readings: &'a [Stamped<SensorReading<'a, S>>],
}

/// What wheel odometry reported since the previous step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Odometry<S> {
    /// Travel of each rim \[m]; the filter's noise model gives the variance.
    Travel(WheelPair<S>),
    /// Travel with a variance of its own.
    WithVariance(WheelOdometry<S>),
    /// Nothing: the filter predicts by the commanded twist, and the supervisor counts the time.
    Missing,
}

/// One reading of a sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SensorReading<'a, S> {
    /// A measurement of the pose, which the filter takes as it is.
    Measurement(Measurement<S>),
    /// A scan, which the scan processor compares with the map.
    Scan(Scan<'a, S>),
}
