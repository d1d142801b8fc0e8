//! From headings and scans to measurements of the pose.

use surepose::{Angle, Compass, Estimator, Measurement, Stamped};
use surepose::{LineExtractor, Matcher, RangeFinder, Scan, Wall};
use surepose_data::Config;
use surepose_data::config::CompassMounting;
use surepose_sim::{Segment, Sensed};

use super::watch::{Sight, Watch};

/// The most beams that the configuration allows.
const MOST_BEAMS: usize = 4096;

/// Nearer returns are the robot's own \[m].
const NEAREST: f64 = 0.05;

/// Farther returns are none \[m].
const FARTHEST: f64 = 80.0;

/// Turns what arrived into what the filter is told.
#[derive(Clone, Debug)]
pub struct Perception {
    compass: CompassMounting,
    laser: RangeFinder<f64>,
    extractor: Box<LineExtractor<f64, MOST_BEAMS>>,
    matcher: Matcher<f64>,
    walls: Vec<Wall<f64>>,
}

impl Perception {
    /// The perception of a robot whose map has these walls; one without length is left out of the map.
    pub fn new(config: &Config, walls: &[Segment]) -> Self {
        let laser = config.laser();
        Self {
            compass: config.compass(),
            laser: RangeFinder {
                body_from_laser: laser.body_from_laser,
                range_std: laser.range_std,
                bearing_std: laser.bearing_std,
                nearest: NEAREST,
                farthest: FARTHEST,
            },
            extractor: Box::default(),
            matcher: Matcher::default(),
            walls: walls.iter().filter_map(|wall| Wall::between(wall.start, wall.end).ok()).collect(),
        }
    }

    /// The walls of the map.
    pub fn walls(&self) -> &[Wall<f64>] {
        &self.walls
    }

    /// Corrects `estimator`, which has rolled to now, by what was sensed.
    ///
    /// What is refused is in its tally; `watch` hears of all.
    pub fn correct<const N: usize>(
        &mut self,
        estimator: &mut Estimator<f64, N>,
        sensed: &Sensed,
        watch: &mut Watch,
    ) {
        for reading in &sensed.headings {
            let compass = Compass { heading: reading.value - self.compass.offset, std: self.compass.std };
            let outcome = estimator.measure(Stamped::new(reading.stamp, Measurement::Compass(compass)));
            watch.turned(Stamped::new(reading.stamp, compass), outcome);
        }
        for scan in &sensed.scans {
            self.look(estimator, scan, watch);
        }
    }

    /// Finds walls in a scan and tells the filter of those that are on the map.
    fn look<const N: usize>(
        &mut self,
        estimator: &mut Estimator<f64, N>,
        scan: &Stamped<surepose_sim::Scan>,
        watch: &mut Watch,
    ) {
        let seen = Scan {
            first_bearing: Angle::wrapped(scan.value.first_bearing),
            bearing_step: scan.value.bearing_step,
            ranges: &scan.value.ranges,
        };
        // A scan older than the history cannot be matched, one that cannot be read says nothing.
        let Some(belief) = estimator.belief_at(scan.stamp) else { return };
        let Ok(extracted) = self.extractor.extract(&self.laser, &seen) else { return };
        let mount = &self.laser.body_from_laser;
        let matched = self.matcher.matched(estimator.ekf(), &belief, mount, extracted.lines, &self.walls);
        for sighting in matched.sightings() {
            let outcome = estimator.measure(Stamped::new(scan.stamp, Measurement::Wall(*sighting)));
            watch.matched(scan.stamp, outcome);
        }
        let (laser, lines, walls) = (&self.laser, extracted.lines, &self.walls[..]);
        watch.looked(estimator, &Sight { stamp: scan.stamp, laser, scan: &seen, lines, walls });
    }
}
