//! The pilot in the simulated world, with odometry at its own rate, without ROS.

use surepose::{Angle, Body, Compass, Integration, Measurement, Point, Pose};
use surepose_lab::rig::Scenario;
use surepose_sim::{Seed, World};

use super::*;

/// A world whose robot takes the pilot's commands.
#[derive(Clone)]
struct Ride {
    pilot: Pilot,
    world: World,
    odometry: Pose<Odom, Body, f64>,
    told: Twist<f64>,
    /// Stamps start here \[s].
    origin: f64,
    /// From one odometry to the next \[s].
    dt: f64,
    ended: Option<Ended>,
    /// Something that is on no map stands so far before the robot \[m].
    obstacle: Option<f64>,
    /// The laser says nothing.
    laser_fails: bool,
}

impl Ride {
    fn new(start_is_known: bool, dt: f64) -> Self {
        let scenario = Scenario::default();
        let mut settings = Settings::in_scenario(&scenario);
        if !start_is_known {
            settings.start = None;
        }
        Self {
            pilot: Pilot::new(settings),
            world: World::new(scenario.world(), scenario.start(), Seed(1)),
            // It counts from where nobody knows.
            odometry: Pose::new(7.0, -3.0, Angle::from_degrees(100.0)),
            told: Twist::rest(),
            origin: 1.7e9,
            dt,
            ended: None,
            obstacle: None,
            laser_fails: false,
        }
    }

    fn stamp(&self, moment: Stamp) -> Stamp {
        Stamp::from_seconds(self.origin).after(moment.seconds())
    }

    /// One odometry, with all that is sensed meanwhile.
    fn step(&mut self) -> Option<Report> {
        let drive = self.world.model().drive;
        let sensed = self.world.step(drive.rates_from_twist(self.told), self.dt);
        for heading in &sensed.headings {
            let compass = Compass { heading: heading.value, std: 0.1_f64.to_radians() };
            let heard = Heard::Measurement(Measurement::Compass(compass));
            self.pilot.hear(Stamped::new(self.stamp(heading.stamp), heard));
        }
        for scan in sensed.scans.iter().filter(|_| !self.laser_fails) {
            let mut ranges = scan.value.ranges.clone();
            let middle = ranges.len() / 2;
            for (number, range) in ranges.iter_mut().enumerate() {
                if let Some(obstacle) = self.obstacle.filter(|_| number.abs_diff(middle) < 8) {
                    *range = range.min(obstacle);
                }
            }
            let heard = Heard::Scan(LaserScan {
                first_bearing: scan.value.first_bearing,
                bearing_step: scan.value.bearing_step,
                ranges,
                nearest: 0.05,
                farthest: 30.0,
                body_from_laser: Pose::identity(),
            });
            self.pilot.hear(Stamped::new(self.stamp(scan.stamp), heard));
        }
        self.odometry = self.odometry.moved(drive.motion_from_travel(sensed.rims), Integration::Arc);
        let report = self.pilot.roll(Stamped::new(self.stamp(sensed.stamp), self.odometry)).unwrap();
        if let Some(report) = &report {
            // As a base that has no time-out of its own.
            self.told = report.command.unwrap_or(self.told);
            self.ended = self.ended.or(report.ended);
        }
        report
    }

    /// Lives for so many seconds, or until the errand ends.
    fn live(&mut self, seconds: f64) {
        let until = self.world.now().after(seconds);
        while self.world.now() < until && self.ended.is_none() {
            self.step();
        }
    }

    /// Meets something that stands `ahead` \[m], for so many seconds or until the errand ends, and says how far it got.
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
        assert_eq!(ride.pilot.go(goal()), Ok(None));
        ride.live(60.0);
        assert_eq!(ride.ended, Some(Ended::Reached), "odometry every {dt} s");
        let (position, heading) = ride.error(goal());
        assert!(position < 0.01 && heading < 1.0, "odometry every {dt} s: {position} m, {heading}°");
        assert_eq!(ride.pilot.tally().refused(surepose::Refusal::Future), 0);
    }
}

#[test]
fn where_odometry_is_on_the_map_is_said() {
    let mut ride = Ride::new(true, 0.05);
    ride.pilot.go(goal()).unwrap();
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
    ride.pilot.go(goal()).unwrap();
    let first = std::iter::repeat_with(|| ride.step()).flatten().next().unwrap();
    assert_eq!(first.health, Health::Lost);
    ride.live(90.0);
    assert_eq!(ride.ended, Some(Ended::Reached));
    let (position, heading) = ride.error(goal());
    assert!(position < 0.01 && heading < 1.0, "{position} m, {heading}°");
}

