//! Line extraction from simulated scans: accuracy and consistent covariances for all lasers and extrinsics.

#![allow(clippy::unwrap_used, reason = "test helpers may panic")]

mod common;

use common::{MapPose, NEES_BAND, at, error, lines, range_finder, wall};
use surepose::estimation::{Belief, Ekf};
use surepose::geometry::{Angle, Point, Pose};
use surepose::kinematics::{DiffDrive, Integration};
use surepose::lidar::{Association, LineAssociator, LineExtractor, RangeFinder, Scan};
use surepose::map::Wall;
use surepose_sim::{Arena, LaserModel, Seed, WallSegment};

/// Statistics over many scans of one wall: mean normalized squared error and mean error.
///
/// The squared errors are χ² with 2 degrees of freedom. The mean error is in units of its standard error.
fn statistics(laser: &LaserModel, place: MapPose, segment: WallSegment, wall: &Wall<f64>) -> (f64, [f64; 2]) {
    let runs = 2000;
    let mut noise = Seed(17).stream("laser");
    let (mut nees, mut bias, mut square, mut count) = (0.0, [0.0; 2], [0.0; 2], 0.0);
    for _ in 0..runs {
        let scan = laser.scan(&[segment], place, &mut noise);
        for line in lines(laser, &scan) {
            let (e, n) = error(&line, wall, place * laser.body_from_laser);
            nees += n;
            count += 1.0;
            for k in 0..2 {
                bias[k] += e[k];
                square[k] += e[k] * e[k];
            }
        }
    }
    assert!((count - f64::from(runs)).abs() < 0.01 * f64::from(runs), "one line a scan: {count}");
    (nees / count, [0, 1].map(|k| bias[k] / square[k].sqrt()))
}

#[test]
fn covariance_is_consistent_near_far_and_at_grazing_angles() {
    for (beams, segment, name) in [
        (181, ((2.0, -1.0), (2.0, 1.0)), "ahead"),
        (181, ((1.5, 1.0), (4.0, 1.2)), "to the side, far from the foot of the perpendicular"),
        (181, ((0.8, -0.9), (4.5, -0.7)), "grazing"),
        (181, ((5.0, 1.0), (5.0, 2.5)), "far and short"),
        (361, ((2.8, 3.0), (3.5, 3.0)), "short and far from the foot"),
    ] {
        let (segment, wall) = wall(segment.0, segment.1);
        let (nees, bias) = statistics(&LaserModel::half_circle(beams), at(0.0, 0.0, 0.0), segment, &wall);
        assert!((nees - 2.0).abs() < NEES_BAND, "{name}: {nees}");
        assert!(bias.iter().all(|b| b.abs() < 5.0), "{name}: {bias:?} standard errors");
    }
}

#[test]
fn covariance_is_consistent_for_all_extrinsics_and_beam_orders() {
    let base = LaserModel::half_circle(361);
    let (segment, wall) = wall((1.0, 2.0), (4.0, 2.5));
    for (name, laser, place) in [
        (
            "clockwise",
            LaserModel { angle_min: 1.6, angle_increment: -base.angle_increment, ..base },
            at(1.0, 0.5, 60.0),
        ),
        (
            "off-center, backward",
            LaserModel { body_from_laser: Pose::new(0.2, -0.1, Angle::from_degrees(180.0)), ..base },
            at(2.0, 0.5, -80.0),
        ),
        (
            "full circle, seam on the wall",
            LaserModel { angle_min: 0.0, angle_increment: 2.0 * base.angle_increment, ..base },
            at(2.0, 0.5, 80.0),
        ),
    ] {
        let (nees, _) = statistics(&laser, place, segment, &wall);
        assert!((nees - 2.0).abs() < NEES_BAND, "{name}: {nees}");
    }
}

#[test]
fn closed_room_with_missing_returns_gives_three_lines() {
    let laser = LaserModel { lost: 0.2, ..LaserModel::half_circle(361) };
    let arena = Arena::rectangle("room", (0.0, 0.0), (5.0, 4.0), &[]);
    let mut noise = Seed(2).stream("laser");
    for _ in 0..50 {
        let scan = laser.scan(arena.walls(), at(1.0, 2.0, 0.0), &mut noise);
        let lines = lines(&laser, &scan);
        assert_eq!(lines.len(), 3, "{lines:?}");
        for (line, distance) in lines.iter().zip([2.0, 4.0, 2.0]) {
            assert!((line.line.distance - distance).abs() < 0.03, "{line:?}");
        }
    }
}

/// A plate hides the middle of a wall, which still gives one line.
#[test]
fn pieces_of_one_wall_merge() {
    let laser = LaserModel::half_circle(361);
    let (back, plate) =
        (WallSegment::between((3.0, -3.0), (3.0, 3.0)), WallSegment::between((2.0, -0.4), (2.0, 0.4)));
    let mut noise = Seed(5).stream("laser");
    for _ in 0..50 {
        let scan = laser.scan(&[back, plate], at(0.0, 0.0, 0.0), &mut noise);
        let lines = lines(&laser, &scan);
        assert_eq!(lines.len(), 2, "{lines:?}");
        let wall = lines.iter().find(|line| line.line.distance > 2.5).unwrap();
        assert!(wall.extent.0 < -2.5 && wall.extent.1 > 2.5, "{wall:?}");
    }
}

