//! Discrete state of the hybrid law, with hysteresis against noise.

use core::f64::consts::{PI, TAU};

use crate::param::impl_choice;
use crate::scalar::{Mask, Scalar};

use super::navigation_variables::NavigationVariables;
use super::tuning::{DIRECTION_HYSTERESIS, TURN_HYSTERESIS};

/// Permitted direction of travel toward the goal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Direction {
    /// Forward only.
    Forward,
    /// Reverse only.
    Reverse,
    /// The direction that needs less rotation, with hysteresis.
    #[default]
    Auto,
}

impl_choice!(Direction { Auto = "auto", Forward = "forward", Reverse = "reverse" });

/// State of the hybrid law between ticks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HybridState<S: Scalar> {
    /// Whether the local law is active.
    pub local_mode: S::Mask,
    /// Whether the robot drives in reverse.
    pub reverse: S::Mask,
    /// Direction of rotation near ±π: ±1; 0 before the first decision.
    pub turn_direction: S,
    /// Number of ticks for which the local law has trimmed a small heading error, at most 25.
    pub trim_ticks: S,
    /// Last travel direction: 1 forward, −1 backward; 0 before the first motion and without a [`Deadband`](super::Deadband).
    pub drive_direction: S,
    /// Sidestep: ±1 on its out leg, with the commanded heading rotated by ±45°; ½ on its way back; else 0.
    pub sidestep: S,
    /// Mean lateral distance of the goal over the ticks of trimming \[m]: positive on the left of the leading end.
    pub lateral: S,
}

impl<S: Scalar> Default for HybridState<S> {
    fn default() -> Self {
        Self::new()
    }
}

impl<S: Scalar> HybridState<S> {
    /// State before the first decision.
    pub fn new() -> Self {
        let (no, zero) = (S::Mask::splat(false), S::from_f64(0.0));
        Self {
            local_mode: no,
            reverse: no,
            turn_direction: zero,
            trim_ticks: zero,
            drive_direction: zero,
            sidestep: zero,
            lateral: zero,
        }
    }

    /// State before the first decision.
    #[inline(always)]
    pub fn is_undecided(&self) -> S::Mask {
        self.turn_direction.abs().lt(S::from_f64(0.5))
    }
}

/// Selects whether the robot drives in reverse.
///
/// The first decision selects the smaller rotation: |α| + |φ| forward, 2π − |α| − |φ| in reverse. Later the direction
/// changes only where |α| + h|φ| exceeds the other direction by a margin. Then W = c·ln ρ + ½(α² + hφ²) decreases by
/// π times that margin, so that the change is itself a descent. In local mode the direction stays: there α is noise.
#[inline(always)]
pub(super) fn select_reverse<S: Scalar>(
    direction: Direction,
    navigation: &NavigationVariables<S>,
    h: S,
    state: &HybridState<S>,
) -> S::Mask {
    match direction {
        Direction::Forward => S::Mask::splat(false),
        Direction::Reverse => S::Mask::splat(true),
        Direction::Auto => {
            let (alpha, phi) = (navigation.alpha.radians().abs(), navigation.phi.radians().abs());
            let (even, margin) =
                ((S::from_f64(1.0) + h) * S::from_f64(PI / 2.0), S::from_f64(DIRECTION_HYSTERESIS));
            let kept = S::select(state.reverse, even - margin, even + margin);
            let undecided = state.is_undecided();
            let (share, most) =
                (S::select(undecided, S::from_f64(1.0), h), S::select(undecided, S::from_f64(PI), kept));
            // Compared outside of local mode only: there it would add an undecided comparison of intervals.
            let rotation = S::select(state.local_mode, S::from_f64(0.0), alpha + share * phi);
            state.local_mode.and(state.reverse).or(rotation.gt(most))
        }
    }
}

/// Unwraps `angle` beyond ±π in the current direction of rotation; also returns the direction for the next tick.
///
/// # Departure
/// [Tran2012] wraps every angle. With noise the sign of a wrapped angle near ±π flips, and the robot oscillates.
#[inline(always)]
pub(super) fn unwrap_toward<S: Scalar>(angle: S, turn_direction: S) -> (S, S) {
    let beyond = (angle * turn_direction).lt(S::from_f64(TURN_HYSTERESIS - PI));
    let continued = S::select(beyond, angle + S::from_f64(TAU).copysign(turn_direction), angle);
    (continued, continued.signum())
}