#[test]
fn goals_end_once_and_the_wheels_rest() {
    let mut ride = Ride::new(true, 0.05);
    ride.live(0.2);
    ride.pilot.go(goal()).unwrap();
    ride.live(3.0);
    assert_eq!(ride.pilot.go(Pose::new(1.0, 1.0, Angle::zero())), Ok(Some(Ended::Preempted)));
    ride.live(1.0);
    assert_eq!(ride.pilot.cancel(), Some(Ended::Cancelled));
    assert_eq!(ride.pilot.cancel(), None);
    let commands: Vec<_> =
        std::iter::repeat_with(|| ride.step()).take(60).flatten().map(|report| report.command).collect();
    let speeds: Vec<_> = commands.iter().map_while(|command| command.map(|twist| twist.v.abs())).collect();
    let (limits, period) = (ride.pilot.controller().limits, ride.pilot.controller().period);
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
    let inside_a_wall = ride.pilot.settings.map.as_ref().unwrap().walls[0].from;
    let goal = Pose::new(inside_a_wall[0], inside_a_wall[1], Angle::zero());
    assert!(matches!(ride.pilot.go(goal), Err(Refused::NoRoom { .. })));
    assert!(!ride.pilot.is_driving());
}

#[test]
fn silent_odometry_stops_the_wheels_and_then_the_errand() {
    let mut ride = Ride::new(true, 0.05);
    ride.live(0.2);
    assert_eq!(ride.pilot.miss(100.0), (false, None), "nobody drives");
    ride.pilot.go(goal()).unwrap();
    assert_eq!(ride.pilot.miss(0.1), (false, None));
    assert_eq!(ride.pilot.miss(1.0), (true, None));
    assert_eq!(ride.pilot.miss(11.0), (true, Some(Ended::Stopped("odometry_silent"))));
    for report in std::iter::repeat_with(|| ride.step()).take(20).flatten() {
        assert!(report.command.is_none_or(|twist| twist == Twist::rest()), "{report:?}");
    }
}

#[test]
fn wheels_start_from_rest_after_a_silence() {
    let mut ride = Ride::new(true, 0.1);
    ride.live(0.2);
    ride.pilot.go(goal()).unwrap();
    ride.live(4.0);
    assert!(ride.told.v > 0.2, "it is under way");
    assert_eq!(ride.pilot.miss(1.0), (true, None));
    let Controller { drive, limits, period, .. } = *ride.pilot.controller();
    let command = ride.step().and_then(|report| report.command).unwrap();
    let rims = drive.rims_from_twist(command);
    assert!(rims.largest() <= limits.wheel_acceleration * period * 1.001, "{command:?}");
    // One that brakes after a goal is told to rest as well, once: then the wheels are nobody's.
    ride.live(2.0);
    ride.pilot.cancel();
    assert!(ride.pilot.has_wheels());
    assert_eq!(ride.pilot.miss(1.0), (true, None));
    assert_eq!(ride.pilot.miss(1.1), (false, None));
    assert!(!ride.pilot.has_wheels());
}

#[test]
fn odometry_that_goes_back_or_jumps_changes_nothing() {
    let mut ride = Ride::new(true, 0.05);
    ride.live(1.0);
    let (before, stamp) = (ride.pilot.belief(), ride.stamp(ride.world.now()));
    let early = Stamped::new(stamp.after(-0.3), ride.odometry);
    assert_eq!(ride.pilot.roll(early).err(), Some(Refused::OutOfOrder));
    assert_eq!(ride.pilot.belief(), before);
    // Odometry was reset: that is no way of a hundred metres.
    ride.odometry = Pose::new(100.0, 0.0, Angle::zero());
    ride.live(0.5);
    assert!(ride.pilot.tally().refused(surepose::Refusal::NotFinite) > 0);
    assert!(ride.pilot.belief().pose.origin().distance(ride.world.pose().origin()) < 0.02);
}

#[test]
fn odometry_that_jumps_says_nothing_and_a_robot_that_only_has_odometry_becomes_unsure() {
    let mut ride = Ride::new(true, 0.05);
    let blind = Settings { map: None, compass: false, ..ride.pilot.settings.clone() };
    ride.pilot = Pilot::new(blind);
    ride.live(1.0);
    let before = ride.pilot.belief().covariance.std(0);
    ride.odometry = Pose::new(100.0, 0.0, Angle::zero());
    ride.live(0.2);
    let (after, controller) = (ride.pilot.belief().covariance.std(0), ride.pilot.controller());
    let most = controller.limits.wheel_speed * controller.period;
    assert!(after > before + 0.1 * most && after < before + most, "{before} m and {after} m");
}

#[test]
fn where_somebody_saw_the_robot_a_while_ago_is_carried_on() {
    let mut ride = Ride::new(true, 0.05);
    ride.pilot.go(goal()).unwrap();
    ride.live(4.0);
    let (seen, then) = (ride.world.pose(), ride.stamp(ride.world.now()));
    ride.live(0.3);
    while ride.step().is_none() {}
    let way = ride.world.pose().origin().distance(seen.origin());
    assert!(way > 0.05, "it is under way");
    ride.pilot.place(Stamped::new(then, Belief::new(seen, [0.001; 3])));
    let off = ride.pilot.belief().pose.origin().distance(ride.world.pose().origin());
    assert!(off < 0.1 * way, "{off} m of {way} m");
}

