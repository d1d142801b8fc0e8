use crate::control::Limits;
use crate::geometry::{Angle, Body, Map, Point, Pose};
use crate::kinematics::{DiffDrive, Twist};
use crate::map::Wall;
use crate::safety::{BlockReason, Footprint, Polygon};

use super::{CollisionConfig, Intent, SpeedCap};

const DRIVE: DiffDrive<f64> = DiffDrive::new(0.05, 0.36);

/// A robot 0.8 m long and 0.4 m wide, with the axle 0.1 m ahead of its rear.
fn long_robot() -> CollisionConfig<f64> {
    let corners = [(0.7, 0.2), (-0.1, 0.2), (-0.1, -0.2), (0.7, -0.2)].map(|(x, y)| Point::new(x, y));
    CollisionConfig::new(Footprint::Polygon(Polygon::new(&corners).unwrap()))
}

fn pose(x: f64, y: f64, degrees: f64) -> Pose<Map, Body, f64> {
    Pose::new(x, y, Angle::from_degrees(degrees))
}

fn cap(
    collision: &CollisionConfig<f64>,
    map_from_body: Pose<Map, Body, f64>,
    desired: Twist<f64>,
    walls: &[Wall<f64>],
    obstacles: &[Point<Map, f64>],
) -> SpeedCap<f64> {
    let limits = Limits { wheel_speed: 0.3, wheel_acceleration: 0.5, wheel_deceleration: 0.5 };
    let zero = Twist::zero();
    let intent =
        Intent { drive: &DRIVE, limits: &limits, period: 0.1, map_from_body, desired, previous: zero };
    collision.speed_cap(&intent, walls, obstacles)
}

/// The wall is the line y = 0.
fn wall() -> [Wall<f64>; 1] {
    [Wall::between(Point::new(-3.0, 0.0), Point::new(3.0, 0.0)).unwrap()]
}

/// With its side 5.2 cm from a wall, the long robot must not turn its front or its rear into the wall.
#[test]
fn long_robot_does_not_turn_into_a_wall() {
    let (collision, beside) = (long_robot(), pose(0.0, 0.252, 0.0));
    let to_wall = cap(&collision, beside, Twist::new(0.0, -0.8), &wall(), &[]);
    assert_eq!(to_wall.blocked_by, Some(BlockReason::Wall));
    // The rear is short, and only a slow turn keeps it 5 cm away.
    let from_wall = cap(&collision, beside, Twist::new(0.0, 0.8), &wall(), &[]);
    assert!(from_wall.blocked_by.is_none() && from_wall.rim_speed < 0.02, "{from_wall:?}");
    // It may drive along the wall, and a round robot of its width may turn.
    assert_eq!(cap(&collision, beside, Twist::new(0.3, 0.0), &wall(), &[]), SpeedCap::unlimited());
    let round = CollisionConfig::new(Footprint::Circle(0.2));
    assert_eq!(cap(&round, beside, Twist::new(0.0, 0.8), &wall(), &[]), SpeedCap::unlimited());
}

/// The front of the long robot, not its axle, stops before a wall and before an obstacle.
#[test]
fn front_of_the_footprint_stops_before_walls_and_obstacles() {
    let obstacle = [Point::new(0.0, 0.0), Point::new(0.01, 0.0)];
    let ahead = Twist::new(0.3, 0.0);
    // Facing the wall: 0.7 m from axle to front, 5 cm of clearance.
    for (distance, blocked) in [(0.74, true), (1.0, false)] {
        let facing = pose(0.0, distance, -90.0);
        for (walls, obstacles, reason) in
            [(&wall()[..], &[][..], BlockReason::Wall), (&[], &obstacle, BlockReason::Obstacle)]
        {
            let cap = cap(&long_robot(), facing, ahead, walls, obstacles);
            assert_eq!(cap.blocked_by, blocked.then_some(reason), "{distance} m");
        }
    }
    // A robot that is too close may back off.
    assert_eq!(
        cap(&long_robot(), pose(0.0, 0.72, -90.0), Twist::new(-0.3, 0.0), &wall(), &[]),
        SpeedCap::unlimited()
    );
}

/// A single wall encloses nothing: poses on both sides of it and beyond its ends are judged by distance alone.
#[test]
fn one_wall_leaves_both_sides_free() {
    let point = CollisionConfig::new(Footprint::Circle(0.0));
    for (x, y, distance) in [(0.0, 1.0, 1.0), (0.0, -1.0, 1.0), (4.0, 0.0, 1.0)] {
        let found = point.distance_to_walls(pose(x, y, 0.0), &wall()).unwrap();
        assert!((found - distance).abs() < 1e-12, "({x}, {y}): {found}");
    }
    assert_eq!(point.distance_to_walls(pose(0.0, 0.0, 0.0), &[]), None);
    // The distance of a polygon depends on the heading.
    let facing = long_robot().distance_to_walls(pose(0.0, 1.0, -90.0), &wall()).unwrap();
    let beside = long_robot().distance_to_walls(pose(0.0, 1.0, 0.0), &wall()).unwrap();
    assert!((facing - 0.3).abs() < 1e-12 && (beside - 0.8).abs() < 1e-12, "{facing} {beside}");
}

#[test]
fn radii_of_a_polygon_touch_its_nearest_edge_and_farthest_vertex() {
    let footprint = long_robot().footprint;
    assert!((footprint.inscribed_radius() - 0.1).abs() < 1e-12);
    assert!((footprint.circumscribed_radius() - 0.7_f64.hypot(0.2)).abs() < 1e-12);
    assert!((Footprint::from_drive(&DRIVE).circumscribed_radius() - 0.2).abs() < 1e-12);
}
