//! From headings and scans to measurements of the pose.

use surepose::{Angle, Compass, Estimator, Glance, LineExtractor, Matcher, Measurement, RangeFinder, Scan};
use surepose::{Stamped, Wall};
use surepose_data::Config;
use surepose_data::config::CompassMounting;
use surepose_sim::{Segment, Sensed};

use super::scenario::Reading;
use super::watch::{BEAMS, Sight, Watch};
use crate::survey::Survey;

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
    reading: Reading,
    walls: Vec<Wall<f64>>,
    survey: Survey,
}

impl Perception {
    /// The perception of a robot whose map has these walls; one without length is left out of the map.
    pub fn new(config: &Config, walls: &[Segment], reading: Reading) -> Self {
        let laser = config.laser();
        let walls: Vec<_> =
            walls.iter().filter_map(|wall| Wall::between(wall.start, wall.end).ok()).collect();
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
            reading,
            survey: Survey::of(&walls, |_| true),
            walls,
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
        if self.reading == Reading::Beams {
            let Ok(glance) = Glance::<f64, BEAMS>::of(&self.laser, &seen) else { return };
            let (agreement, fix) = glance.fix(&belief, &self.walls);
            if let Ok(fix) = fix
                && agreement.explained_share() >= LEAST_SHARE
            {
                let fix = fix.blurred(SCAN_STD.map(|std| std * std));
                let outcome = estimator.measure(Stamped::new(scan.stamp, Measurement::Pose(fix)));
                watch.matched(scan.stamp, outcome, 3);
            }
        } else {
            let mount = &self.laser.body_from_laser;
            let matched = self.matcher.matched(estimator.ekf(), &belief, mount, extracted.lines, &self.walls);
            for sighting in matched.sightings() {
                let outcome = estimator.measure(Stamped::new(scan.stamp, Measurement::Wall(*sighting)));
                watch.matched(scan.stamp, outcome, 2);
            }
        }
        let (laser, lines, walls) = (&self.laser, extracted.lines, &self.walls[..]);
        let chart = self.survey.chart();
        watch.looked(estimator, &Sight { stamp: scan.stamp, laser, scan: &seen, lines, walls, chart });
    }
}

/// The least part of a scan that the map explains for it to say where the robot is.
const LEAST_SHARE: f64 = 0.4;

/// What all beams of a scan may be off by on a map that was traced from a grid: x, y \[m] and heading \[rad].
///
/// What puts one scan off puts the next one off as well: a scan counts for far less than its beams by themselves.
const SCAN_STD: [f64; 3] = [0.03, 0.03, 0.3 * core::f64::consts::PI / 180.0];
