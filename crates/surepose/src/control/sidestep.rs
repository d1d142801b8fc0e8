//! Sidestep: an S-shaped maneuver that removes a lateral error near the goal.

use core::f64::consts::FRAC_PI_4;

use crate::scalar::Scalar;

use super::hysteresis::HybridState;
use super::tuning::{MAX_TRIM_TICKS, SIDESTEP_THRESHOLD, SIDESTEP_TICKS};

/// Value of [`HybridState::sidestep`] while the robot turns back to the commanded heading; ±1 on the out leg.
const TURNS_BACK: f64 = 0.5;

/// Selects the leg of the sidestep: the next value of [`HybridState::sidestep`]. `state` is that of the last tick.
///
/// Let x be the along-track and y = ρ sin φ the lateral distance of the goal, and s the sign of its side.
///
/// | `sidestep` | motion | without noise |
/// |---|---|---|
/// | ±1, out | turn in place by r = s·45°, then v = k_v·(ρ cos α + s·ρ sin α) | at the heading r: ẏ = −k_v·y, and x changes as s·y |
/// | ½, back | turn in place to the commanded heading | x and y are constant |
/// | ½ and 0 | the local law (28) at the commanded heading | ẋ = −k_v·x, y is constant |
///
/// The out leg begins after [`SIDESTEP_TICKS`] ticks of trimming if the mean of the lateral distance over them exceeds
/// [`SIDESTEP_THRESHOLD`]. It ends after as many ticks at the heading r, and with the local mode.
///
/// # Guarantee
/// Without noise, |y| never grows, and a sidestep from x = 0 never increases ρ: the out leg follows |x| = |y₀| − |y|, so that
/// x² + y² ≤ y₀². 45° is the smallest angle with this property. The sampled out leg leaves about (1 − k_v·ΔT)⁹ of y, a
/// seventh at the fitted gains. Tested by `hybrid::sidestep_reduces_the_lateral_error`.
///
/// # Departure
/// Under (28) of [Tran2012] the lateral error is constant at the commanded heading, see [`LocalLaw`](super::LocalLaw). The global
/// law would turn toward the goal instead. With a noisy estimate α is undefined at that distance, Eq. (24), and
/// noise makes the two laws alternate: without the sidestep the worst of 2000 starts 1 to 4 cm from the goal took 118 s. The sidestep
/// relies on the heading and on a mean of the lateral error.
#[inline(always)]
pub(super) fn select_leg<S: Scalar>(local_mode: S::Mask, state: &HybridState<S>, capture_radius: S) -> S {
    let (zero, back, sidestep) = (S::from_f64(0.0), S::from_f64(TURNS_BACK), state.sidestep);
    // Compared only where it matters: elsewhere it would add undecided comparisons of intervals.
    let ends = S::from_f64(SIDESTEP_TICKS).lt(S::select(local_mode, state.trim_ticks, zero));
    let is_out = back.lt(sidestep.abs());
    let lateral = S::select(ends, S::select(is_out, zero, state.lateral), zero);
    let begins = (capture_radius * S::from_f64(SIDESTEP_THRESHOLD)).lt(lateral.abs());
    let next = S::select(is_out, back, S::select(begins, lateral.signum(), zero));
    S::select(local_mode, S::select(ends, next, sidestep), zero)
}

/// Direction of the out leg: ±1, and 0 outside of it.
#[inline(always)]
pub(super) fn direction<S: Scalar>(sidestep: S) -> S {
    S::select(S::from_f64(TURNS_BACK).lt(sidestep.abs()), sidestep, S::from_f64(0.0))
}

/// Rotation of the commanded heading \[rad].
#[inline(always)]
pub(super) fn heading<S: Scalar>(sidestep: S) -> S {
    direction(sidestep) * S::from_f64(FRAC_PI_4)
}

/// 1 during a sidestep, else 0.
#[inline(always)]
pub(super) fn activity<S: Scalar>(sidestep: S) -> S {
    (sidestep.abs() * S::from_f64(1.0 / TURNS_BACK)).min(S::from_f64(1.0))
}

/// Returns the number of ticks of trimming, at most [`MAX_TRIM_TICKS`], and the mean lateral distance of the goal over them \[m].
///
/// Outside of trimming the mean does not change. Trimming implies a finite goal, so it is always finite.
#[inline(always)]
pub(super) fn observe<S: Scalar>(trims: S::Mask, aside: S, state: &HybridState<S>) -> (S, S) {
    let (zero, one) = (S::from_f64(0.0), S::from_f64(1.0));
    let trim_ticks = S::select(trims, (state.trim_ticks + one).min(S::from_f64(MAX_TRIM_TICKS)), zero);
    let mean = state.lateral + (aside - state.lateral) / trim_ticks.max(one);
    (trim_ticks, S::select(trims, mean, state.lateral))
}
