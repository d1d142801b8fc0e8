//! One trial from start to end.

use serde::Serialize;
use surepose::{Angle, Float, Pose};
use surepose_sim::Stream;

use super::Start;
use super::bench::{Bench, DRIVE, limits};
use super::course::Course;
use crate::optimal;

/// When a trial is given up \[s].
const TIMEOUT: f64 = 120.0;

/// How a trial went.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Trial {
    /// Start x \[m].
    pub start_x_m: f64,
    /// Start y \[m].
    pub start_y_m: f64,
    /// Start heading \[°].
    pub start_heading_deg: f64,
    /// Whether the goal was held before the time was up.
    pub success: bool,
    /// Periods that were driven.
    pub steps: u64,
    /// When the robot came inside the tolerance to stay \[s]; none where it failed.
    pub time_s: Option<f64>,
    /// The least time in which any controller could have been on the goal \[s].
    pub optimal_time_s: f64,
    /// How far it had driven by then \[m].
    pub path_m: Option<f64>,
    /// How often it had reversed by then.
    pub cusps: Option<f64>,
    /// Distance from the goal at the end of the hold, or of the time \[m].
    pub final_position_error_m: f64,
    /// Heading error then \[°].
    pub final_heading_error_deg: f64,
}

impl Trial {
    /// Time over the least time; none for a failure, and for a start on the goal.
    pub fn time_ratio(&self) -> Option<f64> {
        self.time_s.filter(|_| self.optimal_time_s > 0.0).map(|time| time / self.optimal_time_s)
    }

    /// Way over the distance of the start; none for a failure, and for a start on the goal.
    pub fn path_ratio(&self) -> Option<f64> {
        let distance = self.start_x_m.hypot(self.start_y_m);
        self.path_m.filter(|_| distance > 0.0).map(|path| path / distance)
    }
}

/// Drives from `start` until the goal is held or the time is up.
pub(super) fn run<S: Float>(bench: &Bench<S>, start: Start, stream: &mut Stream) -> Trial {
    let heading = Angle::wrapped(S::of(start.heading.radians()));
    let mut course = Course::new(Pose::new(S::of(start.x), S::of(start.y), heading));
    let most = (TIMEOUT / bench.period.to_f64()).round() as u64;
    let mut steps = 0;
    while steps < most && !course.is_done(bench.period) {
        course = course.after(bench, &bench.disturbance(stream));
        steps += 1;
    }

    let success = course.is_done(bench.period);
    let reached = |value: S| success.then(|| value.to_f64());
    let (x, y) = (course.pose.x.to_f64(), course.pose.y.to_f64());
    Trial {
        start_x_m: start.x,
        start_y_m: start.y,
        start_heading_deg: start.heading.degrees(),
        success,
        steps,
        time_s: reached(course.entered.time),
        optimal_time_s: optimal::fastest(start, &DRIVE, limits().wheel_speed).time,
        path_m: reached(course.entered.path),
        cusps: reached(course.entered.cusps),
        final_position_error_m: x.hypot(y),
        final_heading_error_deg: course.pose.heading.degrees().to_f64().abs(),
    }
}
