//! From a region where the proof got stuck to one situation in which the claim is false.

use core::f64::consts::{PI, TAU};

use surepose::{Angle, Body, Goal, Map, Navigation, Pose};

use crate::descent::Descent;
use crate::interval::Interval;
use crate::mind::Mind;
use crate::region::Region;
use crate::situation::{Consequence, Situation};
use crate::subject::Subject;

/// A situation, and the tick that violates the claim: W does not fall, or a rim is told to exceed its limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Counterexample {
    /// Where, with what noise.
    pub situation: Situation,
    /// What then happens.
    pub consequence: Consequence,
    /// Whether the wheels' limits were in force.
    pub limited: bool,
}

/// How many situations are tried at random, and how many times the best of them is bettered.
const TRIES: usize = 6000;
const CLIMBS: usize = 6000;

/// Looks for a situation at distances `rho` in which W does not fall, beginning in the region that got `stuck`.
///
/// What is found was simulated with floats; nothing found means only that.
pub(crate) fn find<L: Subject>(
    descent: &Descent<'_, L>,
    rho: Interval,
    stuck: &Region,
) -> Option<Counterexample> {
    let mut dice = Dice(0x5eed_0f5e_ed0f);
    let mut best: Option<(f64, Situation, Consequence)> = None;
    let consider = |situation: Situation, best: &mut Option<(f64, Situation, Consequence)>| {
        let consequence = situation.simulate(
            descent.subject,
            &descent.drive,
            descent.period,
            &descent.weight,
            descent.limited,
        );
        let rims = descent.drive.rims_from_twist(consequence.told).largest();
        let too_fast = descent.limited && rims > descent.rim_limit * (1.0 + 1e-9);
        // A rim told to exceed its limit is a violation too, whatever W does.
        let rise = if too_fast { rims } else { consequence.weight_after - consequence.weight_before };
        let inside = rho.contains(consequence.before.rho);
        if inside && rise.is_finite() && best.as_ref().is_none_or(|(most, ..)| rise > *most) {
            *best = Some((rise, situation, consequence));
        }
    };
    for k in 0..TRIES {
        let near = k % 2 == 0;
        let within = |dice: &mut Dice, set: Interval| set.lo() + dice.part() * (set.hi() - set.lo());
        let circle = Interval::symmetric(PI);
        let at = if near {
            within(&mut dice, stuck.rho)
        } else {
            rho.lo() * (rho.hi() / rho.lo()).powf(dice.part())
        };
        let alpha = within(&mut dice, if near { stuck.alpha } else { circle }) + 0.02 * dice.either();
        let phi = within(&mut dice, if near { stuck.phi } else { circle }) + 0.02 * dice.either();
        let mind = descent.minds[(dice.part() * descent.minds.len() as f64) as usize % descent.minds.len()];
        let plain = Situation::polar(at, alpha, phi, mind);
        consider(disturbed(&plain, descent, &mut dice, 1.0), &mut best);
    }
    for k in 0..CLIMBS {
        let (_, situation, consequence) = best?;
        let size = 0.3 * (1.0 - k as f64 / CLIMBS as f64).powi(2) + 1e-4;
        let reach = consequence.before.rho * size;
        let mut next = situation;
        next.x += reach * dice.either();
        next.y += reach * dice.either();
        next.heading += size * dice.either();
        consider(disturbed(&next, descent, &mut dice, size), &mut best);
    }
    let (rise, situation, consequence) = best?;
    (rise >= 0.0).then_some(Counterexample { situation, consequence, limited: descent.limited })
}

/// The same with other noise within its bounds, `size` of them away, and a mind that the law keeps there.
fn disturbed<L: Subject>(
    from: &Situation,
    descent: &Descent<'_, L>,
    dice: &mut Dice,
    size: f64,
) -> Situation {
    let noise = &descent.noise;
    let mut next = *from;
    next.noise_x += size * noise.position * dice.either();
    next.noise_y += size * noise.position * dice.either();
    let off = next.noise_x.hypot(next.noise_y);
    if off > noise.position {
        let shrink = noise.position / off * (1.0 - 1e-12);
        (next.noise_x, next.noise_y) = (next.noise_x * shrink, next.noise_y * shrink);
    }
    let within =
        |now: f64, bound: f64, dice: &mut Dice| (now + size * bound * dice.either()).clamp(-bound, bound);
    next.noise_heading = within(next.noise_heading, noise.heading, dice);

    let goal: Pose<Map, Goal, f64> = Pose::identity();
    let seen: Pose<Map, Body, f64> = Pose::new(
        next.x + next.noise_x,
        next.y + next.noise_y,
        Angle::wrapped(next.heading + next.noise_heading),
    );
    let decision = descent.subject.decide(&Navigation::of(seen, goal), next.mind.memory(next.trims));
    // Mostly a mind that the law has there already, so that the counterexample does not hang on a change of mind.
    if dice.part() < 0.8 {
        next.mind = Mind::of_float(&decision.memory);
    }
    let told = if descent.limited { descent.subject.grant(decision.twist) } else { decision.twist };
    let rims = descent.drive.rims_from_twist(told);
    let bound = |rim: f64| noise.rim_speed + noise.rim_speed_part * rim.abs();
    next.noise_right = within(next.noise_right, bound(rims.right), dice);
    next.noise_left = within(next.noise_left, bound(rims.left), dice);
    next.heading = next.heading.rem_euclid(TAU);
    next
}

/// Repeatable random numbers: Steele and Vigna's SplitMix64.
pub(crate) struct Dice(pub(crate) u64);

impl Dice {
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
