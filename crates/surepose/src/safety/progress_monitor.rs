//! Progress monitor: does the Lyapunov function of the control law fall as it must?

use crate::control::GoalStatus;
use crate::scalar::Float;

/// Decrease of V that counts as progress, relative to V: of V_g (global law) and of V_l (local law).
const GLOBAL_DECREASE: f64 = 0.1;
const LOCAL_DECREASE: f64 = 0.3;
/// V_g beyond which the required decrease no longer grows.
const FULL_VALUE: f64 = 1.0;

/// Measures the time since the Lyapunov function last reached a new minimum.
///
/// The global law comes before the local one: once the local law was active, only a new minimum of V_l is progress. A robot
/// that circles the goal, because its wheels accelerate less than configured, reaches no new minimum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProgressMonitor<S> {
    best: Option<LyapunovValue<S>>,
    stagnant_for: S,
}

/// Value of the Lyapunov function of the active law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LyapunovValue<S> {
    /// V_g or V_l.
    pub value: S,
    /// Whether it is V_l, of the local law.
    pub is_local: bool,
}

impl<S: Float> ProgressMonitor<S> {
    /// No value seen.
    pub fn new() -> Self {
        Self { best: None, stagnant_for: S::from_f64(0.0) }
    }

    /// Takes the `value` after `elapsed` \[s] in which the robot was free to drive; scaled where it had to drive slowly.
    ///
    /// Time within the tolerance does not count, so that a robot that passes through it again and again ends. A reached goal starts
    /// timing anew.
    pub fn update(&mut self, status: GoalStatus, value: LyapunovValue<S>, elapsed: S) {
        match status {
            GoalStatus::Approaching if self.best.is_some_and(|best| !is_progress(best, value)) => {
                self.stagnant_for = self.stagnant_for + elapsed;
            }
            GoalStatus::Approaching => *self = Self { best: Some(value), ..Self::new() },
            GoalStatus::Dwelling => {}
            GoalStatus::Reached => *self = Self::new(),
        }
    }

    /// Forgets the minimum, for a pose that was replaced; the time without progress goes on.
    pub fn restart_from_new_pose(&mut self) {
        self.best = None;
    }

    /// Time without progress \[s].
    pub fn stagnant_for(&self) -> S {
        self.stagnant_for
    }
}

impl<S: Float> Default for ProgressMonitor<S> {
    fn default() -> Self {
        Self::new()
    }
}

fn is_progress<S: Float>(best: LyapunovValue<S>, now: LyapunovValue<S>) -> bool {
    match (best.is_local, now.is_local) {
        (false, true) => true,
        (true, false) => false,
        (false, false) => {
            let decrease = S::from_f64(GLOBAL_DECREASE) * best.value.min(S::from_f64(FULL_VALUE));
            now.value <= best.value - decrease
        }
        (true, true) => now.value <= best.value * S::from_f64(1.0 - LOCAL_DECREASE),
    }
}

#[cfg(test)]
mod tests {
    use super::{LyapunovValue, ProgressMonitor};
    use crate::control::GoalStatus;

    fn stagnant_after(values: impl IntoIterator<Item = (f64, bool)>) -> f64 {
        let mut monitor = ProgressMonitor::new();
        for (value, is_local) in values {
            monitor.update(GoalStatus::Approaching, LyapunovValue { value, is_local }, 0.1);
        }
        monitor.stagnant_for()
    }

    #[test]
    fn falling_values_are_progress() {
        let falling = (0..100).map(|k| (2.0 * 0.9_f64.powi(k), false));
        assert!(stagnant_after(falling) < 0.15);
        // The local law takes over with a larger value.
        assert!(stagnant_after([(0.01, false), (0.5, true)]) < 1e-12);
    }

    /// A robot that circles its goal, and one that the local law lets go again and again, reach no new minimum.
    #[test]
    fn circling_is_no_progress() {
        let circling = (0..100).map(|k| (1.0 + 0.5 * (0.3 * f64::from(k)).sin(), false));
        assert!(stagnant_after(circling) > 4.0);
        let bouncing = (0..100).map(|k| if k % 10 < 5 { (0.02, true) } else { (0.5, false) });
        assert!((stagnant_after(bouncing) - 9.9).abs() < 1e-9);
    }
}
