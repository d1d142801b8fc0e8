//! Sensor input of one step.

use crate::estimation::{Measurement, WheelOdometry};
use crate::kinematics::WheelPair;
use crate::lidar::Scan;
use crate::time::{Stamp, Stamped};

/// All sensor data since the previous step.
#[derive(Clone, Copy, Debug)]
pub struct SensorInput<'a, S> {
    /// Time of this step and of its odometry.
    pub stamp: Stamp,
    /// Travel of the wheels since the previous step.
    pub odometry: Odometry<S>,
    /// Readings that arrived since the previous step, in any order, each with its time of measurement.
    pub readings: &'a [Stamped<SensorReading<'a, S>>],
}

/// Wheel odometry since the previous step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Odometry<S> {
    /// Travel of each wheel rim \[m]; the noise model of the filter gives the variance.
    WheelTravel(WheelPair<S>),
    /// Travel with its own variance.
    WithVariance(WheelOdometry<S>),
    /// No odometry: the filter predicts by the commanded twist, and the supervisor counts the time.
    Missing,
}

/// One reading of a sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SensorReading<'a, S> {
    /// A measurement of the pose, used directly by the filter.
    Measurement(Measurement<S>),
    /// A scan, which the scan processor compares with the map.
    Scan(Scan<'a, S>),
    /// Yaw rate of a gyroscope \[rad/s], counter-clockwise, with its bias. Readings since the previous step measure the turn of
    /// this step; older ones are too late and ignored.
    YawRate(S),
}
