//! The simulated robot's sensors, as the core's loop hears them.

use surepose::closed_loop::{Localiser, Sensed, Signal};
use surepose::{Angle, Belief, Compass, Eye, Matcher, Measurement, RangeFinder, Rays, Recognition};
use surepose::{Scan, Stamp, Stamped, Travel};
use surepose_data::Config;
use surepose_data::config::CompassMounting;

use super::scenario::Reading;

/// The most beams that the configuration allows.
const MOST_BEAMS: usize = 4096;

/// How many events the filter remembers: over a second of odometry at 50 Hz with headings and walls at 10 Hz.
pub const HISTORY: usize = 128;

/// What finds out where a simulated robot is.
pub type Localisation = Localiser<f64, HISTORY, MOST_BEAMS>;

/// Nearer returns are the robot's own \[m].
const NEAREST: f64 = 0.05;

/// Farther returns are none \[m].
const FARTHEST: f64 = 80.0;

/// What finds out where the robot of `config` is, starting from `belief`.
pub fn localisation(config: &Config, reading: Reading, belief: Belief<f64>) -> Box<Localisation> {
    let laser = config.laser();
    let laser = RangeFinder {
        body_from_laser: laser.body_from_laser,
        range_std: laser.range_std,
        bearing_std: laser.bearing_std,
        nearest: NEAREST,
        farthest: FARTHEST,
    };
    let recognition = match reading {
        Reading::Lines => Recognition::Lines(Matcher::default()),
        Reading::Beams => Recognition::Rays(rays()),
    };
    let estimator = config.estimator(Stamp::default(), belief);
    Box::new(Localiser { estimator, eye: Eye::new(laser, recognition) })
}

/// Gives `then` what the simulated sensors say, in the core's words, of the robot having rolled by `travel`.
pub fn translated<T>(
    sensed: &surepose_sim::Sensed,
    travel: Travel<f64>,
    mounting: &CompassMounting,
    then: impl FnOnce(&Sensed<'_, f64>) -> T,
) -> T {
    let headings = sensed.headings.iter().map(|read| {
        let compass = Compass { heading: read.value - mounting.offset, std: mounting.std };
        Stamped::new(read.stamp, Signal::Measurement(Measurement::Compass(compass)))
    });
    let scans = sensed.scans.iter().map(|scan| Stamped::new(scan.stamp, Signal::Scan(scan_of(&scan.value))));
    let signals: Vec<_> = headings.chain(scans).collect();
    then(&Sensed { stamp: sensed.stamp, travel, signals: &signals })
}

/// The core's view of a simulated scan.
pub fn scan_of(scan: &surepose_sim::Scan) -> Scan<'_, f64> {
    Scan {
        first_bearing: Angle::wrapped(scan.first_bearing),
        bearing_step: scan.bearing_step,
        ranges: &scan.ranges,
    }
}

/// Scans read against walls that a grid was traced with.
///
/// What puts one scan off, a beam given to the wrong of two walls a cell apart, puts the next ones off as well: of a scan
/// by itself 3 cm and 0.3° would do, and four in a row count as one.
pub(super) fn rays() -> Rays<f64> {
    Rays { least_share: 0.4, scan_std: [0.06, 0.06, 0.6_f64.to_radians()] }
}
