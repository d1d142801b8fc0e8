//! What the robot has made up its mind about, and what it takes to change it: noise does not.

use core::f64::consts::{PI, TAU};

use crate::navigation::Navigation;
use crate::scalar::{Mask, Scalar};

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
pub struct Memory<S: Scalar> {
    /// The local law is in charge.
    pub near: S::Mask,
    /// The robot drives tail first.
    pub reverse: S::Mask,
    /// The side it turns to, where left and right are equally far: ±1; 0 where nothing is decided yet.
    pub side: S,
    /// For how many ticks the local law has been trimming a small heading error.
    pub trims: S,
    /// Which way the robot last travelled: 1 ahead, −1 back; 0 before it has, and where there is no [`Rest`](super::Rest).
    pub travel: S,
}

impl<S: Scalar> Memory<S> {
    /// Nothing decided yet.
    pub fn fresh() -> Self {
        let (no, zero) = (S::Mask::splat(false), S::of(0.0));
        Self { near: no, reverse: no, side: zero, trims: zero, travel: zero }
    }

    /// Where nothing is decided yet.
    #[inline(always)]
    pub fn is_fresh(&self) -> S::Mask {
        self.side.abs().lt(S::of(0.5))
    }
}

/// How far beyond ±π a turn is continued to the side it has begun \[rad].
const SIDE_HYSTERESIS: f64 = 0.5;
/// How much worse |α| + h|φ| must be than the other direction's before the robot turns round \[rad].
const DIRECTION_HYSTERESIS: f64 = 1.3;

/// Whether the tail goes first.
///
/// At first the direction that takes less turning: driving nearly straight, nose first turns by |α| + |φ| and tail
/// first by 2π − |α| − |φ|. Later the robot turns round only where |α| + h|φ| says so by a margin: then
/// W = c·ln ρ + ½(α² + hφ²) falls by π times that margin, so that the change of mind is itself a descent.
#[inline(always)]
pub(super) fn reverse<S: Scalar>(
    direction: Direction,
    navigation: &Navigation<S>,
    h: S,
    memory: &Memory<S>,
) -> S::Mask {
    match direction {
        Direction::Forward => S::Mask::splat(false),
        Direction::Reverse => S::Mask::splat(true),
        Direction::Auto => {
            let (alpha, phi) = (navigation.alpha.radians().abs(), navigation.phi.radians().abs());
            let (even, margin) = ((S::of(1.0) + h) * S::of(PI / 2.0), S::of(DIRECTION_HYSTERESIS));
            let kept = S::select(memory.reverse, even - margin, even + margin);
            let fresh = memory.is_fresh();
            let (share, most) = (S::select(fresh, S::of(1.0), h), S::select(fresh, S::of(PI), kept));
            (alpha + share * phi).gt(most)
        }
    }
}

/// `angle` continued beyond ±π on the side to which the robot already turns, and the side for the next tick.
///
/// # Departure
/// [Tran2012] wraps every angle. With noise the sign of a wrapped angle near ±π flips, and the robot dithers.
#[inline(always)]
pub(super) fn to_side<S: Scalar>(angle: S, side: S) -> (S, S) {
    let beyond = (angle * side).lt(S::of(SIDE_HYSTERESIS - PI));
    let continued = S::select(beyond, angle + S::of(TAU).with_sign_of(side), angle);
    (continued, continued.sign())
}
