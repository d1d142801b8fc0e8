//! The hybrid law: global far away, local at the goal, handed over smoothly, with a memory that noise does not change.

use crate::drive::{Drive, Twist};
use crate::limit::Limits;
use crate::navigation::Navigation;
use crate::scalar::Scalar;

use super::Decision;
use super::braking::Braking;
use super::commitment::{self, Direction, Memory};
use super::engaged::Engaged;
use super::facing::Facing;
use super::gains::{Actuation, Gains};
use super::global::GlobalLaw;
use super::local::LocalLaw;
use super::rest::Rest;

/// The hybrid law of [Tran2012] Sec. 4, for wheels with limits, a sampled loop and a noisy estimate.
///
/// With `ε` the capture radius, `V` the largest speed and `a₊ = min(1, a)`, the distance from the goal decides:
///
/// | where | law |
/// |---|---|
/// | ρ > ε | (23) with k_v → min(k_v, V/ρ), k_α → k_α(α), h → h·(ρ/2.7ε)²₊, and v = 0 where cos α < 0 |
/// | ρ < ε | the same, its ω faded by (ρ/ε)²: the robot finishes the line it is on; where cos α < 0, v faded in by 1 − (ρ/ε)²: it backs up |
/// | ρ < 0.23ε | (28) with k_θ → k_θ/n at the n-th tick of trimming; it turns as far as it has arrived: ω·max(0.1, 1 − (ρ cos α/0.35ε)²), and wholly where the heading is within 0.02 rad |
///
/// (28) keeps the robot until ρ > 0.85ε; as it trims the heading, ρ² need only exceed what falls evenly to (0.58ε)² in 20
/// ticks. With the direction of approach reversed, α, φ and v are those of a robot whose tail is its nose.
///
/// # Guarantee
/// Without noise and in continuous time W = c·ln ρ + ½(α² + h_w·φ²) falls for ρ > ε with c = 2 and h_w = 0.1, at the fitted
/// gains, and V_l of (26) does not grow where the local law is in charge. Between the two, while steering fades,
/// nothing is proved. Tested by `hybrid::the_far_law_descends`, `hybrid::the_near_law_descends`. What holds sampled
/// and with noise is the certificate's to say.
///
/// # Departure
/// - k_v → min(k_v, V/ρ) bounds v by V. It is a positive factor on the part of the twist that k_v scales, and V̇_g
///   keeps its form with the smaller k_v. So the turn has the wheels first, and the path is nearly straight, as the
///   time-optimal ones are.
/// - No driving away: where cos α < 0, (23) drives backwards and turns. Here the robot turns on the spot first, so that
///   it does not reverse its travel: forward is forward.
/// - k_α shrinks with its error, and k_θ/n, down to a floor, is the gain of a recursive mean: noise of the estimate is
///   averaged, and large errors are still taken away at once. V̇ ≤ 0 holds for every positive gain.
/// - Told of noise, the robot rests rather than follow it to and fro: see [`Rest`].
/// - Where the wheels need time to slow down, gains shrink with the way that is left: see [`Braking`].
/// - h grows with ρ: Ẇ with h(ρ) has the further term −½h′(ρ)·v·cos α·φ² ≤ 0.
/// - The paper's Ω_l has no memory and lets the global law spin on noise at ρ < ε_P with a large heading error.
/// - The turning side and the direction of approach have hysteresis: see [`Memory`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HybridLaw<S> {
    /// The gains.
    pub gains: Gains<S>,
    /// ε_P, within which steering fades and the local law takes over \[m].
    pub capture_radius: S,
    /// Which end goes first.
    pub direction: Direction,
    /// What the robot can do.
    pub actuation: Actuation<S>,
    /// Where it rests rather than follow noise; nowhere if it is told of none.
    pub rest: Option<Rest<S>>,
}

/// The default of ε_P \[m]: beyond it the noise of a laser localisation moves α by little.
const CAPTURE_RADIUS: f64 = 0.033;

