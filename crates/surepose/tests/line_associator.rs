//! Association of lines with walls: ambiguous lines get no wall, and no wall gets two lines.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

use surepose::estimation::{Belief, Ekf};
use surepose::geometry::{Angle, Laser, Line, Point, Pose};
use surepose::kinematics::{DiffDrive, Integration};
use surepose::lidar::{Association, ExtractedLine, LineAssociator};
use surepose::map::Wall;

fn ekf() -> Ekf<f64> {
    Ekf { drive: DiffDrive::new(0.05, 0.6), delta: 0.0025, integration: Integration::Arc }
}

/// Creates a line 10 m ahead, from `extent.0` to `extent.1` beside the foot of its normal.
fn seen(extent: (f64, f64), beams: u16) -> ExtractedLine<f64> {
    let line: Line<Laser, f64> = Line::new(10.0, Angle::zero());
    ExtractedLine {
        line,
        distance_variance: 1e-4,
        direction_variance: 1e-6,
        covariance: 0.0,
        extent,
        beams,
        reduced_chi2: 1.0,
    }
}

/// One line fits more walls than its candidate list holds; another line fits only the long wall. The long wall is assigned once,
/// also when the first line is tested again.
#[test]
fn each_wall_is_assigned_once_even_with_many_candidates() {
    let wall = |x: f64, from: f64, to: f64| Wall::between(Point::new(x, from), Point::new(x, to)).unwrap();
    for shorts in [4, 6, 8, 12] {
        let mut walls = vec![wall(10.0, -1.0, 8.0)];
        for k in 0..shorts {
            let apart = 0.25 * f64::from(1 + k / 2) * if k % 2 == 0 { 1.0 } else { -1.0 };
            walls.push(wall(10.0 + apart, -1.0, 1.5));
        }
        let belief = Belief::new(Pose::identity(), [0.6, 0.05, 0.005]);
        let lines = [seen((5.0, 7.0), 50), seen((0.0, 1.0), 20)];
        let associations =
            LineAssociator::default().associate(&ekf(), &belief, &Pose::identity(), &lines, &walls);
        let [first, second] = associations.as_slice() else { panic!("two lines") };
        assert!(matches!(first, Association::Wall { number: 0, .. }), "{shorts}: {first:?}");
        assert!(!matches!(second, Association::Wall { number: 0, .. }), "{shorts}: {second:?}");
    }
}
