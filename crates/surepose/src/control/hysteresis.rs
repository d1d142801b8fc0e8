//! The discrete state of the hybrid law, and the hysteresis that keeps noise from changing it.

use core::f64::consts::{PI, TAU};

use crate::scalar::{Mask, Scalar};

use super::navigation_variables::NavigationVariables;

/// Which way round the robot may approach the goal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Direction {
    /// Nose first.
    Forward,
    /// Tail first.
    Reverse,
    /// Whichever takes less turning, kept by hysteresis.
    #[default]
    Auto,
}

/// What the law remembers from tick to tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HybridState<S: Scalar> {
    /// The local law is in charge.
    pub local_mode: S::Mask,
    /// The robot drives tail first.
    pub reverse: S::Mask,
    /// The side it turns to, where left and right are equally far: ±1; 0 where nothing is decided yet.
    pub turn_direction: S,
    /// For how many ticks the local law has been trimming a small heading error.
    pub trim_ticks: S,
    /// Which way the robot last travelled: 1 ahead, −1 back; 0 before it has, and where there is no [`Deadband`](super::Deadband).
    pub drive_direction: S,
}

impl<S: Scalar> Default for HybridState<S> {
    fn default() -> Self {
        Self::new()
    }
}

impl<S: Scalar> HybridState<S> {
    /// Nothing decided yet.
    pub fn new() -> Self {
        let (no, zero) = (S::Mask::splat(false), S::from_f64(0.0));
        Self { local_mode: no, reverse: no, turn_direction: zero, trim_ticks: zero, drive_direction: zero }
    }

    /// Where nothing is decided yet.
    #[inline(always)]
    pub fn is_undecided(&self) -> S::Mask {
        self.turn_direction.abs().lt(S::from_f64(0.5))
    }
}

/// How far beyond ±π a turn is continued to the side it has begun \[rad].
const TURN_HYSTERESIS: f64 = 0.5;
/// How much worse |α| + h|φ| must be than the other direction's before the robot turns round \[rad].
const DIRECTION_HYSTERESIS: f64 = 1.3;

/// Whether the tail goes first.
///
/// At first the direction that takes less turning: driving nearly straight, nose first turns by |α| + |φ| and tail
/// first by 2π − |α| − |φ|. Later the robot turns round only where |α| + h|φ| says so by a margin: then
/// W = c·ln ρ + ½(α² + hφ²) falls by π times that margin, so that the change of mind is itself a descent.
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
            (alpha + share * phi).gt(most)
        }
    }
}

/// `angle` continued beyond ±π on the side to which the robot already turns, and the side for the next tick.
///
/// # Departure
/// [Tran2012] wraps every angle. With noise the sign of a wrapped angle near ±π flips, and the robot dithers.
#[inline(always)]
pub(super) fn unwrap_toward<S: Scalar>(angle: S, turn_direction: S) -> (S, S) {
    let beyond = (angle * turn_direction).lt(S::from_f64(TURN_HYSTERESIS - PI));
    let continued = S::select(beyond, angle + S::from_f64(TAU).copysign(turn_direction), angle);
    (continued, continued.signum())
}
