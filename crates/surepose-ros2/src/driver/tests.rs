//! Tests of the driver in the simulated world, at several odometry rates, without ROS.

mod recording;
mod ride;

use ride::Ride;
use surepose::geometry::{Angle, Body, Point, Pose};
use surepose_io::wall_map::MapWall;

use super::*;

fn goal() -> Pose<Map, Goal, f64> {
    Pose::new(2.0, 2.0, Angle::from_degrees(30.0))
}

#[test]
fn robot_parks_with_any_odometry_rate_and_origin() {
    for dt in [0.02, 0.05, 0.1] {
        let mut ride = Ride::new(true, dt);
        ride.live(0.5);
        assert_eq!(ride.driver.set_goal(goal()), Ok(None));
        ride.live(60.0);
        assert_eq!(ride.ended, Some(GoalResult::Reached), "odometry every {dt} s");
        let (position, heading) = ride.error(goal());
        assert!(position < 0.01 && heading < 1.0, "odometry every {dt} s: {position} m, {heading}°");
        assert_eq!(ride.driver.measurement_stats().rejected(surepose::estimation::RejectReason::Future), 0);
    }
}

#[test]
fn map_from_odom_is_reported() {
    let mut ride = Ride::new(true, 0.05);
    ride.driver.set_goal(goal()).unwrap();
    let mut last = None;
    while ride.ended.is_none() {
        last = ride.step().or(last);
    }
    let body = last.unwrap().map_from_odom * ride.odometry;
    let truth = ride.world.pose();
    assert!(body.origin().distance(truth.origin()) < 0.01);
    assert!((body.heading - truth.heading).degrees().abs() < 0.5);
}

#[test]
fn robot_with_unknown_start_localizes_globally_and_parks() {
    let mut ride = Ride::new(false, 0.05);
    ride.live(0.5);
    ride.driver.set_goal(goal()).unwrap();
    let first = std::iter::repeat_with(|| ride.step()).flatten().next().unwrap();
    assert_eq!(first.health, Health::Lost);
    ride.live(90.0);
    assert_eq!(ride.ended, Some(GoalResult::Reached));
    let (position, heading) = ride.error(goal());
    assert!(position < 0.01 && heading < 1.0, "{position} m, {heading}°");
}

#[test]
fn goals_end_once_and_wheels_stop() {
    let mut ride = Ride::new(true, 0.05);
    ride.live(0.2);
    ride.driver.set_goal(goal()).unwrap();
    ride.live(3.0);
    assert_eq!(ride.driver.set_goal(Pose::new(1.0, 1.0, Angle::zero())), Ok(Some(GoalResult::Preempted)));
    ride.live(1.0);
    assert_eq!(ride.driver.cancel(), Some(GoalResult::Canceled));
    assert_eq!(ride.driver.cancel(), None);
    let commands: Vec<_> =
        std::iter::repeat_with(|| ride.step()).take(60).flatten().map(|report| report.command).collect();
    let speeds: Vec<_> = commands.iter().map_while(|command| command.map(|twist| twist.v.abs())).collect();
    let (limits, period) = (ride.driver.controller().limits, ride.driver.controller().period);
    assert!(speeds[0] > 0.0, "braking within the acceleration limit: {speeds:?}");
    for pair in speeds.windows(2) {
        assert!(pair[1] <= pair[0] && pair[0] - pair[1] <= limits.wheel_acceleration * period * 1.001);
    }
    assert_eq!(speeds.last(), Some(&0.0), "the last command is rest");
    assert_eq!(commands.last(), Some(&None), "no command after rest");
}

#[test]
fn goal_in_a_wall_is_rejected() {
    let mut ride = Ride::new(true, 0.05);
    let inside_a_wall = ride.driver.settings.map.as_ref().unwrap().walls[0].from;
    let goal = Pose::new(inside_a_wall[0], inside_a_wall[1], Angle::zero());
    assert!(matches!(
        ride.driver.set_goal(goal),
        Err(MessageError::Goal(GoalProblem::TooClose { clearance: 0.0, .. }))
    ));
    assert!(!ride.driver.is_driving());
}

/// Adds a box of walls around (3, 3) to the map of the arena.
fn with_box(settings: &mut NodeDriverSettings) {
    let corners = [[2.6, 2.6], [3.4, 2.6], [3.4, 3.4], [2.6, 3.4], [2.6, 2.6]];
    let walls =
        corners.windows(2).map(|ends| MapWall { name: None, from: ends[0], to: ends[1], covariance: None });
    settings.map.get_or_insert_default().walls.extend(walls);
}

