//! The simulated robot's sensors, as the core's loop hears them.

use surepose::closed_loop::{Localizer, SensorInput, SensorReading};
use surepose::{
    Angle, BeamModelMatcher, Belief, HeadingMeasurement, LineAssociator, Measurement, RangeFinder, ScanModel,
    ScanProcessor,
};
use surepose::{Scan, Stamp, Stamped, WheelOdometry};
use surepose_config::CompassParameters;
use surepose_config::Config;

use super::scenario::ScanMethod;

/// The most beams that the configuration allows.
const MAX_BEAMS: usize = 4096;

/// How many events the filter remembers: over a second of odometry at 50 Hz with headings and walls at 10 Hz.
pub const HISTORY: usize = 128;

/// What finds out where a simulated robot is.
pub type SimLocalizer = Localizer<f64, HISTORY, MAX_BEAMS>;

/// Nearer returns are the robot's own \[m].
const MIN_RANGE: f64 = 0.05;

/// Farther returns are none \[m].
const MAX_RANGE: f64 = 80.0;

/// What finds out where the robot of `config` is, starting from `belief`.
pub fn new_localizer(config: &Config, scan_method: ScanMethod, belief: Belief<f64>) -> Box<SimLocalizer> {
    let laser = config.laser();
    let laser = RangeFinder {
        body_from_laser: laser.body_from_laser,
        range_std: laser.range_std,
        bearing_std: laser.bearing_std,
        range_min: MIN_RANGE,
        range_max: MAX_RANGE,
    };
    let model = match scan_method {
        ScanMethod::Lines => ScanModel::Lines(LineAssociator::default()),
        ScanMethod::Beams => ScanModel::BeamModel(rays()),
    };
    let estimator = config.estimator(Stamp::default(), belief);
    Box::new(Localizer { estimator, scan_processor: ScanProcessor::new(laser, model) })
}

/// Gives `then` what the simulated sensors say, in the core's words, of the robot having rolled by `travel`.
pub fn with_sensor_input<T>(
    sensed: &crate::SensorOutput,
    travel: WheelOdometry<f64>,
    parameters: &CompassParameters,
    then: impl FnOnce(&SensorInput<'_, f64>) -> T,
) -> T {
    let headings = sensed.headings.iter().map(|read| {
        let compass = HeadingMeasurement { heading: read.value - parameters.offset, std: parameters.std };
        Stamped::new(read.stamp, SensorReading::Measurement(Measurement::Heading(compass)))
    });
    let scans =
        sensed.scans.iter().map(|scan| Stamped::new(scan.stamp, SensorReading::Scan(scan_view(&scan.value))));
    let signals: Vec<_> = headings.chain(scans).collect();
    then(&SensorInput { stamp: sensed.stamp, travel, readings: &signals })
}

/// The core's view of a simulated scan.
pub fn scan_view(scan: &crate::SimulatedScan) -> Scan<'_, f64> {
    Scan {
        angle_min: Angle::from_radians(scan.angle_min),
        angle_increment: scan.angle_increment,
        ranges: &scan.ranges,
    }
}

/// Scans read against walls that a grid was traced with.
///
/// What puts one scan off, a beam given to the wrong of two walls a cell apart, puts the next ones off as well: of a scan
/// by itself 3 cm and 0.3° would do, and four in a row count as one.
pub(super) fn rays() -> BeamModelMatcher<f64> {
    BeamModelMatcher { min_hit_ratio: 0.4, scan_std: [0.06, 0.06, 0.6_f64.to_radians()] }
}
