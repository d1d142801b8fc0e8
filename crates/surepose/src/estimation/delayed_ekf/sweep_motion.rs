//! Motion of the robot during a sweep of the laser, by the odometry in the history.

use crate::geometry::{Body, Pose};
use crate::kinematics::{Integration, Motion};
use crate::scalar::Float;
use crate::time::Stamp;

use super::super::history::{Entry, Event};
use super::super::outcome::RejectReason;
use super::DelayedEkf;

/// Number of poses by which the motion during a sweep is described, evenly spaced in time; odd, so that one is at its middle.
pub const SWEEP_KNOTS: usize = 9;

/// Maximum time by which odometry is extrapolated at either end of the history \[s].
const MAX_EXTRAPOLATION: f64 = 0.05;

/// Minimum duration of an odometry interval that locates a knot \[s]: late measurements split intervals.
const MIN_DURATION: f64 = 1e-6;

/// Motion of the body during a sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SweepMotion<S> {
    /// Time to which the scan is moved: the middle of the sweep.
    pub reference: Stamp,
    /// Poses of the body relative to that at the reference time, evenly spaced from the first beam to the last.
    pub reference_from_body: [Pose<Body, Body, S>; SWEEP_KNOTS],
}

impl<S: Float, const N: usize> DelayedEkf<S, N> {
    /// Motion during the `duration` \[s] after `first`, by odometry alone: corrections by measurements do not move the robot.
    ///
    /// # Errors
    /// [`RejectReason::Stale`] or [`RejectReason::Future`] where the sweep extends beyond odometry by more than 50 ms, or
    /// its middle is outside the history.
    pub fn motion_during(&self, first: Stamp, duration: f64) -> Result<SweepMotion<S>, RejectReason> {
        let knot = |index: usize| first.after(duration * index as f64 / (SWEEP_KNOTS - 1) as f64);
        let (oldest, newest, middle) = (self.history.after(0).0, self.stamp(), SWEEP_KNOTS / 2);
        if oldest.since(first) > MAX_EXTRAPOLATION || knot(middle) < oldest {
            return Err(RejectReason::Stale);
        }
        if knot(SWEEP_KNOTS - 1).since(newest) > MAX_EXTRAPOLATION || knot(middle) > newest {
            return Err(RejectReason::Future);
        }
        // Poses relative to the start of the interval that contains the first beam.
        let mut poses = [Pose::<Body, Body, S>::identity(); SWEEP_KNOTS];
        let mut at_start = Pose::identity();
        let mut next = 0;
        let begin = self.history.count_until(first).min(self.newest_interval());
        for index in begin..self.history.len() {
            let (start, before) = self.history.after(index);
            let Some(&Entry { stamp: end, event: Event::Odometry(_), after }) = self.history.get(index)
            else {
                continue;
            };
            // The motion that the filter predicted, by wheels and gyroscope.
            let motion = Motion::between(before.belief.pose, after.belief.pose);
            let integrate = |part: f64| {
                let part = S::from_f64(part);
                let motion = Motion { length: motion.length * part, turn: motion.turn * part };
                at_start.integrate(motion, Integration::Arc)
            };
            let is_newest = index >= self.newest_interval();
            while end.since(start) > MIN_DURATION && next < SWEEP_KNOTS && (is_newest || knot(next) <= end) {
                poses[next] = integrate(knot(next).since(start) / end.since(start));
                next += 1;
            }
            at_start = integrate(1.0);
        }
        let reference_from_start = poses[middle].inverse();
        let reference_from_body = poses.map(|pose| reference_from_start * pose);
        Ok(SweepMotion { reference: knot(middle), reference_from_body })
    }

    /// Index of the newest odometry of some duration, which is extrapolated; 0 if there is none.
    fn newest_interval(&self) -> usize {
        let is_interval = |index: &usize| {
            self.history.get(*index).is_some_and(|entry| {
                matches!(entry.event, Event::Odometry(_))
                    && entry.stamp.since(self.history.after(*index).0) > MIN_DURATION
            })
        };
        (0..self.history.len()).rev().find(is_interval).unwrap_or(0)
    }
}