/// The goal has room for the robot, but a closed box separates it from the robot. A lost robot checks once it is localized.
#[test]
fn goal_in_a_closed_box_is_rejected() {
    let in_the_box = Pose::new(3.0, 3.0, Angle::zero());
    for goal in [in_the_box, Pose::new(6.0, 1.0, Angle::zero())] {
        let mut ride = Ride::new(true, 0.05);
        ride.configure(with_box);
        ride.live(0.2);
        let refused = ride.driver.set_goal(goal);
        assert!(matches!(refused, Err(MessageError::Goal(GoalProblem::Separated { .. }))), "{refused:?}");
        assert!(
            refused
                .unwrap_err()
                .to_string()
                .starts_with("wall: the goal is separated from the robot by walls")
        );
    }
    let mut ride = Ride::new(false, 0.05);
    // The walls of the box are not in the simulated world, far away from the robot.
    ride.configure(with_box);
    ride.live(0.2);
    assert_eq!(ride.driver.set_goal(in_the_box), Ok(None));
    ride.live(30.0);
    assert_eq!(ride.ended, Some(GoalResult::Aborted(AbortReason::Blocked(BlockReason::Wall))));
}

/// Scans with a wrong mounting have corrupted the estimate: it restarts from the start pose, moved along by odometry.
#[test]
fn changed_mounting_restarts_the_estimate() {
    let mut ride = Ride::new(true, 0.05);
    ride.live(0.2);
    ride.driver.set_goal(goal()).unwrap();
    ride.live(3.0);
    let wrong = Belief::new(Pose::new(1.0, -1.0, Angle::from_degrees(90.0)), [0.01; 3]);
    ride.driver.navigator.set_belief(Stamped::new(ride.driver.belief_stamp(), wrong));
    ride.driver.on_mounting_changed();
    let (belief, truth) = (ride.driver.belief(), ride.world.pose());
    assert!(belief.pose.origin().distance(truth.origin()) < 0.05, "{belief:?}, truth {truth:?}");
    assert!(belief.nees(truth) < 11.3 && belief.covariance.std(0) > 0.01, "{belief:?}, truth {truth:?}");
    ride.live(60.0);
    assert_eq!(ride.ended, Some(GoalResult::Reached));

    // Without a given pose, the robot is localized globally.
    let mut lost = Ride::new(false, 0.05);
    lost.live(0.2);
    lost.driver.on_mounting_changed();
    assert_eq!(lost.driver.navigator.localizer().health(), Health::Lost);
}

#[test]
fn odometry_timeout_stops_the_wheels_then_aborts_the_goal() {
    let mut ride = Ride::new(true, 0.05);
    ride.live(0.2);
    assert_eq!(ride.driver.on_odometry_timeout(100.0), (false, None), "no active goal");
    ride.driver.set_goal(goal()).unwrap();
    assert_eq!(ride.driver.on_odometry_timeout(0.1), (false, None));
    assert_eq!(ride.driver.on_odometry_timeout(1.0), (true, None));
    assert_eq!(
        ride.driver.on_odometry_timeout(11.0),
        (true, Some(GoalResult::Aborted(AbortReason::Fault(FaultReason::OdometryTimeout))))
    );
    for report in std::iter::repeat_with(|| ride.step()).take(20).flatten() {
        assert!(report.command.is_none_or(|twist| twist == Twist::zero()), "{report:?}");
    }
}

#[test]
fn wheels_start_from_rest_after_an_odometry_timeout() {
    let mut ride = Ride::new(true, 0.1);
    ride.live(0.2);
    ride.driver.set_goal(goal()).unwrap();
    ride.live(4.0);
    assert!(ride.cmd_vel.v > 0.2, "the robot moves");
    assert_eq!(ride.driver.on_odometry_timeout(1.0), (true, None));
    let Controller { drive, limits, period, .. } = *ride.driver.controller();
    let command = ride.step().and_then(|report| report.command).unwrap();
    let rims = drive.wheel_speeds_from_twist(command);
    assert!(rims.max_abs() <= limits.wheel_acceleration * period * 1.001, "{command:?}");
    // A robot that brakes after a goal gets one command to rest, and then none.
    ride.live(2.0);
    ride.driver.cancel();
    assert!(ride.driver.is_commanding());
    assert_eq!(ride.driver.on_odometry_timeout(1.0), (true, None));
    assert_eq!(ride.driver.on_odometry_timeout(1.1), (false, None));
    assert!(!ride.driver.is_commanding());
}

