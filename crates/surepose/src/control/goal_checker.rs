//! Goal checker: the goal is reached after a dwell time within the tolerance.

use crate::scalar::{Float, Mask, Scalar};

use super::navigation_variables::NavigationVariables;

/// Tolerance of the goal, with dwell time and hysteresis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance<S> {
    /// Maximum distance from the goal \[m].
    pub position: S,
    /// Maximum heading error \[rad].
    pub heading: S,
    /// Dwell time for which both must hold without interruption \[s].
    pub dwell: S,
    /// Factor ≥ 1 that widens the tolerance once inside, against noise.
    pub hysteresis: S,
}

/// State of the goal check between ticks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GoalChecker<S: Scalar> {
    /// Time within the tolerance \[s].
    pub inside_for: S,
    /// Whether the robot is within the tolerance.
    pub inside: S::Mask,
}

/// Status of the goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GoalStatus {
    /// Outside the tolerance.
    Approaching,
    /// Within the tolerance, before the end of the dwell time.
    Dwelling,
    /// Dwell time completed; the pose is held until the robot leaves the tolerance.
    Reached,
}

impl<S: Scalar> Default for GoalChecker<S> {
    fn default() -> Self {
        Self::new()
    }
}

impl<S: Scalar> GoalChecker<S> {
    /// State outside the tolerance.
    pub fn new() -> Self {
        Self { inside_for: S::from_f64(0.0), inside: S::Mask::splat(false) }
    }

    /// Updates the state after one `period` \[s] with the goal at `navigation`.
    #[must_use]
    #[inline]
    pub fn update(self, navigation: &NavigationVariables<S>, tolerance: &Tolerance<S>, period: S) -> Self {
        let widening = S::select(self.inside, tolerance.hysteresis, S::from_f64(1.0));
        let is_near = navigation.rho.lt(tolerance.position * widening);
        let is_aligned = navigation.heading_error().radians().abs().lt(tolerance.heading * widening);
        let inside = is_near.and(is_aligned);
        // The period before the first tick within the tolerance does not count.
        let dwelled = S::select(self.inside, self.inside_for + period, S::from_f64(0.0));
        Self { inside_for: S::select(inside, dwelled, S::from_f64(0.0)), inside }
    }

    /// Whether the dwell time is over.
    #[inline]
    pub fn reached(&self, tolerance: &Tolerance<S>) -> S::Mask {
        self.inside.and(!self.inside_for.lt(tolerance.dwell))
    }
}

impl<S: Float> GoalChecker<S> {
    /// Status of the goal.
    pub fn status(&self, tolerance: &Tolerance<S>) -> GoalStatus {
        if self.reached(tolerance) {
            GoalStatus::Reached
        } else if self.inside {
            GoalStatus::Dwelling
        } else {
            GoalStatus::Approaching
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::geometry::Angle;

    use super::{GoalChecker, Tolerance};
    use crate::control::NavigationVariables;

    /// The period before the first tick within the tolerance does not count, whatever its length.
    #[test]
    fn dwell_time_is_respected() {
        let tolerance = Tolerance { position: 0.01, heading: 0.02, dwell: 1.0, hysteresis: 1.5 };
        let there = NavigationVariables { rho: 0.005, alpha: Angle::zero(), phi: Angle::zero() };
        for (period, ticks) in [(2.0, 1), (1.0, 1), (0.5, 2), (0.25, 4)] {
            let mut goal_checker = GoalChecker::<f64>::new();
            for _ in 0..ticks {
                goal_checker = goal_checker.update(&there, &tolerance, period);
                assert!(!goal_checker.reached(&tolerance), "{period} s");
            }
            assert!(goal_checker.update(&there, &tolerance, period).reached(&tolerance), "{period} s");
        }
        let instant = Tolerance { dwell: 0.0, ..tolerance };
        assert!(GoalChecker::<f64>::new().update(&there, &instant, 0.1).reached(&instant));
    }
}
