//! How the node is: what the supervisor says, what was refused and why, once a second.

use std::collections::BTreeMap;

use ros2_client::builtin_interfaces::Time;
use surepose::estimation::RejectReason;
use surepose::safety::{BlockReason, Health, SafetyAction};
use surepose::time::Stamp;

use crate::convert::MessageError;
use crate::driver::{DriverReport, NodeDriver};
use crate::message::{DiagnosticArray, DiagnosticStatus, Header, KeyValue};

/// The levels of `diagnostic_msgs/msg/DiagnosticStatus`.
const OK: u8 = 0;
const WARN: u8 = 1;
const ERROR: u8 = 2;

/// Odometry that comes so much slower than the loop's period is said.
const TOO_SLOW: f64 = 1.25;

/// What was noticed so far.
#[derive(Debug, Default)]
pub(super) struct Diagnostics {
    warnings: Vec<String>,
    refused: BTreeMap<(&'static str, &'static str), u64>,
    last: Option<Stamp>,
    /// Mean time between odometries \[s].
    odometry_period: Option<f64>,
    state: Option<State>,
}

/// What a tick said.
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
            (_, Some(BlockReason::Obstacle)) => {
                "stopped: an obstacle that is not on the map is in the way".to_owned()
            }
            (_, Some(BlockReason::LaserTimeout)) => {
                "stopped: no scan arrives, so the obstacle check is unavailable; --safety-radius 0 disables it"
                    .to_owned()
            }
            (_, Some(BlockReason::Wall)) => "stopped: a wall of the map is in the way".to_owned(),
            (SafetyAction::Slowdown(reason), None) => format!("slowed down: {}", reason.name()),
            (SafetyAction::Proceed, None) => "the estimate is trusted".to_owned(),
        }
    }
}

impl Diagnostics {
    pub(super) fn new(warnings: Vec<String>) -> Self {
        Self { warnings, ..Self::default() }
    }

    /// Odometry came.
    pub(super) fn rolled(&mut self, stamp: Stamp) {
        if let Some(last) = self.last {
            let dt = stamp.since(last).max(0.0);
            self.odometry_period = Some(self.odometry_period.map_or(dt, |mean| mean + 0.05 * (dt - mean)));
        }
        self.last = Some(stamp);
    }

    /// The driver ticked; what has changed since it last did, as a line.
    pub(super) fn keep(&mut self, report: &DriverReport) -> Option<String> {
        let now = State { health: report.health, action: report.action, blocked_by: report.blocked_by };
        let start = State { health: Health::Healthy, action: SafetyAction::Proceed, blocked_by: None };
        let before = self.state.replace(now).unwrap_or(start);
        ((before.action, before.blocked_by) != (now.action, now.blocked_by)).then(|| now.said())
    }

    /// Counts a message that was not used, and says whether it is the first such.
    pub(super) fn refuse(&mut self, topic: &'static str, why: &MessageError) -> bool {
        self.count(topic, why.name()) == 1
    }

    /// Counts a message that could not be read.
    pub(super) fn unreadable(&mut self, topic: &'static str) {
        self.count(topic, "unreadable");
    }

    fn count(&mut self, topic: &'static str, why: &'static str) -> u64 {
        let count = self.refused.entry((topic, why)).or_default();
        *count = count.saturating_add(1);
        *count
    }

    /// All of it, `age` \[s] after odometry last came.
    pub(super) fn array(&self, driver: &NodeDriver, age: f64) -> DiagnosticArray {
        let (level, message) = self.judged(driver, age);
        let tally = driver.measurement_stats();
        let belief = driver.belief();
        let position = (belief.covariance.entry(0, 0) + belief.covariance.entry(1, 1)).sqrt();
        let health = self.state.map_or("waiting for odometry", |state| match state.health {
            Health::Healthy => "healthy",
            Health::Degraded => "doubtful",
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
                .map(|why| value(&format!("measurements refused, {}", why.name()), &tally.rejected(why))),
        );
        values.push(value("signals dropped, no odometry to place them", &driver.dropped()));
        let refused = self.refused.iter();
        values.extend(refused.map(|((topic, why), count)| value(&format!("{topic} refused, {why}"), count)));
        let status = DiagnosticStatus {
            level,
            name: "surepose: pose stabilisation".to_owned(),
            message,
            hardware_id: String::new(),
            values,
        };
        let header = Header { stamp: Time::now(), frame_id: String::new() };
        DiagnosticArray { header, status: vec![status] }
    }

    fn judged(&self, driver: &NodeDriver, age: f64) -> (u8, String) {
        if driver.is_odometry_timed_out(age) {
            return (ERROR, format!("no odometry for {age:.1} s"));
        }
        match self.state {
            None => return (WARN, "waiting for odometry".to_owned()),
            Some(state @ State { action: SafetyAction::Stop(_), .. }) => return (ERROR, state.said()),
            Some(State { action: SafetyAction::Proceed, blocked_by: None, .. }) => {}
            Some(state) => return (WARN, state.said()),
        }
        let period = driver.controller().period;
        if let Some(dt) = self.odometry_period.filter(|dt| *dt > TOO_SLOW * period) {
            let what = format!("odometry comes every {dt:.3} s, and loop.period_s is {period}");
            return (WARN, format!("{what}: what is certified does not hold"));
        }
        match self.warnings.first() {
            Some(warning) => (WARN, warning.clone()),
            None => (OK, "the estimate is trusted".to_owned()),
        }
    }
}

fn value(key: &str, value: &dyn std::fmt::Display) -> KeyValue {
    KeyValue { key: key.to_owned(), value: value.to_string() }
}
