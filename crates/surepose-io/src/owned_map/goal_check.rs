//! Goals that the walls of the map rule out.

use surepose::geometry::{Goal, Map, Point, Pose};
use surepose::safety::CollisionConfig;

use super::OwnedMap;
use super::regions::are_separated;

/// Reason why the walls of the map rule a goal out.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum GoalProblem {
    /// The footprint at the goal is too close to a wall.
    #[error(
        "is too close to the wall from ({:.2}, {:.2}) to ({:.2}, {:.2}): {clearance:.2} m to the footprint, {required:.2} m required",
        .wall[0].x, .wall[0].y, .wall[1].x, .wall[1].y
    )]
    TooClose {
        /// Distance from the footprint to the wall \[m]; 0 in contact.
        clearance: f64,
        /// Required distance \[m].
        required: f64,
        /// Ends of the wall.
        wall: [Point<Map, f64>; 2],
    },
    /// Walls enclose the goal or the robot, and leave no opening between them that the robot fits through.
    #[error(
        "is separated from the robot by walls without an opening of {width:.2} m, the width of the footprint"
    )]
    Separated {
        /// Width of the footprint \[m].
        width: f64,
    },
}

impl OwnedMap {
    /// Checks that the footprint has room at the goal, and that no closed walls separate it from the robot.
    ///
    /// `robot` is the position of the robot; `None` skips the second check. A wall on the straight path is no problem here.
    ///
    /// # Errors
    /// [`GoalProblem`].
    pub fn check_goal(
        &self,
        collision: &CollisionConfig<f64>,
        robot: Option<Point<Map, f64>>,
        map_from_goal: Pose<Map, Goal, f64>,
    ) -> Result<(), GoalProblem> {
        let at_goal = Pose::new(map_from_goal.x, map_from_goal.y, map_from_goal.heading);
        let required = collision.wall_clearance;
        let distances = self.walls.iter().filter_map(|wall| {
            let distance = collision.distance_to_walls(at_goal, std::slice::from_ref(wall))?;
            Some((distance, wall))
        });
        if let Some((clearance, wall)) = distances.min_by(|a, b| a.0.total_cmp(&b.0))
            && clearance < required
        {
            return Err(GoalProblem::TooClose { clearance, required, wall: wall.ends() });
        }
        let radius = collision.footprint.inscribed_radius();
        let separated = |robot| are_separated(&self.walls, [robot, map_from_goal.origin()], radius);
        if robot.is_some_and(separated) {
            return Err(GoalProblem::Separated { width: 2.0 * radius });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use surepose::geometry::Angle;
    use surepose::map::Wall;
    use surepose::safety::Footprint;

    use super::*;

    fn point((x, y): (f64, f64)) -> Point<Map, f64> {
        Point::new(x, y)
    }

    /// Walls from each corner to the next.
    fn polyline(corners: &[(f64, f64)]) -> Vec<Wall<f64>> {
        corners.windows(2).map(|ends| Wall::between(point(ends[0]), point(ends[1])).unwrap()).collect()
    }

    fn rectangle((left, bottom): (f64, f64), (right, top): (f64, f64)) -> Vec<Wall<f64>> {
        polyline(&[(left, bottom), (right, bottom), (right, top), (left, top), (left, bottom)])
    }

    /// The verdict for a robot with a radius of 0.2 m and a clearance of 5 cm.
    fn check(walls: Vec<Wall<f64>>, robot: (f64, f64), goal: (f64, f64)) -> Result<(), GoalProblem> {
        let collision = CollisionConfig::new(Footprint::Circle(0.2));
        let goal = Pose::new(goal.0, goal.1, Angle::zero());
        OwnedMap::from_walls(walls).check_goal(&collision, Some(point(robot)), goal)
    }

    fn is_separated(walls: Vec<Wall<f64>>, robot: (f64, f64), goal: (f64, f64)) -> bool {
        matches!(check(walls, robot, goal), Err(GoalProblem::Separated { .. }))
    }

    #[test]
    fn goal_near_a_wall_is_rejected_with_distance_and_clearance() {
        let room = || rectangle((-4.0, -3.0), (4.0, 3.0));
        let Err(GoalProblem::TooClose { clearance, required, wall }) = check(room(), (0.0, 0.0), (3.92, 0.0))
        else {
            panic!("a goal 8 cm from a wall");
        };
        assert!(clearance.abs() < 1e-12 && (required - 0.05).abs() < 1e-12, "{clearance} {required}");
        assert!(wall.iter().all(|end| (end.x - 4.0).abs() < 1e-12), "{wall:?}");
        assert!(check(room(), (0.0, 0.0), (3.76, 0.0)).is_err());
        assert_eq!(check(room(), (0.0, 0.0), (3.74, 0.0)), Ok(()));
    }

    #[test]
    fn goal_in_a_closed_box_or_outside_the_room_is_separated() {
        let walls = || [rectangle((-4.0, -3.0), (4.0, 3.0)), rectangle((1.0, 1.0), (2.0, 2.0))].concat();
        assert!(is_separated(walls(), (0.0, 0.0), (1.5, 1.5)), "in the box");
        assert!(is_separated(walls(), (0.0, 0.0), (5.0, 0.0)), "outside of the room");
        assert!(is_separated(walls(), (1.5, 1.5), (0.0, 0.0)), "out of the box");
        assert_eq!(check(walls(), (0.0, 0.0), (3.0, 1.5)), Ok(()), "behind the box");
        // Without the pose of the robot, only the distance counts.
        let collision = CollisionConfig::new(Footprint::Circle(0.2));
        let box_ = OwnedMap::from_walls(walls());
        assert_eq!(box_.check_goal(&collision, None, Pose::new(1.5, 1.5, Angle::zero())), Ok(()));
    }

    /// A door separates nothing if the robot fits through; a narrower gap, such as that of a traced map, does.
    #[test]
    fn openings_wider_than_the_footprint_connect() {
        let with_gap =
            |gap: f64| polyline(&[(gap, 0.0), (2.0, 0.0), (2.0, 2.0), (-2.0, 2.0), (-2.0, 0.0), (0.0, 0.0)]);
        assert!(is_separated(with_gap(0.1), (0.0, -1.0), (0.0, 1.0)));
        assert!(is_separated(with_gap(0.3), (0.0, -1.0), (0.0, 1.0)));
        assert_eq!(check(with_gap(0.41), (0.0, -1.0), (0.0, 1.0)), Ok(()));
    }

    #[test]
    fn single_walls_and_plates_separate_nothing() {
        let wall = || polyline(&[(-3.0, 0.0), (3.0, 0.0)]);
        assert_eq!(check(wall(), (0.0, 1.0), (0.0, -1.0)), Ok(()));
        assert_eq!(check(wall(), (0.0, 1.0), (40.0, 30.0)), Ok(()));
        let plate = [rectangle((-4.0, -3.0), (4.0, 3.0)), polyline(&[(0.0, -2.0), (0.0, 2.0)])].concat();
        assert_eq!(check(plate, (-1.0, 0.0), (1.0, 0.0)), Ok(()));
        assert_eq!(check(Vec::new(), (0.0, 0.0), (1.0, 0.0)), Ok(()));
    }

    /// Walls at any angle are tight, also for a robot that stands closer to a wall than its radius.
    #[test]
    fn walls_at_any_angle_are_tight() {
        for turn in 0..24 {
            let (sin, cos) = (f64::from(turn) * 0.27).sin_cos();
            let corners = [(-1.0, -0.7), (1.0, -0.7), (1.0, 0.7), (-1.0, 0.7), (-1.0, -0.7)]
                .map(|(x, y)| (cos * x - sin * y + 0.013, sin * x + cos * y - 0.021));
            let walls = polyline(&corners);
            assert!(is_separated(walls.clone(), (0.013, -0.021), (3.0, 0.0)), "{turn}");
            let near = (0.013 - sin * 0.6, -0.021 + cos * 0.6);
            assert!(is_separated(walls.clone(), near, (3.0, 0.0)), "{turn}, near a wall");
            assert_eq!(check(walls, (2.0, 1.0), (-2.0, -1.0)), Ok(()), "{turn}");
        }
    }
}
