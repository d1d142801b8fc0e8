//! Global localization: a hypothesis is accepted only after the required age.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

use std::f64::consts::{PI, TAU};

use surepose::estimation::{Ekf, HeadingMeasurement};
use surepose::geometry::{Angle, Point, Pose};
use surepose::kinematics::{DiffDrive, Integration, WheelPair};
use surepose::lidar::{LineExtractor, RangeFinder, Scan};
use surepose::localization::{AcceptanceCriteria, GlobalLocalizer, GlobalStatus};
use surepose::map::Wall;
use surepose::time::{Stamp, Stamped};

const BEAMS: usize = 240;

fn at(ticks: i64) -> Stamp {
    Stamp::from_nanoseconds(ticks * 100_000_000)
}

/// In a room with half-turn symmetry, a change of the compass selects the other hypothesis. This one starts with age 0, although
/// it takes the slot of the first.
#[test]
fn hypothesis_does_not_inherit_the_age_of_its_slot() {
    let corners = [(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0), (0.0, 0.0)].map(|(x, y)| Point::new(x, y));
    let walls: Vec<_> = corners.windows(2).map(|ends| Wall::between(ends[0], ends[1]).unwrap()).collect();
    let laser = RangeFinder {
        body_from_laser: Pose::identity(),
        range_std: 0.03,
        bearing_std: 0.004,
        range_min: 0.05,
        range_max: 20.0,
    };
    // At (1, 1.2), heading 0.
    let step = TAU / BEAMS as f64;
    let range = |k: usize| {
        let (sin, cos) = (step * k as f64 - PI).sin_cos();
        let x = if cos > 0.0 { 3.0 / cos } else { -1.0 / cos };
        let y = if sin > 0.0 { 1.8 / sin } else { -1.2 / sin };
        x.min(y)
    };
    let ranges: Vec<f64> = (0..BEAMS).map(range).collect();
    let scan = Scan::new(Angle::from_radians(-PI), step, &ranges);
    let mut extractor = LineExtractor::<f64, BEAMS>::new();
    let lines = extractor.extract(&laser, &scan).unwrap().lines.to_vec();

    let ekf = Ekf { drive: DiffDrive::new(0.05, 0.6), delta: 0.0025, integration: Integration::Arc };
    let criteria = AcceptanceCriteria { min_rotation: 0.0, ..AcceptanceCriteria::default() };
    let mut global_localizer = GlobalLocalizer::<f64, 8, 8>::new(ekf, criteria, at(0));
    let mut found_after = None;
    for tick in 1..=20 {
        global_localizer.on_odometry(at(tick), ekf.wheel_odometry(WheelPair::zero()));
        let heading = Angle::from_radians(if tick < 5 { 0.0 } else { PI });
        global_localizer.set_heading(Stamped::new(at(tick), HeadingMeasurement { heading, std: 0.01 }));
        if let GlobalStatus::Localized(belief) =
            global_localizer.update(at(tick), &laser, &scan, &lines, &walls, None)
        {
            assert!((belief.pose.x - 3.0).abs() < 0.01, "{belief:?}");
            found_after = found_after.or(Some(tick - 4));
        }
    }
    assert_eq!(found_after, Some(i64::from(criteria.min_scans)));
}
