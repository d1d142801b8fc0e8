//! The switch between the laws, and the local law, against adversaries that choose the noise.
//!
//! `SUREPOSE_CERT_TRIALS=10000000` makes it the long run.

mod common;

use std::f64::consts::PI;

use common::{DRIVE, Dice, disturb, hybrid, noise, request, shipped, trials};
use surepose::{Decision, HybridLaw, Mask, Memory, Navigation, Rest, Scalar, Twist};
use surepose_cert::{Consequence, Mind, Noise, Settling, Shipped, Situation, Subject, Weight, certify};

fn settling<L: Subject>(subject: &L, period: f64, bounds: Noise) -> Option<Settling> {
    let certificate = certify(&request(subject, hybrid(period).gains.h, period, bounds));
    certificate.settling
}

/// How an adversary makes the law change: in charge the local one, it shows the goal as far as it can or pushes the robot
/// away from it; else as near as it can.
fn provoke(situation: &mut Situation, bounds: &Noise, dice: &mut Dice) {
    let reach = bounds.position * (1.0 - 1e-12);
    let rho = situation.x.hypot(situation.y).max(1e-9);
    let (sin, cos) = situation.heading.sin_cos();
    // The estimate is moved away from the goal where that has to look far, and towards it where it has to look near.
    let outward = (situation.x / rho, situation.y / rho);
    let ahead = -(situation.x * cos + situation.y * sin);
    let (x, y) = match (situation.mind.near, dice.flip()) {
        (false, _) => (-outward.0, -outward.1),
        (true, true) => outward,
        // With the goal behind, it is made to look ahead, and the robot drives away from it.
        (true, false) => (cos * ahead.signum(), sin * ahead.signum()),
    };
    let size = if situation.mind.near { 1.0 } else { (rho / reach).min(1.0) };
    (situation.noise_x, situation.noise_y) = (reach * size * x, reach * size * y);
    situation.noise_heading = bounds.heading * dice.either().signum();
}

/// The situation after a tick.
fn onward(tick: &Consequence) -> Situation {
    let (alpha, phi) = (tick.after.alpha.radians(), tick.after.phi.radians());
    Situation { trims: tick.trims, ..Situation::polar(tick.after.rho, alpha, phi, tick.mind) }
}

/// The least number of ticks between a take-over and the next handing back in `ticks` ticks, and how many changes there were.
fn provoked<L: Subject>(subject: &L, period: f64, bounds: &Noise, (seed, ticks): (u64, u64)) -> (u64, u64) {
    let mut dice = Dice(seed);
    let weight = Weight { distance: 4.0, knee: 1.2, approach: 0.3 };
    let fresh = Mind { near: false, reverse: false, side: 0, travel: 0 };
    let (mut least, mut changes, mut taken) = (u64::MAX, 0, None);
    let mut situation = Situation::polar(0.03, 0.0, 0.0, fresh);
    for tick in 0..ticks {
        if tick % 1000 == 0 {
            let rho = 0.03 * dice.either().abs();
            situation = Situation::polar(rho, PI * dice.either(), PI * dice.either(), fresh);
            taken = None;
        }
        provoke(&mut situation, bounds, &mut dice);
        let consequence = situation.simulate(subject, &DRIVE, period, &weight, true);
        match (situation.mind.near, consequence.mind.near) {
            (false, true) => (taken, changes) = (Some(tick), changes + 1),
            (true, false) => {
                least = taken.map_or(0, |taken| least.min(tick - taken));
                changes += 1;
            }
            _ => {}
        }
        situation = onward(&consequence);
    }
    (least, changes)
}

#[test]
fn no_noise_within_its_bounds_makes_the_switch_chatter() {
    for (k, period) in [0.02, 0.1].into_iter().enumerate() {
        let bounds = noise(0.007, 0.25);
        for rest in [None, Some(Rest::of(0.005, period))] {
            let subject = shipped(HybridLaw { rest, ..hybrid(period) });
            let settling = settling(&subject, period, bounds).expect("certified");
            let dwell = settling.switch_dwell as u64;
            let (least, changes) = provoked(&subject, period, &bounds, (k as u64, trials()));
            println!("{period} s, {rest:?}: certified {dwell} ticks, least seen {least}, {changes} changes");
            assert!(settling.switch_keeps_its_mind() && dwell as f64 * period > 0.1, "{settling:?}");
            assert!(least >= dwell, "handed back after {least} ticks");
        }
    }
}

#[test]
fn noise_as_large_as_the_local_law_s_region_does_make_it_chatter_and_the_certificate_says_so() {
    for period in [0.02, 0.1] {
        let bounds = noise(0.02, 1.2);
        let subject = shipped(hybrid(period));
        assert!(!settling(&subject, period, bounds).expect("certified").switch_keeps_its_mind());
        let (least, changes) = provoked(&subject, period, &bounds, (9, 100_000));
        println!("{period} s: {changes} changes in 100000 ticks");
        assert!(least == 1 && changes > 30_000, "{least}, {changes}");
    }
}

