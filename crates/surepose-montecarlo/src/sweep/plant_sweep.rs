//! Runs a sweep of the shipped controller over a base that is not ideal.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use serde::Serialize;
use surepose::geometry::{Body, Map, Pose};
use surepose::navigator::AbortReason;
use surepose::optimal;
use surepose_sim::{CancelToken, Seed};

use super::bench::{HEADING_TOLERANCE, POSITION_TOLERANCE, Start, Termination};
use super::on_threads;
use super::plant_robot::PlantRobot;
use super::plant_spec::PlantSweep;
use super::report::SweepReport;
use super::trial::Trial;

/// Report of a [`PlantSweep`].
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlantReport {
    /// Figures of the sweep.
    #[serde(flatten)]
    pub figures: SweepReport,
    /// Trials that ended with an aborted goal, by reason.
    pub aborted: BTreeMap<&'static str, usize>,
    /// Trials that reached the timeout.
    pub timeouts: usize,
}

/// Trial with the reason for its end; `None`: success or timeout.
type EndedTrial = (Trial, Option<AbortReason>);

impl PlantSweep {
    /// Runs all trials, or those before cancellation, ordered by start. A canceled sweep keeps the trials before the
    /// first unfinished one.
    pub fn run(&self, cancel: &CancelToken) -> PlantReport {
        let (begin, next) = (Instant::now(), AtomicUsize::new(0));
        let parts = on_threads(self.threads, |_| {
            let numbers = std::iter::repeat_with(|| next.fetch_add(1, Ordering::Relaxed));
            let mine = numbers.map_while(|number| Some((number, self.starts.nth(self.seed, number)?)));
            let ended = mine.map_while(|(number, start)| Some((number, self.trial(number, start, cancel)?)));
            ended.inspect(|_| cancel.count()).collect::<Vec<_>>()
        });
        let mut ended = parts.concat();
        ended.sort_unstable_by_key(|(number, _)| *number);
        let complete = ended.into_iter().enumerate().take_while(|(index, (number, _))| index == number);
        let ended: Vec<_> = complete.map(|(_, (_, ended))| ended).collect();
        self.report(&ended, begin.elapsed().as_secs_f64())
    }

    fn report(&self, ended: &[EndedTrial], wall_s: f64) -> PlantReport {
        let mut aborted = BTreeMap::new();
        for reason in ended.iter().filter_map(|(_, reason)| *reason) {
            *aborted.entry(reason.name()).or_default() += 1;
        }
        let timeouts = ended.iter().filter(|(trial, reason)| !trial.success && reason.is_none()).count();
        let trials = ended.iter().map(|(trial, _)| *trial).collect();
        PlantReport { figures: SweepReport::from_trials(trials, wall_s, self.seed), aborted, timeouts }
    }

    /// Runs one trial; `None` if canceled.
    fn trial(&self, number: usize, start: Start, cancel: &CancelToken) -> Option<EndedTrial> {
        let termination = Termination::for_benchmark(self.controller.period);
        let map_from_body = Pose::new(start.x, start.y, start.heading);
        let noise = Seed(self.seed).stream(&format!("trial {}", self.starts.number(number)));
        let mut robot = PlantRobot::new(self, map_from_body, noise);
        let mut score = Score::new(&robot.pose);
        let (mut steps, mut reason) = (0, None);
        while score.held < termination.held && steps < termination.most && reason.is_none() {
            if cancel.is_cancelled() {
                return None;
            }
            let (length, aborted) = robot.step();
            score.note(length, &robot.pose);
            (steps, reason) = (steps + 1, aborted);
        }
        let success = score.held >= termination.held;
        let period = self.controller.period;
        let trial = Trial {
            start_x_m: start.x,
            start_y_m: start.y,
            start_heading_deg: start.heading.degrees(),
            success,
            steps,
            time_s: success.then_some((steps as f64 - (termination.held - 1.0)) * period),
            optimal_time_s: optimal::fastest(
                start,
                &self.controller.drive,
                self.controller.limits.wheel_speed,
            )
            .time,
            path_m: success.then_some(score.path_at_entry),
            cusps: success.then_some(score.cusps_at_entry),
            final_position_error_m: robot.pose.x.hypot(robot.pose.y),
            final_heading_error_deg: robot.pose.heading.degrees().abs(),
            nees_mean: None,
            position_rmse_m: None,
            heading_rmse_deg: None,
            refused_part: None,
        };
        Some((trial, reason.filter(|_| !success)))
    }
}

/// Statistics of a trial under way.
struct Score {
    /// Consecutive instants within the tolerance.
    held: f64,
    path: f64,
    cusps: f64,
    direction: f64,
    /// Path length \[m] and reversals at the last entry into the tolerance.
    path_at_entry: f64,
    cusps_at_entry: f64,
}

impl Score {
    fn new(pose: &Pose<Map, Body, f64>) -> Self {
        let held = if is_at_goal(pose) { 1.0 } else { 0.0 };
        Self { held, path: 0.0, cusps: 0.0, direction: 0.0, path_at_entry: 0.0, cusps_at_entry: 0.0 }
    }

    /// Takes in a period: the path length \[m], negative in reverse, and the pose at its end.
    fn note(&mut self, length: f64, pose: &Pose<Map, Body, f64>) {
        self.path += length.abs();
        if length != 0.0 {
            self.cusps += if length * self.direction < 0.0 { 1.0 } else { 0.0 };
            self.direction = length.signum();
        }
        let was_held = self.held > 0.0;
        self.held = if is_at_goal(pose) { self.held + 1.0 } else { 0.0 };
        if self.held > 0.0 && !was_held {
            (self.path_at_entry, self.cusps_at_entry) = (self.path, self.cusps);
        }
    }
}

fn is_at_goal(pose: &Pose<Map, Body, f64>) -> bool {
    pose.x.hypot(pose.y) <= POSITION_TOLERANCE && pose.heading.radians().abs() <= HEADING_TOLERANCE
}
