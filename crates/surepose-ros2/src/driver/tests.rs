//! The driver in the simulated world, with odometry at its own rate, without ROS.

use surepose::estimation::{HeadingMeasurement, Measurement};
use surepose::geometry::{Angle, Body, Point, Pose};
use surepose::kinematics::Integration;
use surepose_sim::robot::Scenario;
use surepose_sim::{Seed, World};

use super::*;

/// A world whose robot takes the driver's commands.
#[derive(Clone)]
struct Ride {
    driver: NodeDriver,
    world: World,
    odometry: Pose<Odom, Body, f64>,
    cmd_vel: Twist<f64>,
    /// Stamps start here \[s].
    origin: f64,
    /// From one odometry to the next \[s].
    dt: f64,
    ended: Option<GoalResult>,
    blocked_by: Option<BlockReason>,
    /// Something that is on no map stands so far before the robot \[m].
    obstacle: Option<f64>,
    /// The laser says nothing.
    laser_fails: bool,
}

impl Ride {
    fn new(start_is_known: bool, dt: f64) -> Self {
        let scenario = Scenario::default();
        let mut settings = NodeDriverSettings::in_scenario(&scenario);
        if !start_is_known {
            settings.start = None;
        }
        Self {
            driver: NodeDriver::new(settings),
            world: World::new(scenario.world(), scenario.start(), Seed(1)),
            // It counts from where nobody knows.
            odometry: Pose::new(7.0, -3.0, Angle::from_degrees(100.0)),
            cmd_vel: Twist::zero(),
            origin: 1.7e9,
            dt,
            ended: None,
            blocked_by: None,
            obstacle: None,
            laser_fails: false,
        }
    }

    /// Replaces the driver by one with other settings.
    fn configure(&mut self, change: impl FnOnce(&mut NodeDriverSettings)) {
        let mut settings = self.driver.settings.clone();
        change(&mut settings);
        self.driver = NodeDriver::new(settings);
    }

    fn stamp(&self, moment: Stamp) -> Stamp {
        Stamp::from_seconds(self.origin).after(moment.seconds())
    }

    /// One odometry, with all that is sensed meanwhile.
    fn step(&mut self) -> Option<DriverReport> {
        let drive = self.world.model().drive;
        let sensed = self.world.step(drive.wheel_rates_from_twist(self.cmd_vel), self.dt);
        for heading in &sensed.headings {
            let compass = HeadingMeasurement { heading: heading.value, std: 0.1_f64.to_radians() };
            let heard = SensorMessage::Measurement(Measurement::Heading(compass));
            self.driver.add_measurement(Stamped::new(self.stamp(heading.stamp), heard));
        }
        for scan in sensed.scans.iter().filter(|_| !self.laser_fails) {
            let mut ranges = scan.value.ranges.clone();
            let middle = ranges.len() / 2;
            for (number, range) in ranges.iter_mut().enumerate() {
                if let Some(obstacle) = self.obstacle.filter(|_| number.abs_diff(middle) < 8) {
                    *range = range.min(obstacle);
                }
            }
            let heard = SensorMessage::Scan(LaserScan {
                angle_min: scan.value.angle_min,
                angle_increment: scan.value.angle_increment,
                ranges,
                range_min: 0.05,
                range_max: 30.0,
                body_from_laser: Pose::identity(),
            });
            self.driver.add_measurement(Stamped::new(self.stamp(scan.stamp), heard));
        }
        self.odometry = self.odometry.integrate(drive.motion_from_travel(sensed.rims), Integration::Arc);
        let report = self.driver.on_odometry(Stamped::new(self.stamp(sensed.stamp), self.odometry)).unwrap();
        if let Some(report) = &report {
            // As a base that has no time-out of its own.
            self.cmd_vel = report.command.unwrap_or(self.cmd_vel);
            self.ended = self.ended.or(report.result);
            self.blocked_by = report.blocked_by;
        }
        report
    }

    /// Lives for so many seconds, or until the goal ends.
    fn live(&mut self, seconds: f64) {
        let until = self.world.now().after(seconds);
        while self.world.now() < until && self.ended.is_none() {
            self.step();
        }
    }

