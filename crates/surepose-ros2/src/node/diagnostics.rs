//! Diagnostics of the node, once a second: supervisor, measurements and rejected messages.

use std::collections::BTreeMap;

use ros2_client::builtin_interfaces::Time;
use surepose::estimation::RejectReason;
use surepose::safety::{BlockReason, Health, SafetyAction};
use surepose::time::Stamp;

use crate::convert::MessageError;
use crate::driver::{DriverReport, NodeDriver};
use crate::message::{DiagnosticArray, DiagnosticStatus, Header, KeyValue};

/// Levels of `diagnostic_msgs/msg/DiagnosticStatus`.
const OK: u8 = 0;
const WARN: u8 = 1;
const ERROR: u8 = 2;

/// Ratio of odometry period to control period above which a warning is published.
const TOO_SLOW: f64 = 1.25;

/// State of the diagnostics.
#[derive(Debug, Default)]
pub(super) struct Diagnostics {
    warnings: Vec<String>,
    refused: BTreeMap<(&'static str, &'static str), u64>,
    /// Reason of the last goal that the walls ruled out; `None` before one.
    refused_goal: Option<String>,
    /// Measurements of sensors with an unknown mounting.
    unplaced: u64,
    last: Option<Stamp>,
    /// Mean odometry period \[s]; `None` before the second message.
    odometry_period: Option<f64>,
    state: Option<State>,
}

/// Supervisor state of the last step.
#[derive(Clone, Copy, Debug)]
struct State {
    health: Health,
    action: SafetyAction,
    blocked_by: Option<BlockReason>,
}

impl State {
    fn said(self) -> String {
        match (self.action, self.blocked_by) {
            (SafetyAction::Stop(reason), _) => format!("stopped: {}", reason.name()),
            (_, Some(BlockReason::Obstacle)) => "stopped: unmapped obstacle on the path".to_owned(),
            (_, Some(BlockReason::LaserTimeout)) => {
                "stopped: no scan, obstacle check unavailable; --safety-radius 0 disables the check"
                    .to_owned()
            }
            (_, Some(BlockReason::LaserBlind)) => {
                "stopped: scans without a valid return, frozen or malformed; obstacle check unavailable"
                    .to_owned()
            }
            (_, Some(BlockReason::Wall)) => "stopped: wall of the map on the path".to_owned(),
            (SafetyAction::Slowdown(reason), None) => format!("slowed down: {}", reason.name()),
            (SafetyAction::Proceed, None) => "the estimate is reliable".to_owned(),
        }
    }
}

impl Diagnostics {
    pub(super) fn new(warnings: Vec<String>) -> Self {
        Self { warnings, ..Self::default() }
    }

    /// Updates the odometry period.
    pub(super) fn rolled(&mut self, stamp: Stamp) {
        if let Some(last) = self.last {
            let dt = stamp.since(last).max(0.0);
            self.odometry_period = Some(self.odometry_period.map_or(dt, |mean| mean + 0.05 * (dt - mean)));
        }
        self.last = Some(stamp);
    }

    /// Updates the state after a step, and returns a line if it has changed.
    pub(super) fn keep(&mut self, report: &DriverReport) -> Option<String> {
        let now = State { health: report.health, action: report.action, blocked_by: report.blocked_by };
        let start = State { health: Health::Healthy, action: SafetyAction::Proceed, blocked_by: None };
        let before = self.state.replace(now).unwrap_or(start);
        ((before.action, before.blocked_by) != (now.action, now.blocked_by)).then(|| now.said())
    }

    /// Counts a rejected message, and returns whether it is the first one with this reason.
    pub(super) fn refuse(&mut self, topic: &'static str, why: &MessageError) -> bool {
        if let MessageError::Goal(_) = why {
            self.refused_goal = Some(why.to_string());
        }
        self.count(topic, why.name()) == 1
    }

    /// Counts a measurement of a sensor whose mounting is unknown.
    pub(super) fn drop_unplaced(&mut self) {
        self.unplaced = self.unplaced.saturating_add(1);
    }

    /// Counts a message that cannot be decoded.
    pub(super) fn unreadable(&mut self, topic: &'static str) {
        self.count(topic, "unreadable");
    }

    fn count(&mut self, topic: &'static str, why: &'static str) -> u64 {
        let count = self.refused.entry((topic, why)).or_default();
        *count = count.saturating_add(1);
        *count
    }

    /// Builds the message, `age` \[s] after the last odometry. `waiting` names a sensor with an unknown mounting.
    pub(super) fn array(&self, driver: &NodeDriver, age: f64, waiting: Option<&str>) -> DiagnosticArray {
        let (level, message) = self.judged(driver, age, waiting);
        let tally = driver.measurement_stats();
        let belief = driver.belief();
        let position = (belief.covariance.entry(0, 0) + belief.covariance.entry(1, 1)).sqrt();
        let health = self.state.map_or("waiting for odometry", |state| match state.health {
            Health::Healthy => "healthy",
            Health::Degraded => "degraded",
            Health::Lost => "lost",
        });
        let mut values = vec![
            value("estimate", &health),
            value("driving", &driver.is_driving()),
            value("position std [m]", &format!("{position:.4}")),
            value("heading std [deg]", &format!("{:.3}", belief.covariance.std(2).to_degrees())),
            value("odometry age [s]", &format!("{age:.2}")),
            value("measurements accepted", &tally.accepted),
        ];
        values.extend(self.odometry_period.map(|dt| value("odometry period [s]", &format!("{dt:.3}"))));
        values.extend(
            RejectReason::ALL
                .map(|why| value(&format!("measurements rejected, {}", why.name()), &tally.rejected(why))),
        );
        values.push(value("messages dropped, not reached by odometry", &driver.dropped()));
        values.push(value("messages dropped, unknown mounting", &self.unplaced));
        values.extend(self.refused_goal.as_ref().map(|why| value("last rejected goal", why)));
        let refused = self.refused.iter();
        values.extend(refused.map(|((topic, why), count)| value(&format!("{topic} rejected, {why}"), count)));
        let status = DiagnosticStatus {
            level,
            name: "surepose: pose stabilization".to_owned(),
            message,
            hardware_id: String::new(),
            values,
        };
        let header = Header { stamp: Time::now(), frame_id: String::new() };
        DiagnosticArray { header, status: vec![status] }
    }

    fn judged(&self, driver: &NodeDriver, age: f64, waiting: Option<&str>) -> (u8, String) {
        if driver.is_odometry_timed_out(age) {
            return (ERROR, format!("no odometry for {age:.1} s"));
        }
        if let Some(waiting) = waiting {
            return (WARN, waiting.to_owned());
        }
        match self.state {
            None => return (WARN, "waiting for odometry".to_owned()),
            Some(state @ State { action: SafetyAction::Stop(_), .. }) => return (ERROR, state.said()),
            Some(State { action: SafetyAction::Proceed, blocked_by: None, .. }) => {}
            Some(state) => return (WARN, state.said()),
        }
        let period = driver.controller().period;
        if let Some(dt) = self.odometry_period.filter(|dt| *dt > TOO_SLOW * period) {
            let what =
                format!("odometry period: too long (got {dt:.3} s, expected loop.period_s = {period})");
            return (WARN, format!("{what}; the certificate does not apply"));
        }
        match self.warnings.first() {
            Some(warning) => (WARN, warning.clone()),
            None => (OK, "the estimate is reliable".to_owned()),
        }
    }
}

fn value(key: &str, value: &dyn std::fmt::Display) -> KeyValue {
    KeyValue { key: key.to_owned(), value: value.to_string() }
}
