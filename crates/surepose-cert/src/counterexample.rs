//! Search for a concrete state that violates the claim, near a box where the proof failed.

use core::f64::consts::{PI, TAU};

use surepose::control::NavigationVariables;
use surepose::geometry::{Angle, Body, Goal, Map, Pose};

use crate::controller::SampledController;
use crate::descent::Descent;
use crate::discrete_state::DiscreteState;
use crate::disturbed_state::{DisturbedState, Transition};
use crate::interval::Interval;
use crate::region::Region;

/// A state and a tick that violate the claim: W does not decrease, or a wheel command exceeds its limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Counterexample {
    /// State and disturbances before the tick.
    pub disturbed_state: DisturbedState,
    /// Result of the tick.
    pub transition: Transition,
    /// Whether the wheel limits applied.
    pub limited: bool,
}

/// Numbers of random states and of hill-climbing steps from the best one.
const TRIES: usize = 6000;
const CLIMBS: usize = 6000;

/// Searches for a state at distances `rho` \[m] in which W does not decrease, starting near the box `stuck`.
///
/// The result was confirmed by simulation in `f64`. `None`: none found, which proves nothing.
pub(crate) fn find<L: SampledController>(
    descent: &Descent<'_, L>,
    rho: Interval,
    stuck: &Region,
) -> Option<Counterexample> {
    let mut rng = Rng(0x5eed_0f5e_ed0f);
    let mut best: Option<(f64, DisturbedState, Transition)> = None;
    let consider = |disturbed_state: DisturbedState, best: &mut Option<(f64, DisturbedState, Transition)>| {
        let transition = disturbed_state.simulate(
            descent.controller,
            &descent.drive,
            descent.period,
            &descent.lyapunov,
            descent.limited,
        );
        let rims = descent.drive.wheel_speeds_from_twist(transition.commanded).max_abs();
        let too_fast = descent.limited && rims > descent.rim_limit * (1.0 + 1e-9);
        // A wheel command above its limit is a violation for any change of W.
        let rise = if too_fast { rims } else { transition.lyapunov_after - transition.lyapunov_before };
        let inside = rho.contains(transition.before.rho);
        if inside && rise.is_finite() && best.as_ref().is_none_or(|(most, ..)| rise > *most) {
            *best = Some((rise, disturbed_state, transition));
        }
    };
    for k in 0..TRIES {
        let near = k % 2 == 0;
        let within = |rng: &mut Rng, set: Interval| set.lo() + rng.part() * (set.hi() - set.lo());
        let circle = Interval::symmetric(PI);
        let at = if near {
            within(&mut rng, stuck.rho)
        } else {
            rho.lo() * (rho.hi() / rho.lo()).powf(rng.part())
        };
        let alpha = within(&mut rng, if near { stuck.alpha } else { circle }) + 0.02 * rng.either();
        let phi = within(&mut rng, if near { stuck.phi } else { circle }) + 0.02 * rng.either();
        let discrete_state = descent.discrete_states
            [(rng.part() * descent.discrete_states.len() as f64) as usize % descent.discrete_states.len()];
        let plain = DisturbedState::polar(at, alpha, phi, discrete_state);
        consider(disturbed(&plain, descent, &mut rng, 1.0), &mut best);
    }
    for k in 0..CLIMBS {
        let (_, disturbed_state, transition) = best?;
        let size = 0.3 * (1.0 - k as f64 / CLIMBS as f64).powi(2) + 1e-4;
        let reach = transition.before.rho * size;
        let mut next = disturbed_state;
        next.x += reach * rng.either();
        next.y += reach * rng.either();
        next.heading += size * rng.either();
        consider(disturbed(&next, descent, &mut rng, size), &mut best);
    }
    let (rise, disturbed_state, transition) = best?;
    (rise >= 0.0).then_some(Counterexample { disturbed_state, transition, limited: descent.limited })
}

/// Perturbs the noise by `size` times its bounds, and selects a discrete state that persists there.
fn disturbed<L: SampledController>(
    from: &DisturbedState,
    descent: &Descent<'_, L>,
    rng: &mut Rng,
    size: f64,
) -> DisturbedState {
    let noise = &descent.noise;
    let mut next = *from;
    next.noise_x += size * noise.position * rng.either();
    next.noise_y += size * noise.position * rng.either();
    let off = next.noise_x.hypot(next.noise_y);
    if off > noise.position {
        let shrink = noise.position / off * (1.0 - 1e-12);
        (next.noise_x, next.noise_y) = (next.noise_x * shrink, next.noise_y * shrink);
    }
    let within =
        |now: f64, bound: f64, rng: &mut Rng| (now + size * bound * rng.either()).clamp(-bound, bound);
    next.noise_heading = within(next.noise_heading, noise.heading, rng);

    let goal: Pose<Map, Goal, f64> = Pose::identity();
    let seen: Pose<Map, Body, f64> = Pose::new(
        next.x + next.noise_x,
        next.y + next.noise_y,
        Angle::from_radians(next.heading + next.noise_heading),
    );
    let output = descent.controller.compute(
        &NavigationVariables::from_poses(seen, goal),
        next.discrete_state.memory(next.trim_ticks, next.lateral),
    );
    // Most states already have the resulting discrete state; the violation then needs no mode switch.
    if rng.part() < 0.8 {
        next.discrete_state = DiscreteState::from_memory_f64(&output.state);
    }
    let commanded = if descent.limited { descent.controller.limit(output.twist) } else { output.twist };
    let rims = descent.drive.wheel_speeds_from_twist(commanded);
    let bound = |rim: f64| noise.rim_speed + noise.rim_speed_part * rim.abs();
    next.noise_right = within(next.noise_right, bound(rims.right), rng);
    next.noise_left = within(next.noise_left, bound(rims.left), rng);
    next.heading = next.heading.rem_euclid(TAU);
    next
}

/// Deterministic random number generator: SplitMix64 by Steele and Vigna.
pub(crate) struct Rng(pub(crate) u64);

impl Rng {
    /// Uniform in [0, 1).
    pub(crate) fn part(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / 9_007_199_254_740_992.0
    }

    /// Uniform in [−1, 1).
    pub(crate) fn either(&mut self) -> f64 {
        2.0 * self.part() - 1.0
    }
}
