//! What is certified is held against simulation: random situations, random disturbances up to their bounds.
//!
//! `SUREPOSE_CERT_TRIALS=10000000` makes it the long run.

mod common;

use std::f64::consts::PI;

use common::{DRIVE, hybrid, noise, request, shipped};
use surepose::Scalar;
use surepose_cert::{Certificate, Mind, Noise, Shipped, Situation, certify};

const CASES: [(f64, f64, f64); 4] =
    [(0.02, 0.007, 0.25), (0.1, 0.007, 0.25), (0.02, 0.02, 1.2), (0.1, 0.02, 1.2)];

/// Repeatable random numbers in [−1, 1): a 64-bit linear congruential generator's upper half.
struct Dice(u64);

impl Dice {
    fn either(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        f64::from((self.0 >> 32) as u32) / f64::from(1_u32 << 31) - 1.0
    }
    fn flip(&mut self) -> bool {
        self.either() < 0.0
    }
}

fn trials() -> u64 {
    std::env::var("SUREPOSE_CERT_TRIALS").ok().and_then(|n| n.parse().ok()).unwrap_or(400_000)
}

fn certified(period: f64, noise: Noise) -> (Shipped, Certificate) {
    let law = hybrid(period);
    let subject = shipped(law);
    let certificate = certify(&request(&subject, law.gains.h, period, noise));
    assert!(certificate.certified);
    (subject, certificate)
}

/// Noise inside its bounds, on them half of the time.
fn disturb(situation: &mut Situation, bounds: &Noise, dice: &mut Dice) {
    let (direction, size) = (PI * dice.either(), if dice.flip() { 1.0 } else { dice.either().abs() });
    let reach = bounds.position * size * (1.0 - 1e-12);
    (situation.noise_x, situation.noise_y) = (reach * direction.cos(), reach * direction.sin());
    let part = dice.either();
    situation.noise_heading = bounds.heading * if dice.flip() { part.signum() } else { part };
}

#[test]
fn no_random_situation_violates_the_certified_decrease() {
    for (k, (period, position, heading_deg)) in CASES.into_iter().enumerate() {
        let bounds = noise(position, heading_deg);
        let (subject, certificate) = certified(period, bounds);
        let (radius, rate) = (certificate.capture_radius.unwrap(), certificate.decrease_rate.unwrap());
        let mut dice = Dice(k as u64);
        let mut least = f64::INFINITY;
        for _ in 0..trials() / 4 {
            let rho = radius * (5.0 / radius).powf(0.5 * (1.0 + dice.either()));
            let side = if dice.flip() { 1 } else { -1 };
            let mind = Mind { near: false, reverse: dice.flip(), side, travel: 0 };
            let mut situation = Situation::polar(rho, PI * dice.either(), PI * dice.either(), mind);
            disturb(&mut situation, &bounds, &mut dice);
            let tick = situation.simulate(&subject, &DRIVE, period, &certificate.weight, true);
            if tick.before.rho >= radius {
                let fall = (tick.weight_before - tick.weight_after) / period;
                least = least.min(fall);
                assert!(fall >= rate * (1.0 - 1e-9), "falls by {fall} only: {situation:?} {tick:?}");
            }
        }
        println!("{period} s, {position} m: certified {rate:.3}/s, least seen {least:.3}/s");
    }
}

#[test]
fn runs_are_captured_in_time_and_stay_captured() {
    for (k, (period, position, heading_deg)) in CASES.into_iter().enumerate() {
        let bounds = noise(position, heading_deg);
        let (subject, certificate) = certified(period, bounds);
        let (radius, last) = (certificate.capture_radius.unwrap(), certificate.final_position_bound.unwrap());
        let latest = certificate.time_bound.unwrap();
        let mut dice = Dice(100 + k as u64);
        let (mut longest, mut farthest) = (0.0_f64, 0.0_f64);
        for _ in 0..12 {
            let fresh = Mind { near: false, reverse: false, side: 0, travel: 0 };
            let mut situation = Situation::polar(4.9, PI * dice.either(), PI * dice.either(), fresh);
            let mut captured = None;
            let mut ticks = 0_u32;
            while captured.is_none_or(|at| ticks < at + 2000) {
                disturb(&mut situation, &bounds, &mut dice);
                let tick = situation.simulate(&subject, &DRIVE, period, &certificate.weight, true);
                let time = f64::from(ticks) * period;
                if captured.is_none() && tick.before.rho < radius {
                    captured = Some(ticks);
                    longest = longest.max(time);
                }
                if captured.is_some() {
                    farthest = farthest.max(tick.after.rho);
                    assert!(tick.after.rho <= last, "{} m from the goal after the capture", tick.after.rho);
                } else {
                    assert!(time <= latest, "not captured after {time} s");
                }
                let (alpha, phi) = (tick.after.alpha.radians(), tick.after.phi.radians());
                situation = Situation {
                    trims: tick.trims,
                    ..Situation::polar(tick.after.rho, alpha, phi, tick.mind)
                };
                ticks += 1;
            }
        }
        println!(
            "{period} s, {position} m: captured by {longest:.1} s (bound {latest:.0} s), then within {farthest:.4} m (bound {last:.4} m)"
        );
    }
}

#[test]
fn the_random_numbers_fill_their_range() {
    let mut dice = Dice(7);
    let all: Vec<f64> = (0..1000).map(|_| dice.either()).collect();
    assert!(all.iter().all(|x| (-1.0..1.0).contains(x)));
    assert!(
        all.iter().copied().fold(0.0, Scalar::max) > 0.99
            && all.iter().copied().fold(0.0, Scalar::min) < -0.99
    );
}