/// The line of the plate crosses the wall behind it near an end. That is no corner; the beams belong to the
/// wall.
#[test]
fn plate_does_not_take_beams_from_the_wall_behind() {
    let laser = LaserModel::half_circle(181);
    let place = at(1.5, 1.9, -90.0);
    let (floor, plate) = (WallSegment::between((0.0, 0.0), (6.0, 0.0)), ((5.2, 0.6), (5.2, 1.6)));
    let (plate, wall) = wall(plate.0, plate.1);
    let mut noise = Seed(6).stream("laser");
    let (mut nees, mut count) = (0.0, 0.0);
    for _ in 0..2000 {
        let scan = laser.scan(&[floor, plate], place, &mut noise);
        for line in &lines(&laser, &scan) {
            let ([_, direction], squared) = error(line, &wall, place * laser.body_from_laser);
            if direction.abs() < 0.5 {
                nees += squared;
                count += 1.0;
            }
        }
    }
    assert!(count > 1900.0, "{count}");
    assert!((nees / count - 2.0).abs() < NEES_BAND, "{}", nees / count);
}

#[test]
fn f32_extracts_the_same_lines_as_f64() {
    let model = LaserModel::half_circle(361);
    let mut noise = Seed(9).stream("laser");
    let wide = range_finder(&model);
    let narrow: RangeFinder<f32> = RangeFinder {
        body_from_laser: Pose::identity(),
        range_std: wide.range_std as f32,
        bearing_std: wide.bearing_std as f32,
        range_min: 0.0,
        range_max: 8.0,
    };
    let mut extractor = Box::<LineExtractor<f32, 361>>::default();
    let (mut same, mut all) = (0, 0);
    for k in 0..100 {
        let place = at(1.5 + 0.03 * f64::from(k), 1.0, f64::from(k));
        let scan = model.scan(Arena::loop_world().walls(), place, &mut noise);
        let ranges: Vec<f32> = scan.ranges.iter().map(|range| *range as f32).collect();
        let single =
            Scan::new(Angle::from_radians(scan.angle_min as f32), scan.angle_increment as f32, &ranges);
        let seen = extractor.extract(&narrow, &single).unwrap().lines;
        for line in lines(&model, &scan) {
            all += 1;
            same += usize::from(seen.iter().any(|other| {
                let off = (f64::from(other.line.distance) - line.line.distance).abs();
                off < 0.05 * line.distance_variance.sqrt() && other.beams == line.beams
            }));
        }
    }
    assert!(same * 100 >= all * 98, "{same} of {all} lines within 0.05 standard deviations");
}

fn ekf() -> Ekf<f64> {
    Ekf { drive: DiffDrive::new(0.05, 0.6), delta: 0.0025, integration: Integration::Arc }
}

fn numbers(
    place: MapPose,
    std: [f64; 3],
    laser: &LaserModel,
    world: &[WallSegment],
    map: &[Wall<f64>],
) -> Vec<Option<usize>> {
    let scan = laser.scan(world, place, &mut Seed(4).stream("laser"));
    let lines = lines(laser, &scan);
    let associations = LineAssociator::default().associate(
        &ekf(),
        &Belief::new(place, std),
        &laser.body_from_laser,
        &lines,
        map,
    );
    let number = |association: &Association<f64>| match association {
        Association::Wall { number, .. } => Some(*number),
        _ => None,
    };
    associations.as_slice().iter().map(number).collect()
}

#[test]
fn plates_associate_from_both_sides_at_their_position_only() {
    let laser = LaserModel::half_circle(181);
    let (segment, plate) = wall((2.0, -0.5), (2.0, 0.5));
    let beside = Wall::between(Point::new(2.0, 2.0), Point::new(2.0, 3.0)).unwrap();
    let known = [0.02, 0.02, 0.01];
    assert_eq!(numbers(at(0.5, 0.0, 0.0), known, &laser, &[segment], &[beside, plate]), [Some(1)]);
    assert_eq!(numbers(at(3.5, 0.0, 180.0), known, &laser, &[segment], &[beside, plate]), [Some(1)]);
    assert_eq!(numbers(at(0.5, 0.0, 0.0), known, &laser, &[segment], &[beside]), [None]);
}

/// The belief error exceeds the 10 cm between the parallel walls; the other wall of the corner resolves the
/// ambiguity.
#[test]
fn close_parallel_walls_are_disambiguated_by_neighbors() {
    let laser = LaserModel::half_circle(361);
    let (front_segment, front) = wall((2.0, -1.0), (2.0, 1.0));
    let recess = Wall::between(Point::new(2.1, -1.0), Point::new(2.1, 1.0)).unwrap();
    let vague = [0.15, 0.15, 0.01];
    assert_eq!(numbers(at(0.0, 0.0, 0.0), vague, &laser, &[front_segment], &[front, recess]), [None]);
    // A wall at 45° couples x and y; a second wall determines both.
    let (left_segment, left) = wall((0.3, 1.6), (1.6, 1.8));
    let (right_segment, right) = wall((0.3, -0.7), (1.8, -1.9));
    let world = [front_segment, left_segment, right_segment];
    let resolved = numbers(at(0.0, 0.0, 0.0), vague, &laser, &world, &[front, recess, left, right]);
    assert_eq!(resolved, [Some(3), Some(0), Some(2)]);
}
