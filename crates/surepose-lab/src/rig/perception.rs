//! From headings and scans to measurements of the pose.

use surepose::{Aligner, AlignerMemory, Alignment, Angle, Compass, Estimator, Gate, Measurement, Stamped};
use surepose::{LineExtractor, Matcher, RangeFinder, Scan, Wall};
use surepose_data::Config;
use surepose_data::config::CompassMounting;
use surepose_sim::{Segment, Sensed};

use super::scenario::Reading;
use super::watch::{Sight, Watch};
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
    /// Where scans are read beam by beam: how, and the memory for it.
    aligner: Option<(Aligner<f64>, Box<AlignerMemory<f64, MOST_BEAMS>>)>,
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
            aligner: (reading == Reading::Beams).then(|| (aligner(), Box::default())),
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
        if let Some((aligner, memory)) = &mut self.aligner {
            let aligned = aligner.align(memory, estimator.ekf(), &belief, &self.laser, &seen, &self.walls);
            if let Ok(Alignment::Found(aligned)) = aligned {
                let outcome = estimator.measure(Stamped::new(scan.stamp, Measurement::Pose(aligned.fix)));
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

/// Scans laid on walls that a grid was traced with.
///
/// What puts one scan off, a beam given to the wrong of two walls a cell apart, puts the next one off as well: a scan
/// counts for far less than its beams by themselves.
fn aligner() -> Aligner<f64> {
    Aligner {
        gate: Gate::new(0.999),
        farthest_off: 0.5,
        fewest_beams: 3,
        least_share: 0.4,
        wall_offset_std: 0.01,
        wall_direction_std: 0.005,
        scan_std: [0.03, 0.03, 0.3_f64.to_radians()],
    }
}
