//! Slip monitor: how far the wheels may have slipped since a scan last agreed with the map.

use crate::kinematics::Motion;
use crate::scalar::Float;
use crate::time::Stamp;

/// Fraction of the motion that slip may take (1 σ).
const SLIP_RATIO: f64 = 0.5;
/// Motion below which wheels do not slip: path length \[m] and turn \[rad].
const MIN_LENGTH: f64 = 0.01;
const MIN_TURN: f64 = 0.02;
/// Standard deviation of the displacement beyond slip, and its largest value: x and y \[m], heading \[rad].
const BASE_STD: [f64; 2] = [0.02, 0.02];
const MAX_STD: [f64; 2] = [0.3, 0.5];
/// Time for which wheels that slipped are expected to slip again \[s].
const SLIP_TIME: f64 = 1.0;

/// Motion since the last scan that agreed with the map, and whether the wheels slip at present.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SlipMonitor<S> {
    /// Path length \[m] and turn \[rad] by odometry, each without sign.
    unconfirmed: Motion<S>,
    slipped: Option<Stamp>,
}

impl<S: Float> SlipMonitor<S> {
    /// Pose confirmed, no slip.
    pub(super) fn new() -> Self {
        let zero = S::from_f64(0.0);
        Self { unconfirmed: Motion { length: zero, turn: zero }, slipped: None }
    }

    /// Adds the motion of one odometry interval.
    pub(super) fn on_odometry(&mut self, motion: Motion<S>) {
        let Motion { length, turn } = self.unconfirmed;
        self.unconfirmed = Motion { length: length + motion.length.abs(), turn: turn + motion.turn.abs() };
    }

    /// Notes a scan that agreed with the map.
    pub(super) fn on_agreement(&mut self) {
        *self = Self { slipped: self.slipped, ..Self::new() };
    }

    /// Notes that the pose was corrected for slip at `stamp`.
    pub(super) fn on_slip(&mut self, stamp: Stamp) {
        *self = Self { slipped: Some(stamp), ..Self::new() };
    }

    /// Notes a scan at `stamp` that puts the robot elsewhere; only a robot that moved can have slipped.
    pub(super) fn on_suspicion(&mut self, stamp: Stamp) {
        if self.displacement_std().is_some() {
            self.slipped = Some(stamp);
        }
    }

    /// Standard deviations of the displacement by slip in x, y \[m] and heading \[rad]; `None` for a robot that has not moved.
    pub(super) fn displacement_std(&self) -> Option<[S; 3]> {
        let Motion { length, turn } = self.unconfirmed;
        if length < S::from_f64(MIN_LENGTH) && turn < S::from_f64(MIN_TURN) {
            return None;
        }
        let std = |motion: S, i: usize| {
            let std = S::from_f64(BASE_STD[i]) + motion * S::from_f64(SLIP_RATIO);
            std.min(S::from_f64(MAX_STD[i]))
        };
        Some([std(length, 0), std(length, 0), std(turn, 1)])
    }

    /// Relative standard deviation of odometry that slip adds at `stamp`.
    pub(super) fn relative_std(&self, stamp: Stamp) -> S {
        let slips = self.slipped.is_some_and(|slipped| stamp.since(slipped).abs() <= SLIP_TIME);
        S::from_f64(if slips { SLIP_RATIO } else { 0.0 })
    }
}

#[cfg(test)]
mod tests {
    use crate::kinematics::Motion;
    use crate::time::Stamp;

    use super::SlipMonitor;

    /// A scan that puts the robot elsewhere raises the noise of odometry for a second, if the robot has moved.
    #[test]
    fn only_a_robot_that_moved_is_suspected_of_slip() {
        let at = Stamp::from_seconds;
        let mut monitor = SlipMonitor::<f64>::new();
        monitor.on_suspicion(at(1.0));
        assert!(monitor.relative_std(at(1.0)) < 1e-9, "at rest");
        monitor.on_odometry(Motion { length: 0.05, turn: 0.0 });
        monitor.on_suspicion(at(1.0));
        assert!(monitor.relative_std(at(1.5)) > 0.4);
        assert!(monitor.displacement_std().is_some(), "the displacement is still unexplained");
        assert!(monitor.relative_std(at(2.1)) < 1e-9);
    }
}
