//! Comparison of certified bounds with simulations of random states and random bounded disturbances.
//!
//! Set `SUREPOSE_CERT_TRIALS=10000000` for the long run.

mod common;

use std::f64::consts::PI;

use common::{DRIVE, Rng, deployed, disturb, hybrid, noise, request, trials};
use surepose::control::{Deadband, HybridLaw};
use surepose::scalar::Scalar;
use surepose_cert::{Certificate, DeployedController, DiscreteState, DisturbedState, NoiseBounds, certify};

const CASES: [(f64, f64, f64); 4] =
    [(0.02, 0.007, 0.25), (0.1, 0.007, 0.25), (0.02, 0.02, 1.2), (0.1, 0.02, 1.2)];

fn certified(
    period: f64,
    noise: NoiseBounds,
    deadband: Option<Deadband<f64>>,
) -> (DeployedController, Certificate) {
    let law = HybridLaw { deadband, ..hybrid(period) };
    let controller = deployed(law);
    let certificate = certify(&request(&controller, law.gains.h, period, noise));
    assert!(certificate.certified);
    (controller, certificate)
}

#[test]
fn random_states_keep_the_certified_decrease() {
    for (k, (period, position, heading_deg)) in CASES.into_iter().enumerate() {
        let bounds = noise(position, heading_deg);
        let (controller, certificate) = certified(period, bounds, None);
        let (radius, rate) = (certificate.capture_radius.unwrap(), certificate.decrease_rate.unwrap());
        let mut rng = Rng(k as u64);
        let mut least = f64::INFINITY;
        for _ in 0..trials() / 4 {
            let rho = radius * (5.0 / radius).powf(0.5 * (1.0 + rng.either()));
            let side = if rng.flip() { 1 } else { -1 };
            let discrete_state = DiscreteState {
                local_mode: false,
                reverse: rng.flip(),
                turn_direction: side,
                drive_direction: 0,
                sidestep: 0,
            };
            let mut disturbed_state =
                DisturbedState::polar(rho, PI * rng.either(), PI * rng.either(), discrete_state);
            disturb(&mut disturbed_state, &bounds, &mut rng);
            let tick = disturbed_state.simulate(&controller, &DRIVE, period, &certificate.lyapunov, true);
            if tick.before.rho >= radius {
                let fall = (tick.lyapunov_before - tick.lyapunov_after) / period;
                least = least.min(fall);
                assert!(
                    fall >= rate * (1.0 - 1e-9),
                    "decrease rate {fall} too small: {disturbed_state:?} {tick:?}"
                );
            }
        }
        println!("{period} s, {position} m: certified {rate:.3}/s, least observed {least:.3}/s");
    }
}

/// Wheel errors at their bounds, which vary from tick to tick: 5 % of the speed, or as much as the pulses of a dead band of 10 mm/s.
#[test]
fn random_states_with_wheel_errors_keep_the_certified_decrease() {
    for (k, (rim_speed, rim_speed_part)) in [(0.0, 0.05), (0.0102, 0.0)].into_iter().enumerate() {
        let bounds = NoiseBounds { rim_speed, rim_speed_part, ..noise(0.007, 0.25) };
        let (controller, certificate) = certified(0.02, bounds, None);
        let (radius, rate) = (certificate.capture_radius.unwrap(), certificate.decrease_rate.unwrap());
        let mut rng = Rng(200 + k as u64);
        let mut least = f64::INFINITY;
        for _ in 0..trials() / 4 {
            // Most of them near the radius, where wheel errors count most.
            let rho = radius * (5.0 / radius).powf((0.5 * (1.0 + rng.either())).powi(3));
            let discrete_state = DiscreteState {
                local_mode: false,
                reverse: rng.flip(),
                turn_direction: if rng.flip() { 1 } else { -1 },
                drive_direction: 0,
                sidestep: 0,
            };
            let mut at = DisturbedState::polar(rho, PI * rng.either(), PI * rng.either(), discrete_state);
            disturb(&mut at, &bounds, &mut rng);
            let exact = at.simulate(&controller, &DRIVE, 0.02, &certificate.lyapunov, true);
            let rims = DRIVE.wheel_speeds_from_twist(exact.commanded);
            let most = |rim: f64| (rim_speed + rim_speed_part * rim.abs()) * (1.0 - 1e-12);
            at.noise_right = most(rims.right) * rng.either().signum();
            at.noise_left = most(rims.left) * rng.either().signum();
            let tick = at.simulate(&controller, &DRIVE, 0.02, &certificate.lyapunov, true);
            if tick.before.rho >= radius {
                let fall = (tick.lyapunov_before - tick.lyapunov_after) / 0.02;
                least = least.min(fall);
                assert!(fall >= rate * (1.0 - 1e-9), "decrease rate {fall} too small: {at:?} {tick:?}");
            }
        }
        println!("{rim_speed} m/s, {rim_speed_part}: certified {rate:.3}/s, least observed {least:.3}/s");
    }
}

#[test]
fn runs_keep_the_time_bound_and_the_final_position_bound() {
    for k in 0..2 * CASES.len() {
        let (period, position, heading_deg) = CASES[k / 2];
        let bounds = noise(position, heading_deg);
        let deadband = (k % 2 == 1).then(|| Deadband::from_noise(0.005, period));
        let (controller, certificate) = certified(period, bounds, deadband);
        let (radius, last) = (certificate.capture_radius.unwrap(), certificate.final_position_bound.unwrap());
        let latest = certificate.time_bound.unwrap();
        let mut rng = Rng(100 + k as u64);
        let (mut longest, mut farthest) = (0.0_f64, 0.0_f64);
        for _ in 0..12 {
            let fresh = DiscreteState {
                local_mode: false,
                reverse: false,
                turn_direction: 0,
                drive_direction: 0,
                sidestep: 0,
            };
            let mut disturbed_state = DisturbedState::polar(4.9, PI * rng.either(), PI * rng.either(), fresh);
            let mut captured = None;
            let mut ticks = 0_u32;
            while captured.is_none_or(|at| ticks < at + 2000) {
                disturb(&mut disturbed_state, &bounds, &mut rng);
                let tick = disturbed_state.simulate(&controller, &DRIVE, period, &certificate.lyapunov, true);
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
                disturbed_state = DisturbedState {
                    trim_ticks: tick.trim_ticks,
                    lateral: tick.lateral,
                    ..DisturbedState::polar(tick.after.rho, alpha, phi, tick.discrete_state)
                };
                ticks += 1;
            }
        }
        println!(
            "{period} s, {position} m, {deadband:?}: captured by {longest:.1} s (bound {latest:.0} s), then within {farthest:.4} m (bound {last:.4} m)"
        );
    }
}

#[test]
fn random_numbers_cover_their_range() {
    let mut rng = Rng(7);
    let all: Vec<f64> = (0..1000).map(|_| rng.either()).collect();
    assert!(all.iter().all(|x| (-1.0..1.0).contains(x)));
    assert!(
        all.iter().copied().fold(0.0, Scalar::max) > 0.99
            && all.iter().copied().fold(0.0, Scalar::min) < -0.99
    );
}