#[test]
fn a_clock_that_is_set_back_starts_the_loop_anew_where_the_robot_is() {
    let mut ride = Ride::new(true, 0.05);
    ride.pilot.go(goal()).unwrap();
    ride.live(5.0);
    ride.origin -= 1e6;
    ride.live(1.0);
    assert_eq!(ride.ended, Some(Ended::Stopped("clock_set_back")));
    for _ in 0..30 {
        ride.step();
    }
    assert!(ride.world.twist().v.abs() < 1e-3 && !ride.pilot.has_wheels(), "it braked by the new clock");
    ride.ended = None;
    ride.pilot.go(goal()).unwrap();
    ride.live(60.0);
    assert_eq!(ride.ended, Some(Ended::Reached));
    assert!(ride.error(goal()).0 < 0.01);
}

#[test]
fn a_pose_that_is_held_is_taken_up_again_after_a_push() {
    let mut ride = Ride::new(true, 0.05);
    ride.pilot.settings.hold = true;
    ride.pilot.go(goal()).unwrap();
    ride.live(60.0);
    assert_eq!(ride.ended, Some(Ended::Reached));
    // Somebody tells the wheels something else for a while.
    for _ in 0..40 {
        ride.step();
        ride.told = Twist::new(-0.2, 0.0);
    }
    assert!(ride.error(goal()).0 > 0.05);
    for _ in 0..600 {
        ride.step();
    }
    assert!(ride.error(goal()).0 < 0.01 && ride.pilot.is_driving());
    assert_eq!(ride.pilot.cancel(), None, "that it was reached was said");
}

#[test]
fn it_stops_before_what_no_map_knows_and_goes_on_when_that_is_gone() {
    let mut ride = Ride::new(true, 0.05);
    ride.pilot.go(goal()).unwrap();
    ride.live(4.0);
    assert!(ride.told.v > 0.2, "it is under way");
    let gone = ride.meet(0.8, 4.0);
    assert!(ride.told == Twist::rest() && gone < 0.42 && gone > 0.1, "{gone} m on");
    assert_eq!(ride.pilot.errand.as_ref().unwrap().hindrance(), Some(Hindrance::Obstacle));
    ride.obstacle = None;
    ride.live(60.0);
    assert_eq!(ride.ended, Some(Ended::Reached));
    assert!(ride.error(goal()).0 < 0.01);
}

#[test]
fn a_robot_that_is_to_look_out_stops_while_its_laser_is_silent() {
    for (room, end) in [(0.4, Ended::Stopped("laser_silent")), (0.0, Ended::Reached)] {
        let mut ride = Ride::new(true, 0.05);
        ride.pilot.surroundings = Surroundings::of(ride.pilot.settings.map.as_ref(), room);
        ride.pilot.go(goal()).unwrap();
        ride.live(4.0);
        assert!(ride.told.v > 0.2, "it is under way");
        ride.laser_fails = true;
        ride.live(4.0);
        let rests = ride.told == Twist::rest();
        assert_eq!(rests, room > 0.0, "{:?}", ride.told);
        // A laser that is back in time is all that it waits for.
        let mut again = Ride { laser_fails: false, ..ride.clone() };
        again.live(60.0);
        assert_eq!(again.ended, Some(Ended::Reached));
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
        ride.told = Twist::new(0.0, 0.8);
        let now = ride.step().map(|report| report.stamp);
        let lookout = &ride.pilot.surroundings.lookout;
        if now != Some(lookout.seen) || lookout.things.is_empty() {
            continue;
        }
        let count = lookout.things.len() as f64;
        let (x, y) = lookout.things.iter().fold((0.0, 0.0), |(x, y), thing| (x + thing.x, y + thing.y));
        let ahead = ride.world.pose() * Point::<Body, f64>::new(0.8, 0.0);
        let off = ahead.distance(Point::new(x / count, y / count));
        assert!(off < 0.03, "{off} m after {} s", ride.world.now().seconds());
        seen += 1;
    }
    assert!(seen > 10, "{seen} scans");
}

#[test]
fn what_stays_in_the_way_ends_the_errand_if_it_is_looked_out_for() {
    for (room, end, least, most) in
        [(0.4, Some(Ended::Stopped("obstacle")), 0.1, 0.42), (0.0, Some(Ended::Reached), 1.0, 3.0)]
    {
        let mut ride = Ride::new(true, 0.05);
        ride.pilot.surroundings = Surroundings::of(ride.pilot.settings.map.as_ref(), room);
        ride.pilot.go(goal()).unwrap();
        ride.live(2.0);
        let gone = ride.meet(0.8, 30.0);
        assert_eq!(ride.ended, end);
        assert!(gone > least && gone < most, "{gone} m on");
    }
}
