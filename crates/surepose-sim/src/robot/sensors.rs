//! Conversion of the simulated sensors' output to the input of a step.

use surepose::estimation::{HeadingMeasurement, Measurement};
use surepose::geometry::Angle;
use surepose::lidar::{Scan, ScanTiming};
use surepose::localization::{Odometry, SensorInput, SensorReading};
use surepose::time::Stamped;
use surepose_config::CompassParameters;

use crate::{SensorOutput, SimulatedScan};

/// Calls `then` with the input of a step.
pub fn with_sensor_input<T>(
    output: &SensorOutput,
    parameters: &CompassParameters,
    timing: &ScanTiming,
    then: impl FnOnce(&SensorInput<'_, f64>) -> T,
) -> T {
    let headings = output.headings.iter().map(|read| {
        let compass = HeadingMeasurement { heading: read.value - parameters.offset, std: parameters.std };
        Stamped::new(read.stamp, SensorReading::Measurement(Measurement::Heading(compass)))
    });
    let scans = output.scans.iter().map(|scan| {
        let scan = timing.resolve(Stamped::new(scan.stamp, scan_view(&scan.value)));
        Stamped::new(scan.stamp, SensorReading::Scan(scan.value))
    });
    let rate = output.yaw_rate.map(|rate| Stamped::new(output.stamp, SensorReading::YawRate(rate)));
    let readings: Vec<_> = rate.into_iter().chain(headings).chain(scans).collect();
    then(&SensorInput {
        stamp: output.stamp,
        odometry: Odometry::WheelTravel(output.rims),
        readings: &readings,
    })
}

/// A simulated scan as the core takes it.
pub fn scan_view(scan: &SimulatedScan) -> Scan<'_, f64> {
    Scan::new(Angle::from_radians(scan.angle_min), scan.angle_increment, &scan.ranges)
        .with_time_increment(scan.time_increment)
}