    /// Meets something that stands `ahead` \[m], for so many seconds or until the goal ends, and says how far it got.
    fn meet(&mut self, ahead: f64, seconds: f64) -> f64 {
        let (before, until) = (self.world.pose().origin(), self.world.now().after(seconds));
        let mut gone = 0.0;
        while self.world.now() < until && self.ended.is_none() {
            self.obstacle = Some(ahead - gone);
            self.step();
            gone = self.world.pose().origin().distance(before);
        }
        gone
    }

    /// How far the robot truly is from `goal` \[m] and \[°].
    fn error(&self, goal: Pose<Map, Goal, f64>) -> (f64, f64) {
        let pose = self.world.pose();
        let turn = (pose.heading - goal.heading).degrees().abs();
        (pose.origin().distance(goal.origin()), turn)
    }
}

fn goal() -> Pose<Map, Goal, f64> {
    Pose::new(2.0, 2.0, Angle::from_degrees(30.0))
}

#[test]
fn it_parks_by_odometry_of_any_rate_and_origin() {
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
fn where_odometry_is_on_the_map_is_said() {
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
fn a_robot_that_does_not_know_where_it_is_finds_out_and_parks() {
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
fn goals_end_once_and_the_wheels_rest() {
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
    assert!(speeds[0] > 0.0, "wheels brake no harder than they can: {speeds:?}");
    for pair in speeds.windows(2) {
        assert!(pair[1] <= pair[0] && pair[0] - pair[1] <= limits.wheel_acceleration * period * 1.001);
    }
    assert_eq!(speeds.last(), Some(&0.0), "and are told to rest");
    assert_eq!(commands.last(), Some(&None), "and then are nobody's");
}

#[test]
fn a_goal_in_a_wall_is_refused() {
    let mut ride = Ride::new(true, 0.05);
    let inside_a_wall = ride.driver.settings.map.as_ref().unwrap().walls[0].from;
    let goal = Pose::new(inside_a_wall[0], inside_a_wall[1], Angle::zero());
    assert!(matches!(ride.driver.set_goal(goal), Err(MessageError::InsufficientClearance { .. })));
    assert!(!ride.driver.is_driving());
}

#[test]
fn odometry_timeout_stops_the_wheels_then_aborts_the_goal() {
    let mut ride = Ride::new(true, 0.05);
    ride.live(0.2);
    assert_eq!(ride.driver.on_odometry_timeout(100.0), (false, None), "nobody drives");
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
fn wheels_start_from_rest_after_a_silence() {
    let mut ride = Ride::new(true, 0.1);
    ride.live(0.2);
    ride.driver.set_goal(goal()).unwrap();
    ride.live(4.0);
    assert!(ride.cmd_vel.v > 0.2, "it is under way");
    assert_eq!(ride.driver.on_odometry_timeout(1.0), (true, None));
    let Controller { drive, limits, period, .. } = *ride.driver.controller();
    let command = ride.step().and_then(|report| report.command).unwrap();
    let rims = drive.wheel_speeds_from_twist(command);
    assert!(rims.max_abs() <= limits.wheel_acceleration * period * 1.001, "{command:?}");
    // One that brakes after a goal is told to rest as well, once: then the wheels are nobody's.
    ride.live(2.0);
    ride.driver.cancel();
    assert!(ride.driver.is_commanding());
    assert_eq!(ride.driver.on_odometry_timeout(1.0), (true, None));
    assert_eq!(ride.driver.on_odometry_timeout(1.1), (false, None));
    assert!(!ride.driver.is_commanding());
}

#[test]
fn odometry_that_goes_back_or_jumps_changes_nothing() {
    let mut ride = Ride::new(true, 0.05);
    ride.live(1.0);
    let (before, stamp) = (ride.driver.belief(), ride.stamp(ride.world.now()));
    let early = Stamped::new(stamp.after(-0.3), ride.odometry);
    assert_eq!(ride.driver.on_odometry(early).err(), Some(MessageError::OutOfOrder));
    assert_eq!(ride.driver.belief(), before);
    // Odometry was reset: that is no way of a hundred metres.
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
fn where_somebody_saw_the_robot_a_while_ago_is_carried_on() {
    let mut ride = Ride::new(true, 0.05);
    ride.driver.set_goal(goal()).unwrap();
    ride.live(4.0);
    let (seen, then) = (ride.world.pose(), ride.stamp(ride.world.now()));
    ride.live(0.3);
    while ride.step().is_none() {}
    let way = ride.world.pose().origin().distance(seen.origin());
    assert!(way > 0.05, "it is under way");
    ride.driver.set_pose(Stamped::new(then, Belief::new(seen, [0.001; 3])));
    let off = ride.driver.belief().pose.origin().distance(ride.world.pose().origin());
    assert!(off < 0.1 * way, "{off} m of {way} m");
}

#[test]
fn a_clock_that_is_set_back_starts_the_loop_anew_where_the_robot_is() {
    let mut ride = Ride::new(true, 0.05);
    ride.driver.set_goal(goal()).unwrap();
    ride.live(5.0);
    ride.origin -= 1e6;
    ride.live(1.0);
    assert_eq!(ride.ended, Some(GoalResult::Aborted(AbortReason::ClockSetBack)));
    for _ in 0..30 {
        ride.step();
    }
    assert!(ride.world.twist().v.abs() < 1e-3 && !ride.driver.is_commanding(), "it braked by the new clock");
    ride.ended = None;
    ride.driver.set_goal(goal()).unwrap();
    ride.live(60.0);
    assert_eq!(ride.ended, Some(GoalResult::Reached));
    assert!(ride.error(goal()).0 < 0.01);
}

#[test]
fn a_pose_that_is_held_is_taken_up_again_after_a_push() {
    let mut ride = Ride::new(true, 0.05);
    ride.configure(|settings| settings.hold = true);
    ride.driver.set_goal(goal()).unwrap();
    ride.live(60.0);
    assert_eq!(ride.ended, Some(GoalResult::Reached));
    // Somebody tells the wheels something else for a while.
    for _ in 0..40 {
        ride.step();
        ride.cmd_vel = Twist::new(-0.2, 0.0);
    }
    assert!(ride.error(goal()).0 > 0.05);
    for _ in 0..600 {
        ride.step();
    }
    assert!(ride.error(goal()).0 < 0.01 && ride.driver.is_driving());
    assert_eq!(ride.driver.cancel(), None, "that it was reached was said");
}

#[test]
fn robot_stops_for_unmapped_obstacles_and_resumes() {
    let mut ride = Ride::new(true, 0.05);
    ride.driver.set_goal(goal()).unwrap();
    ride.live(4.0);
    assert!(ride.cmd_vel.v > 0.2, "it is under way");
    let gone = ride.meet(0.8, 4.0);
    assert!(ride.cmd_vel == Twist::zero() && gone < 0.42 && gone > 0.1, "{gone} m on");
    assert_eq!(ride.blocked_by, Some(BlockReason::Obstacle));
    ride.obstacle = None;
    ride.live(60.0);
    assert_eq!(ride.ended, Some(GoalResult::Reached));
    assert!(ride.error(goal()).0 < 0.01);
}

#[test]
fn a_robot_that_is_to_look_out_stops_while_its_laser_is_silent() {
    for (safety_radius, end) in [
        (0.4, GoalResult::Aborted(AbortReason::Blocked(BlockReason::LaserTimeout))),
        (0.0, GoalResult::Reached),
    ] {
        let mut ride = Ride::new(true, 0.05);
        ride.configure(|settings| settings.safety_radius = safety_radius);
        ride.driver.set_goal(goal()).unwrap();
        ride.live(4.0);
        assert!(ride.cmd_vel.v > 0.2, "it is under way");
        ride.laser_fails = true;
        ride.live(4.0);
        let rests = ride.cmd_vel == Twist::zero();
        assert_eq!(rests, safety_radius > 0.0, "{:?}", ride.cmd_vel);
        // A laser that is back in time is all that it waits for.
        let mut again = Ride { laser_fails: false, ..ride.clone() };
        again.live(60.0);
        assert_eq!(again.ended, Some(GoalResult::Reached));
        ride.live(60.0);
        assert_eq!(ride.ended, Some(end));
    }
}

#[test]
fn things_are_where_the_robot_saw_them_while_it_turned() {
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
        assert!(gone > least && gone < most, "{gone} m on");
    }
}