// Radii in capture radii. They were tuned on the bench trial, and the certificate judges them.
const ENTER: f64 = 0.23;
/// Beyond this the local law hands back, whatever it does; the squares of the radii fall evenly from this to the next in
/// so many ticks of trimming. So noise that makes it take over too early cannot make it hand back at once, and a robot
/// that noise has turned beside the goal is still called back to it.
const LEAVE_AT_ONCE: f64 = 0.85;
const LEAVE: f64 = 0.58;
const TRIMS_TO_LEAVE: f64 = 20.0;
const ARRIVED: f64 = 0.35;
/// What is left of the turn before the robot has arrived: noise that hides the arrival does not keep it from turning.
const TURN_BEFORE: f64 = 0.1;
const APPROACH: f64 = 2.7;
/// Bearing beyond which k_α is whole \[rad].
const WHOLE_ALPHA: f64 = 0.08;
/// Heading error within which the local law trims; beyond it k_θ is whole \[rad].
const WHOLE_THETA: f64 = 0.045;
/// Heading error within which the local law turns wherever it is \[rad]; beyond twice that, only where it has arrived.
const TRIM: f64 = 0.02;

impl<S: Scalar> HybridLaw<S> {
    /// The law that fits a robot and a period \[s], with the capture radius of the default configuration.
    pub fn fitted(drive: &Drive<S>, limits: &Limits<S>, period: S, direction: Direction) -> Self {
        Self {
            gains: Gains::for_loop(period, limits),
            capture_radius: S::of(CAPTURE_RADIUS),
            direction,
            actuation: Actuation::of(drive, limits, period),
            rest: None,
        }
    }

    /// The twist for the goal as seen now, and the memory for the next tick.
    #[inline(always)]
    pub fn decide(&self, navigation: &Navigation<S>, memory: Memory<S>) -> Decision<S> {
        let facing = self.face(navigation, &memory);
        self.steer(&facing, self.engage(&facing, memory))
    }

    /// Which end goes first, and what it sees.
    #[inline(always)]
    pub fn face(&self, navigation: &Navigation<S>, memory: &Memory<S>) -> Facing<S> {
        Facing::of(navigation, commitment::reverse(self.direction, navigation, self.gains.h, memory))
    }

    /// Which law is in charge, and of what error.
    #[inline(always)]
    pub fn engage(&self, facing: &Facing<S>, memory: Memory<S>) -> Engaged<S> {
        let (ahead, reverse) = (&facing.goal, facing.reverse);
        let near = self.radii_squared(ahead.rho).lt(handover(memory.near, memory.trims));
        let error = S::select(near, -facing.heading_error.radians(), ahead.alpha.radians());
        let (error, side) = commitment::to_side(error, memory.side);
        let (zero, one) = (S::of(0.0), S::of(1.0));
        // Compared where the local law is in charge only: elsewhere it would be one more undecided comparison of intervals.
        let trimming = S::select(near, error.abs(), one).lt(S::of(WHOLE_THETA));
        let trims = S::select(trimming, memory.trims + one, zero);
        Engaged { error, memory: Memory { near, reverse, side, trims, ..memory } }
    }

    /// The twist that the end which goes first wants of this law.
    #[inline(always)]
    pub fn steer(&self, facing: &Facing<S>, engaged: Engaged<S>) -> Decision<S> {
        let (ahead, reverse, Engaged { error, memory }) = (&facing.goal, facing.reverse, engaged);
        let seen = self.seen(facing);
        let Twist { v, omega } =
            Twist::select(memory.near, self.near(&seen, -error, memory.trims), self.far(&seen, ahead, error));
        let onward = |along: S| S::select(reverse, -along, along);
        let (v, travel) = match self.rest {
            Some(rest) => {
                rest.within(self.capture_radius).of_speed(onward(v), onward(seen.ahead), memory.travel)
            }
            None => (onward(v), memory.travel),
        };
        Decision { twist: Twist::new(v, omega), memory: Memory { travel, ..memory } }
    }

    /// The same for wheels that need time to slow down.
    ///
    /// Far away the drive waits where the turn needs time: both are slowed down alike, and the path stays the same. At the
    /// goal there is no drive left to slow down.
    #[inline(always)]
    pub fn steer_in_time(
        &self,
        braking: &Braking<S>,
        facing: &Facing<S>,
        engaged: Engaged<S>,
    ) -> Decision<S> {
        let (near, one) = (engaged.memory.near, S::of(1.0));
        let Gains { k_v, k_alpha, h, k_theta } = self.gains;
        let turn = braking.part_of_turn(S::select(near, k_theta, k_alpha), engaged.error);
        let drive = S::select(near, one, braking.part_of_drive(k_v, facing.goal.rho));
        let gains = Gains { k_v: k_v * drive, k_alpha, h, k_theta: k_theta * turn };
        let decision = Self { gains, ..*self }.steer(facing, engaged);
        Decision { twist: decision.twist.scaled(S::select(near, one, turn)), ..decision }
    }

