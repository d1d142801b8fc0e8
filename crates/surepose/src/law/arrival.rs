//! When is the goal reached? Inside the tolerance for a hold time; then held, and taken up again after a push.

use crate::navigation::Navigation;
use crate::scalar::{Float, Mask, Scalar};

/// What counts as being there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance<S> {
    /// Largest distance from the goal \[m].
    pub position: S,
    /// Largest heading error \[rad].
    pub heading: S,
    /// How long both must hold without a break \[s].
    pub hold: S,
    /// By what factor the tolerance widens once inside, so that noise does not break the hold: ≥ 1.
    pub release: S,
}

/// How far arriving has come: the state between ticks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrival<S: Scalar> {
    /// How long the robot has been inside \[s].
    pub inside_for: S,
    /// Inside now.
    pub inside: S::Mask,
}

/// What the loop is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// On its way.
    Driving,
    /// Inside the tolerance, not yet for long enough.
    Settling,
    /// Inside for the hold time: the pose is held until something pushes the robot out.
    Reached,
}

impl<S: Scalar> Arrival<S> {
    /// Not there.
    pub fn fresh() -> Self {
        Self { inside_for: S::of(0.0), inside: S::Mask::splat(false) }
    }

    /// The state after another `period` \[s] with the goal seen as `navigation`.
    #[must_use]
    #[inline]
    pub fn after(self, navigation: &Navigation<S>, tolerance: &Tolerance<S>, period: S) -> Self {
        let widening = S::select(self.inside, tolerance.release, S::of(1.0));
        let close = navigation.rho.lt(tolerance.position * widening);
        let turned = navigation.heading_error().radians().abs().lt(tolerance.heading * widening);
        let inside = close.and(turned);
        // The period before the first sight inside was spent outside.
        let held = S::select(self.inside, self.inside_for + period, S::of(0.0));
        Self { inside_for: S::select(inside, held, S::of(0.0)), inside }
    }

    /// Where the hold time is over.
    #[inline]
    pub fn reached(&self, tolerance: &Tolerance<S>) -> S::Mask {
        self.inside.and(!self.inside_for.lt(tolerance.hold))
    }
}

impl<S: Float> Arrival<S> {
    /// What the loop is doing.
    pub fn phase(&self, tolerance: &Tolerance<S>) -> Phase {
        if self.reached(tolerance) {
            Phase::Reached
        } else if self.inside {
            Phase::Settling
        } else {
            Phase::Driving
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Arrival, Tolerance};
    use crate::Angle;
    use crate::navigation::Navigation;

    /// However long a period is: the one before the first sight inside was spent outside.
    #[test]
    fn the_hold_time_is_held() {
        let tolerance = Tolerance { position: 0.01, heading: 0.02, hold: 1.0, release: 1.5 };
        let there = Navigation { rho: 0.005, alpha: Angle::zero(), phi: Angle::zero() };
        for (period, ticks) in [(2.0, 1), (1.0, 1), (0.5, 2), (0.25, 4)] {
            let mut arrival = Arrival::<f64>::fresh();
            for _ in 0..ticks {
                arrival = arrival.after(&there, &tolerance, period);
                assert!(!arrival.reached(&tolerance), "{period} s");
            }
            assert!(arrival.after(&there, &tolerance, period).reached(&tolerance), "{period} s");
        }
        let instant = Tolerance { hold: 0.0, ..tolerance };
        assert!(Arrival::<f64>::fresh().after(&there, &instant, 0.1).reached(&instant));
    }
}