#[test]
fn odometry_out_of_order_or_reset_keeps_the_estimate() {
    let mut ride = Ride::new(true, 0.05);
    ride.live(1.0);
    let (before, stamp) = (ride.driver.belief(), ride.stamp(ride.world.now()));
    let early = Stamped::new(stamp.after(-0.3), ride.odometry);
    assert_eq!(ride.driver.on_odometry(early).err(), Some(MessageError::OutOfOrder));
    assert_eq!(ride.driver.belief(), before);
    // A reset of odometry is not 100 m of travel.
    ride.odometry = Pose::new(100.0, 0.0, Angle::zero());
    ride.live(0.5);
    assert!(ride.driver.measurement_stats().rejected(surepose::estimation::RejectReason::NotFinite) > 0);
    assert!(ride.driver.belief().pose.origin().distance(ride.world.pose().origin()) < 0.02);
}

#[test]
fn odometry_jumps_are_ignored_and_uncertainty_grows() {
    let mut ride = Ride::new(true, 0.05);
    let blind = NodeDriverSettings { map: None, compass: false, ..ride.driver.settings.clone() };
    ride.driver = NodeDriver::new(blind);
    ride.live(1.0);
    let before = ride.driver.belief().covariance.std(0);
    ride.odometry = Pose::new(100.0, 0.0, Angle::zero());
    ride.live(0.2);
    let (after, controller) = (ride.driver.belief().covariance.std(0), ride.driver.controller());
    let most = controller.limits.wheel_speed * controller.period;
    assert!(after > before + 0.1 * most && after < before + most, "{before} m and {after} m");
}

#[test]
fn past_pose_is_predicted_to_the_present() {
    let mut ride = Ride::new(true, 0.05);
    ride.driver.set_goal(goal()).unwrap();
    ride.live(4.0);
    let (seen, then) = (ride.world.pose(), ride.stamp(ride.world.now()));
    ride.live(0.3);
    while ride.step().is_none() {}
    let way = ride.world.pose().origin().distance(seen.origin());
    assert!(way > 0.05, "the robot moves");
    ride.driver.set_pose(Stamped::new(then, Belief::new(seen, [0.001; 3])));
    let off = ride.driver.belief().pose.origin().distance(ride.world.pose().origin());
    assert!(off < 0.1 * way, "{off} m of {way} m");
}

#[test]
fn clock_set_back_restarts_the_loop_from_the_estimate() {
    let mut ride = Ride::new(true, 0.05);
    ride.driver.set_goal(goal()).unwrap();
    ride.live(5.0);
    ride.origin -= 1e6;
    ride.live(1.0);
    assert_eq!(ride.ended, Some(GoalResult::Aborted(AbortReason::ClockSetBack)));
    for _ in 0..30 {
        ride.step();
    }
    assert!(
        ride.world.twist().v.abs() < 1e-3 && !ride.driver.is_commanding(),
        "the robot brakes by the new clock"
    );
    ride.ended = None;
    ride.driver.set_goal(goal()).unwrap();
    ride.live(60.0);
    assert_eq!(ride.ended, Some(GoalResult::Reached));
    assert!(ride.error(goal()).0 < 0.01);
}

#[test]
fn held_pose_is_restored_after_a_push() {
    let mut ride = Ride::new(true, 0.05);
    ride.configure(|settings| settings.hold = true);
    ride.driver.set_goal(goal()).unwrap();
    ride.live(60.0);
    assert_eq!(ride.ended, Some(GoalResult::Reached));
    // Another controller commands the wheels for a while.
    for _ in 0..40 {
        ride.step();
        ride.cmd_vel = Twist::new(-0.2, 0.0);
    }
    assert!(ride.error(goal()).0 > 0.05);
    for _ in 0..600 {
        ride.step();
    }
    assert!(ride.error(goal()).0 < 0.01 && ride.driver.is_driving());
    assert_eq!(ride.driver.cancel(), None, "the result was reported before");
}

#[test]
fn robot_stops_for_unmapped_obstacles_and_resumes() {
    let mut ride = Ride::new(true, 0.05);
    ride.driver.set_goal(goal()).unwrap();
    ride.live(4.0);
    assert!(ride.cmd_vel.v > 0.2, "the robot moves");
    let gone = ride.meet(0.8, 4.0);
    assert!(ride.cmd_vel == Twist::zero() && gone < 0.42 && gone > 0.1, "driven: {gone} m");
    assert_eq!(ride.blocked_by, Some(BlockReason::Obstacle));
    ride.obstacle = None;
    ride.live(60.0);
    assert_eq!(ride.ended, Some(GoalResult::Reached));
    assert!(ride.error(goal()).0 < 0.01);
}