    /// ρ² in capture radii squared.
    #[inline(always)]
    fn radii_squared(&self, rho: S) -> S {
        (rho * (S::of(1.0) / self.capture_radius)).squared()
    }

    #[inline(always)]
    fn seen(&self, facing: &Facing<S>) -> Seen<S> {
        let Facing { goal, cos, sinc, .. } = *facing;
        let radii_squared = self.radii_squared(goal.rho);
        Seen { cos, sinc, ahead: goal.rho * cos, radii_squared, per_radius: S::of(1.0) / self.capture_radius }
    }

    /// (23) scheduled, with `alpha` continued beyond ±π.
    #[inline(always)]
    fn far(&self, seen: &Seen<S>, ahead: &Navigation<S>, alpha: S) -> Twist<S> {
        let global = GlobalLaw {
            // min(k_v, V/ρ), without a quotient that 0 would break.
            k_v: self.actuation.speed / ahead.rho.max(self.actuation.speed / self.gains.k_v),
            k_alpha: quiet(alpha, WHOLE_ALPHA, self.gains.k_alpha, self.actuation.quiet_alpha),
            h: (seen.radii_squared * (self.gains.h * S::of(1.0 / (APPROACH * APPROACH)))).min(self.gains.h),
        };
        let fade = seen.radii_squared.min(S::of(1.0));
        // Driving away, by as much as steering has faded: on the goal the robot backs up rather than turns round.
        let drive = seen.cos.max((S::of(1.0) - fade) * seen.cos);
        let twist = global.twist_driven(ahead.rho, alpha, ahead.phi.radians(), drive, seen.sinc);
        Twist::new(twist.v, twist.omega * fade)
    }

    /// (28) scheduled, with the heading error continued beyond ±π.
    #[inline(always)]
    fn near(&self, seen: &Seen<S>, heading_error: S, trims: S) -> Twist<S> {
        // At the n-th tick of trimming n = `trims`; it is 0 where nothing is trimmed.
        let one = S::of(1.0);
        let whole = self.gains.k_theta;
        let local = LocalLaw {
            k_v: self.gains.k_v,
            k_theta: (whole / trims.max(one)).max(self.actuation.quiet_theta.min(whole)),
        };
        let twist = local.twist_toward(seen.ahead, heading_error);
        let limit = self.actuation.turn_rate;
        let omega = twist.omega.clamp(-limit, limit);
        let arrived = one - (seen.ahead * (seen.per_radius * S::of(1.0 / ARRIVED))).squared();
        let trimming = (S::of(2.0) - heading_error.abs() * S::of(1.0 / TRIM)).min(one);
        Twist::new(twist.v, omega * arrived.max(trimming).max(S::of(TURN_BEFORE)))
    }
}

/// `whole` at errors of `knee` \[rad] and above, at most `small` at small ones, a parabola between.
#[inline(always)]
fn quiet<S: Scalar>(error: S, knee: f64, whole: S, small: S) -> S {
    let small = small.min(whole);
    (small + (whole - small) * S::of(1.0 / (knee * knee)) * error.squared()).min(whole)
}

/// The goal in the robot's axes, and in capture radii.
struct Seen<S> {
    cos: S,
    sinc: S,
    /// ρ·cos α \[m].
    ahead: S,
    /// ρ² in capture radii squared.
    radii_squared: S,
    /// 1/ε \[1/m].
    per_radius: S,
}

/// ρ² in capture radii squared below which the local law is in charge, having been or not, and having trimmed for so many
/// ticks.
#[inline(always)]
fn handover<S: Scalar>(was: S::Mask, trims: S) -> S {
    const LEAST: f64 = LEAVE * LEAVE;
    const PER_TRIM: f64 = (LEAVE_AT_ONCE * LEAVE_AT_ONCE - LEAST) / TRIMS_TO_LEAVE;
    let leave = (S::of(LEAVE_AT_ONCE * LEAVE_AT_ONCE) - trims * S::of(PER_TRIM)).max(S::of(LEAST));
    S::select(was, leave, S::of(ENTER * ENTER))
}
