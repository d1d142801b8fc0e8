//! When is the goal reached? Inside the tolerance for a hold time; then held, and taken up again after a push.

use crate::scalar::{Float, Mask, Scalar};

use super::navigation_variables::NavigationVariables;

/// What counts as being there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance<S> {
    /// Largest distance from the goal \[m].
    pub position: S,
    /// Largest heading error \[rad].
    pub heading: S,
    /// How long both must hold without a break \[s].
    pub dwell: S,
    /// By what factor the tolerance widens once inside, so that noise does not break the hold: ≥ 1.
    pub hysteresis: S,
}

/// How far arriving has come: the state between ticks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GoalChecker<S: Scalar> {
    /// How long the robot has been inside \[s].
    pub inside_for: S,
    /// Inside now.
    pub inside: S::Mask,
}

/// What the loop is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GoalStatus {
    /// On its way.
    Approaching,
    /// Inside the tolerance, not yet for long enough.
    Dwelling,
    /// Inside for the hold time: the pose is held until something pushes the robot out.
    Reached,
}

impl<S: Scalar> Default for GoalChecker<S> {
    fn default() -> Self {
        Self::new()
    }
}

impl<S: Scalar> GoalChecker<S> {
    /// Not there.
    pub fn new() -> Self {
        Self { inside_for: S::from_f64(0.0), inside: S::Mask::splat(false) }
    }

    /// The state after another `period` \[s] with the goal seen as `navigation`.
    #[must_use]
    #[inline]
    pub fn update(self, navigation: &NavigationVariables<S>, tolerance: &Tolerance<S>, period: S) -> Self {
        let widening = S::select(self.inside, tolerance.hysteresis, S::from_f64(1.0));
        let is_near = navigation.rho.lt(tolerance.position * widening);
        let is_aligned = navigation.heading_error().radians().abs().lt(tolerance.heading * widening);
        let inside = is_near.and(is_aligned);
        // The period before the first sight inside was spent outside.
        let dwelled = S::select(self.inside, self.inside_for + period, S::from_f64(0.0));
        Self { inside_for: S::select(inside, dwelled, S::from_f64(0.0)), inside }
    }

    /// Where the hold time is over.
    #[inline]
    pub fn reached(&self, tolerance: &Tolerance<S>) -> S::Mask {
        self.inside.and(!self.inside_for.lt(tolerance.dwell))
    }
}

impl<S: Float> GoalChecker<S> {
    /// What the loop is doing.
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

    /// However long a period is: the one before the first sight inside was spent outside.
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
