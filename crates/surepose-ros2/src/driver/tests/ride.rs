//! The test ride: a driver in the simulated world.

#![allow(clippy::expect_used, reason = "tests panic on failed preconditions")]

use surepose::estimation::{HeadingMeasurement, Measurement};
use surepose::geometry::{Angle, Body, Pose};
use surepose::kinematics::Integration;
use surepose_sim::robot::Scenario;
use surepose_sim::{Seed, World};

use crate::driver::*;

/// Simulated world whose robot takes the driver's commands.
#[derive(Clone)]
pub(super) struct Ride {
    pub(super) driver: NodeDriver,
    pub(super) world: World,
    pub(super) odometry: Pose<Odom, Body, f64>,
    pub(super) cmd_vel: Twist<f64>,
    /// Stamp of the simulated time 0 \[s].
    pub(super) origin: f64,
    /// Odometry period \[s].
    pub(super) dt: f64,
    pub(super) ended: Option<GoalResult>,
    pub(super) blocked_by: Option<BlockReason>,
    /// Distance ahead of the laser to an unmapped obstacle \[m]; `None` without one.
    pub(super) obstacle: Option<f64>,
    /// Whether scans are missing.
    pub(super) laser_fails: bool,
    /// Range of all beams; `None` for that of the walls.
    pub(super) range: Option<f64>,
    /// Delays of the stamps of headings and scans \[s].
    pub(super) latencies: (f64, f64),
}

impl Ride {
    pub(super) fn new(start_is_known: bool, dt: f64) -> Self {
        let scenario = Scenario::default();
        let mut settings = NodeDriverSettings::in_scenario(&scenario);
        if !start_is_known {
            settings.start = None;
        }
        Self {
            driver: NodeDriver::new(settings),
            world: World::new(scenario.world(), scenario.start(), Seed(1)),
            // The origin of odometry is arbitrary.
            odometry: Pose::new(7.0, -3.0, Angle::from_degrees(100.0)),
            cmd_vel: Twist::zero(),
            origin: 1.7e9,
            dt,
            ended: None,
            blocked_by: None,
            obstacle: None,
            laser_fails: false,
            range: None,
            latencies: (0.0, 0.0),
        }
    }

    /// Replaces the driver by one with other settings.
    pub(super) fn configure(&mut self, change: impl FnOnce(&mut NodeDriverSettings)) {
        let mut settings = self.driver.settings.clone();
        change(&mut settings);
        self.driver = NodeDriver::new(settings);
    }

    pub(super) fn stamp(&self, moment: Stamp) -> Stamp {
        Stamp::from_seconds(self.origin).after(moment.seconds())
    }

    /// Simulates one odometry period and feeds its measurements to the driver.
    pub(super) fn step(&mut self) -> Option<DriverReport> {
        let drive = self.world.model().drive;
        let sensed = self.world.step(drive.wheel_rates_from_twist(self.cmd_vel), self.dt);
        for heading in &sensed.headings {
            let compass = HeadingMeasurement { heading: heading.value, std: 0.1_f64.to_radians() };
            let message = SensorMessage::Measurement(Measurement::Heading(compass));
            let stamp = self.stamp(heading.stamp).after(self.latencies.0);
            self.driver.add_measurement(Stamped::new(stamp, message));
        }
        for scan in sensed.scans.iter().filter(|_| !self.laser_fails) {
            let mut ranges = scan.value.ranges.clone();
            let middle = ranges.len() / 2;
            for (number, range) in ranges.iter_mut().enumerate() {
                if let Some(obstacle) = self.obstacle.filter(|_| number.abs_diff(middle) < 8) {
                    *range = range.min(obstacle);
                }
            }
            if let Some(range) = self.range {
                ranges.fill(range);
            }
            let message = SensorMessage::Scan(LaserScan {
                angle_min: scan.value.angle_min,
                angle_increment: scan.value.angle_increment,
                time_increment: scan.value.time_increment,
                ranges,
                range_min: 0.05,
                range_max: 30.0,
                body_from_laser: Pose::identity(),
            });
            let stamp = self.stamp(scan.stamp).after(self.latencies.1);
            self.driver.add_measurement(Stamped::new(stamp, message));
        }
        self.odometry = self.odometry.integrate(drive.motion_from_travel(sensed.rims), Integration::Arc);
        let odometry = Stamped::new(self.stamp(sensed.stamp), self.odometry);
        let report = self.driver.on_odometry(odometry).expect("valid odometry");
        if let Some(report) = &report {
            // The base holds the last command, as one without a timeout.
            self.cmd_vel = report.command.unwrap_or(self.cmd_vel);
            self.ended = self.ended.or(report.result);
            self.blocked_by = report.blocked_by;
        }
        report
    }

    /// Runs for `seconds`, or until the goal ends.
    pub(super) fn live(&mut self, seconds: f64) {
        let until = self.world.now().after(seconds);
        while self.world.now() < until && self.ended.is_none() {
            self.step();
        }
    }

    /// Puts an obstacle `ahead` \[m] for `seconds` or until the goal ends, and returns the distance driven \[m].
    pub(super) fn meet(&mut self, ahead: f64, seconds: f64) -> f64 {
        let (before, until) = (self.world.pose().origin(), self.world.now().after(seconds));
        let mut gone = 0.0;
        while self.world.now() < until && self.ended.is_none() {
            self.obstacle = Some(ahead - gone);
            self.step();
            gone = self.world.pose().origin().distance(before);
        }
        gone
    }

    /// True distance \[m] and heading error \[°] to `goal`.
    pub(super) fn error(&self, goal: Pose<Map, Goal, f64>) -> (f64, f64) {
        let pose = self.world.pose();
        let turn = (pose.heading - goal.heading).degrees().abs();
        (pose.origin().distance(goal.origin()), turn)
    }
}
