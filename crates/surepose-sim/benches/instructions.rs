//! Repeats one operation for instruction counts under callgrind; see `cargo xtask instructions`.
//!
//! `instructions NAME COUNT` runs operation NAME (`extract181`, `extract361`, `match181`) COUNT times. The
//! inputs are 600 scans along the course of the loop world.

use std::hint::black_box;
use std::process::ExitCode;

use surepose::estimation::{Belief, Ekf};
use surepose::geometry::{Angle, Pose};
use surepose::kinematics::{DiffDrive, Integration};
use surepose::lidar::{ExtractedLine, LineAssociator, LineExtractor, RangeFinder, Scan};
use surepose::map::Wall;
use surepose_sim::{Arena, LaserModel, Seed, loop_course};

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let (name, count) = (arguments.next(), arguments.next().and_then(|n| n.parse::<usize>().ok()));
    if name.as_deref() == Some("--bench") {
        println!("run `cargo xtask instructions`, which counts instructions");
        return ExitCode::SUCCESS;
    }
    let (beams, matching) = match name.as_deref() {
        Some("extract181") => (181, false),
        Some("extract361") => (361, false),
        Some("match181") => (181, true),
        _ => (0, false),
    };
    let (Some(bench), Some(count), true) = (Bench::new(beams), count, beams > 0) else {
        eprintln!("usage: instructions extract181|extract361|match181 COUNT");
        return ExitCode::from(2);
    };
    let mut extractor = Box::<LineExtractor<f64, 361>>::default();
    let associator = LineAssociator::default();
    if matching {
        let lines: Vec<_> = bench.moments.iter().map(|moment| moment.lines(&bench, &mut extractor)).collect();
        for (moment, lines) in bench.moments.iter().zip(&lines).cycle().take(count) {
            let mount = &bench.laser.body_from_laser;
            black_box(associator.associate(
                &bench.ekf,
                &moment.belief,
                mount,
                black_box(lines),
                &bench.walls,
            ));
        }
    } else {
        for moment in bench.moments.iter().cycle().take(count) {
            let seen = extractor.extract(&bench.laser, &moment.scan());
            black_box(seen.map_or(0, |seen| seen.lines.len()));
        }
    }
    ExitCode::SUCCESS
}

struct Bench {
    laser: RangeFinder<f64>,
    ekf: Ekf<f64>,
    walls: Vec<Wall<f64>>,
    moments: Vec<Moment>,
}

struct Moment {
    scan: surepose_sim::SimulatedScan,
    belief: Belief<f64>,
}

impl Bench {
    fn new(beams: usize) -> Option<Self> {
        let (model, arena) = (LaserModel::half_circle(beams), Arena::loop_world());
        let course = loop_course().ok()?;
        let mut noise = Seed(1).stream("laser");
        let mut moment = |k: u32| {
            let place = course.at(0.03 * f64::from(k)).map_from_target;
            let truth = Pose::new(place.x, place.y, place.heading);
            let scan = model.scan(arena.walls(), truth, &mut noise);
            Moment { scan, belief: Belief::new(truth, [0.002, 0.002, 0.002]) }
        };
        Some(Self {
            laser: RangeFinder {
                body_from_laser: model.body_from_laser,
                range_std: model.range_std,
                bearing_std: model.bearing_std,
                range_min: 0.0,
                range_max: model.max_range,
            },
            ekf: Ekf { drive: DiffDrive::new(0.05, 0.6), delta: 0.0025, integration: Integration::Arc },
            walls: arena.walls().iter().filter_map(|w| Wall::between(w.start, w.end).ok()).collect(),
            moments: (1..=600).map(&mut moment).collect(),
        })
    }
}

impl Moment {
    fn scan(&self) -> Scan<'_, f64> {
        let angle_min = Angle::from_radians(self.scan.angle_min);
        Scan::new(angle_min, self.scan.angle_increment, black_box(&self.scan.ranges))
    }

    fn lines(&self, bench: &Bench, extractor: &mut LineExtractor<f64, 361>) -> Vec<ExtractedLine<f64>> {
        extractor.extract(&bench.laser, &self.scan()).map_or_else(|_| Vec::new(), |seen| seen.lines.to_vec())
    }
}