#[test]
fn robot_with_obstacle_check_stops_without_scans() {
    for (safety_radius, end) in [
        (0.4, GoalResult::Aborted(AbortReason::Blocked(BlockReason::LaserTimeout))),
        (0.0, GoalResult::Reached),
    ] {
        let mut ride = Ride::new(true, 0.05);
        ride.configure(|settings| settings.safety_radius = safety_radius);
        ride.driver.set_goal(goal()).unwrap();
        ride.live(4.0);
        assert!(ride.cmd_vel.v > 0.2, "the robot moves");
        ride.laser_fails = true;
        ride.live(4.0);
        let rests = ride.cmd_vel == Twist::zero();
        assert_eq!(rests, safety_radius > 0.0, "{:?}", ride.cmd_vel);
        // The goal resumes with the next scan.
        let mut again = Ride { laser_fails: false, ..ride.clone() };
        again.live(60.0);
        assert_eq!(again.ended, Some(GoalResult::Reached));
        ride.live(60.0);
        assert_eq!(ride.ended, Some(end));
    }
}

#[test]
fn robot_with_a_blind_laser_stops_and_resumes() {
    for range in [f64::INFINITY, f64::NAN, 0.0, -1.0] {
        let mut ride = Ride::new(true, 0.05);
        ride.driver.set_goal(goal()).unwrap();
        ride.live(4.0);
        assert!(ride.cmd_vel.v > 0.2, "the robot moves");
        ride.range = Some(range);
        ride.live(1.0);
        assert!(ride.cmd_vel == Twist::zero(), "{range}: {:?}", ride.cmd_vel);
        assert_eq!(ride.blocked_by, Some(BlockReason::LaserBlind), "{range}");
        let mut again = Ride { range: None, ..ride.clone() };
        again.live(60.0);
        assert_eq!(again.ended, Some(GoalResult::Reached), "{range}");
        ride.live(60.0);
        let aborted = GoalResult::Aborted(AbortReason::Blocked(BlockReason::LaserBlind));
        assert_eq!(ride.ended, Some(aborted), "{range}");
    }
}

/// Stamps that are late or early by a configured latency do not disturb the estimate.
#[test]
fn configured_latencies_are_subtracted_from_the_stamps() {
    let errors = |configured: bool| {
        let mut ride = Ride::new(true, 0.05);
        ride.latencies = (-0.2, 0.25);
        if configured {
            ride.configure(|settings| {
                let options = ["compass.latency_s=-0.2", "laser.latency_s=0.25"];
                let configured = options
                    .iter()
                    .fold(settings.config.clone(), |config, option| config.with_option(option).unwrap());
                settings.config = configured;
            });
        }
        let mut worst = 0.0_f64;
        for step in 0..200 {
            ride.cmd_vel = Twist::new(0.0, if step < 100 { 0.8 } else { -0.8 });
            if let Some(report) = ride.step().filter(|_| step > 40) {
                worst = worst.max((report.belief.pose.heading - ride.world.pose().heading).radians().abs());
            }
        }
        worst
    };
    let (right, wrong) = (errors(true), errors(false));
    assert!(right < 0.01 && wrong > 0.05, "{right} rad, without the latencies {wrong} rad");
}

#[test]
fn scans_are_placed_correctly_during_turns() {
    let mut ride = Ride::new(true, 0.1);
    ride.obstacle = Some(0.8);
    let mut seen = 0;
    while ride.world.now().seconds() < 3.0 {
        ride.cmd_vel = Twist::new(0.0, 0.8);
        let now = ride.step().map(|report| report.stamp);
        let monitor = ride.driver.navigator.obstacles();
        let points = monitor.points();
        if now != monitor.last_scan() || points.is_empty() {
            continue;
        }
        let count = points.len() as f64;
        let (x, y) = points.iter().fold((0.0, 0.0), |(x, y), point| (x + point.x, y + point.y));
        let ahead = ride.world.pose() * Point::<Body, f64>::new(0.8, 0.0);
        let off = ahead.distance(Point::new(x / count, y / count));
        assert!(off < 0.03, "{off} m after {} s", ride.world.now().seconds());
        seen += 1;
    }
    assert!(seen > 10, "{seen} scans");
}

#[test]
fn persistent_obstacle_aborts_the_goal() {
    for (safety_radius, end, least, most) in [
        (0.4, Some(GoalResult::Aborted(AbortReason::Blocked(BlockReason::Obstacle))), 0.1, 0.42),
        (0.0, Some(GoalResult::Reached), 1.0, 3.0),
    ] {
        let mut ride = Ride::new(true, 0.05);
        ride.configure(|settings| settings.safety_radius = safety_radius);
        ride.driver.set_goal(goal()).unwrap();
        ride.live(2.0);
        let gone = ride.meet(0.8, 30.0);
        assert_eq!(ride.ended, end);
        assert!(gone > least && gone < most, "driven: {gone} m");
    }
}
