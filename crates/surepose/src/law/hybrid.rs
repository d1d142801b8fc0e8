//! The hybrid law: global far away, local near the goal, with a memory that keeps it from changing its mind on noise.

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::angle::Angle;
use crate::drive::Twist;
use crate::navigation::Navigation;
use crate::scalar::{Mask, Scalar};

use super::global::GlobalLaw;
use super::local::LocalLaw;

/// Which way round the robot may approach the goal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Direction {
    /// Nose first.
    Forward,
    /// Tail first.
    Reverse,
    /// Whichever end points at the goal, kept by hysteresis.
    #[default]
    Auto,
}

/// The gains of both laws.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gains<S> {
    /// k_v \[1/s].
    pub k_v: S,
    /// k_α \[1/s].
    pub k_alpha: S,
    /// h.
    pub h: S,
    /// k_θ \[1/s].
    pub k_theta: S,
}

/// The hybrid law of [Tran2012] Sec. 4.
///
/// # Departure
/// The paper switches on Ω_l = {ρ < ε_P, |φ − α| < ε_θ} without memory. With noise that chatters, and at ρ < ε_P
/// with a large θ_e the global law spins on noise. Here the local law takes over at ρ < ε_P whatever the heading
/// (V̇_l ≤ 0 holds for every θ_e: it turns in place) and hands back only beyond a larger radius. The turning
/// side near α = ±π and the direction of approach have hysteresis too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HybridLaw<S> {
    /// The gains.
    pub gains: Gains<S>,
    /// ε_P, where the local law takes over \[m].
    pub capture_radius: S,
    /// How many capture radii away the global law takes over again, > 1.
    pub release: S,
    /// Which end goes first.
    pub direction: Direction,
}

/// What the law remembers from tick to tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Memory<S: Scalar> {
    /// The local law is in charge.
    pub near: S::Mask,
    /// The robot drives tail first.
    pub reverse: S::Mask,
    /// The side it turns to where left and right are equally far: ±1.
    pub side: S,
}

impl<S: Scalar> Memory<S> {
    /// Nothing decided yet.
    pub fn fresh() -> Self {
        Self { near: S::Mask::splat(false), reverse: S::Mask::splat(false), side: S::of(0.0) }
    }
}

/// What the law wants, and what it remembers for the next tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decision<S: Scalar> {
    /// The wanted twist, before limits.
    pub twist: Twist<S>,
    /// What to pass to the next tick.
    pub memory: Memory<S>,
}

/// How far beyond ±π/2 (direction of approach) and ±π (turning side) the mind stays made up \[rad].
const HYSTERESIS: f64 = 0.3;

impl<S: Scalar> HybridLaw<S> {
    /// The global law of these gains.
    pub fn global(&self) -> GlobalLaw<S> {
        GlobalLaw { k_v: self.gains.k_v, k_alpha: self.gains.k_alpha, h: self.gains.h }
    }

    /// The local law of these gains.
    pub fn local(&self) -> LocalLaw<S> {
        LocalLaw { k_v: self.gains.k_v, k_theta: self.gains.k_theta }
    }

    /// The twist for the goal as seen now, and the memory for the next tick.
    #[inline]
    pub fn decide(&self, navigation: &Navigation<S>, memory: Memory<S>) -> Decision<S> {
        let reverse = self.reverse(navigation.alpha, memory.reverse);
        let ahead = Navigation::select(reverse, navigation.reversed(), *navigation);

        let radius = S::select(memory.near, self.capture_radius * self.release, self.capture_radius);
        let near = navigation.rho.lt(radius);

        let (global, side) = turned_to_side(&self.global(), &ahead, memory.side);
        let local = self.local().twist(&ahead);
        let twist = Twist::select(near, local, global);
        let backwards = Twist::new(-twist.v, twist.omega);
        Decision { twist: Twist::select(reverse, backwards, twist), memory: Memory { near, reverse, side } }
    }

    /// Whether the tail goes first: where it points at the goal, and was not just the nose.
    #[inline]
    fn reverse(&self, alpha: Angle<S>, before: S::Mask) -> S::Mask {
        match self.direction {
            Direction::Forward => S::Mask::splat(false),
            Direction::Reverse => S::Mask::splat(true),
            Direction::Auto => {
                let margin = S::select(before, S::of(-HYSTERESIS), S::of(HYSTERESIS));
                alpha.radians().abs().gt(S::of(FRAC_PI_2) + margin)
            }
        }
    }
}

/// The global law, with α continued beyond ±π on the side that the robot already turns to.
#[inline]
fn turned_to_side<S: Scalar>(law: &GlobalLaw<S>, navigation: &Navigation<S>, side: S) -> (Twist<S>, S) {
    let alpha = navigation.alpha.radians();
    let near_branch = alpha.abs().gt(S::of(PI - HYSTERESIS));
    let other_side = (alpha * side).lt(S::of(0.0));
    let continued = near_branch.and(other_side);
    let turn = S::select(continued, side * S::of(TAU), S::of(0.0));
    let twist = law.twist_continued(navigation.rho, alpha + turn, navigation.phi.radians());
    (twist, S::select(continued, side, alpha.sign()))
}