#[test]
fn under_the_local_law_no_noise_keeps_the_heading_from_its_bound() {
    for (k, (period, position, heading_deg)) in
        [(0.02, 0.007, 0.25), (0.1, 0.007, 0.25), (0.02, 0.02, 1.2), (0.1, 0.02, 1.2)].into_iter().enumerate()
    {
        let bounds = noise(position, heading_deg);
        let subject = shipped(hybrid(period));
        let settling = settling(&subject, period, bounds).expect("certified");
        let bound = settling.heading_bound.expect("shown");
        assert!(bound < 10_f64.to_radians(), "{settling:?}");
        let weight = Weight { distance: 4.0, knee: 1.2, approach: 0.3 };
        let value = |goal: &Navigation<f64>| {
            let ahead = goal.rho * goal.alpha.sin_cos().1 / settling.length;
            0.5 * (goal.heading_error().radians().powi(2) + ahead * ahead)
        };
        let mut dice = Dice(40 + k as u64);
        let (mut looked, mut least) = (0_u64, f64::INFINITY);
        while looked < trials() / 4 {
            let side = if dice.flip() { 1 } else { -1 };
            let mind = Mind { near: true, reverse: dice.flip(), side, travel: 0 };
            let alpha = PI * dice.either();
            let error = (bound + (2.5 - bound) * dice.either().abs()) * dice.either().signum();
            let mut situation = Situation::polar(0.06 * dice.either().abs(), alpha, alpha + error, mind);
            disturb(&mut situation, &bounds, &mut dice);
            let tick = situation.simulate(&subject, &DRIVE, period, &weight, true);
            let seen_side = tick.before.heading_error().radians() * f64::from(tick.mind.side) < 0.0;
            if tick.mind.near && seen_side {
                looked += 1;
                let fall = (value(&tick.before) - value(&tick.after)) / period;
                least = least.min(fall);
                assert!(fall > 0.0, "V rises by {}: {situation:?} {tick:?}", -fall);
            }
        }
        println!("{period} s, {position} m: bound {:.1}°, least fall {least:.4}/s", bound.to_degrees());
    }
}

/// Laws of which one of the statements is false.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    /// Its hysteresis is as narrow as it was before it widened.
    NarrowHysteresis,
    /// It takes over and hands back at the same place.
    NoHysteresis,
    /// The local law does not turn before it has arrived.
    WaitsForArrival,
    /// At rest it does not stop, but backs away.
    BacksAwayAtRest,
    /// The local law takes over for a tick farther out than it keeps the robot, and does not turn.
    TakesOverFarOut,
}

struct Mutant {
    law: Shipped,
    fault: Fault,
}

impl Subject for Mutant {
    fn decide<S: Scalar>(&self, seen: &Navigation<S>, before: Memory<S>) -> Decision<S> {
        let mut before = before;
        match self.fault {
            Fault::NarrowHysteresis => before.trims = before.trims + S::of(1e3),
            Fault::NoHysteresis => before.near = S::Mask::splat(false),
            Fault::WaitsForArrival | Fault::BacksAwayAtRest | Fault::TakesOverFarOut => {}
        }
        let mut decision = self.law.decide(seen, before);
        let ahead = seen.rho * seen.alpha.sin_cos().1;
        let zero = S::of(0.0);
        match self.fault {
            Fault::WaitsForArrival => {
                let waits = decision.memory.near.and(ahead.abs().gt(S::of(0.35 * 0.033)));
                let still = Twist::new(decision.twist.v, zero);
                decision.twist = Twist::select(waits, still, decision.twist);
            }
            Fault::BacksAwayAtRest => {
                let rests = ahead.abs().lt(S::of(0.02));
                let away = Twist::new(ahead * S::of(-2.0), decision.twist.omega);
                decision.twist = Twist::select(rests, away, decision.twist);
            }
            Fault::TakesOverFarOut => {
                let far_out = seen.rho.gt(S::of(0.033)).and(seen.rho.lt(S::of(0.035)));
                let takes_over = far_out.and(!before.near);
                decision.memory.near = decision.memory.near.or(takes_over);
                let still = Twist::new(decision.twist.v, zero);
                decision.twist = Twist::select(takes_over, still, decision.twist);
            }
            _ => {}
        }
        decision
    }

    fn grant<S: Scalar>(&self, wanted: Twist<S>) -> Twist<S> {
        self.law.grant(wanted)
    }
}

#[test]
fn a_law_of_which_a_statement_is_false_does_not_get_it() {
    // That the law without the fault does get it is what the other tests show.
    let plain = hybrid(0.02);
    let told = HybridLaw { rest: Some(Rest::of(0.005, 0.02)), ..plain };
    let judged = |law: HybridLaw<f64>, fault: Fault, bounds| {
        certify(&request(&Mutant { law: shipped(law), fault }, law.gains.h, 0.02, bounds))
    };
    let (small, large) = (noise(0.007, 0.25), noise(0.02, 1.2));
    for fault in [Fault::NarrowHysteresis, Fault::NoHysteresis] {
        // It is right not to have it.
        for law in [plain, told] {
            let mutant = Mutant { law: shipped(law), fault };
            let (least, changes) = provoked(&mutant, 0.02, &small, (3, 100_000));
            println!("{fault:?}: handed back after {least} ticks, {changes} changes in 100000");
            assert_eq!(least, 1, "{fault:?}: it does not chatter");
        }
        let settling = judged(plain, fault, small).settling;
        assert!(
            !settling.is_some_and(|settling| settling.switch_keeps_its_mind()),
            "{fault:?}: {settling:?}"
        );
    }
    let waits = judged(plain, Fault::WaitsForArrival, large).settling;
    assert!(waits.is_none_or(|settling| settling.heading_bound.is_none()), "{waits:?}");
    let takes_over = judged(plain, Fault::TakesOverFarOut, small);
    let settling = takes_over.settling;
    assert!(settling.is_none_or(|settling| settling.heading_bound.is_none()), "{settling:?}");
    let stops = certify(&request(&shipped(told), told.gains.h, 0.02, small)).final_position_bound;
    let stops = stops.expect("shown");
    let backs = judged(told, Fault::BacksAwayAtRest, small);
    let stays = backs.final_position_bound.filter(|_| backs.certified);
    assert!(stays.is_none_or(|bound| bound > 2.0 * stops), "{stops} m at rest; {backs:?}");
}
