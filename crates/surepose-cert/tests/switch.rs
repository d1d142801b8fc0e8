//! Tests of the mode switch and of the local mode against adversarial noise.
//!
//! Set `SUREPOSE_CERT_TRIALS=10000000` for the long run.

mod common;

use std::f64::consts::PI;

use common::{DRIVE, Rng, deployed, disturb, hybrid, noise, request, trials};
use surepose::control::{ControlOutput, Deadband, HybridLaw, HybridState, NavigationVariables};
use surepose::kinematics::Twist;
use surepose::scalar::{Mask, Scalar};
use surepose_cert::{
    DeployedController, DiscreteState, DisturbedState, LyapunovFunction, NoiseBounds, SampledController,
    TerminalPhase, Transition, certify,
};

fn terminal_phase<L: SampledController>(
    controller: &L,
    period: f64,
    bounds: NoiseBounds,
) -> Option<TerminalPhase> {
    let certificate = certify(&request(controller, hybrid(period).gains.h, period, bounds));
    certificate.terminal_phase
}

/// Chooses noise that provokes a mode switch.
///
/// In local mode, the estimated goal is as far away as possible, or the robot is pushed away from it.
/// Otherwise the estimated goal is as near as possible.
fn provoke(disturbed_state: &mut DisturbedState, bounds: &NoiseBounds, rng: &mut Rng) {
    let reach = bounds.position * (1.0 - 1e-12);
    let rho = disturbed_state.x.hypot(disturbed_state.y).max(1e-9);
    let (sin, cos) = disturbed_state.heading.sin_cos();
    // The estimate moves away from the goal for a large estimated distance, and toward it for a small one.
    let outward = (disturbed_state.x / rho, disturbed_state.y / rho);
    let ahead = -(disturbed_state.x * cos + disturbed_state.y * sin);
    let (x, y) = match (disturbed_state.discrete_state.local_mode, rng.flip()) {
        (false, _) => (-outward.0, -outward.1),
        (true, true) => outward,
        // A goal behind the robot appears ahead of it, so the robot drives away from the goal.
        (true, false) => (cos * ahead.signum(), sin * ahead.signum()),
    };
    let size = if disturbed_state.discrete_state.local_mode { 1.0 } else { (rho / reach).min(1.0) };
    (disturbed_state.noise_x, disturbed_state.noise_y) = (reach * size * x, reach * size * y);
    disturbed_state.noise_heading = bounds.heading * rng.either().signum();
}

/// State at the start of the next tick.
fn onward(tick: &Transition) -> DisturbedState {
    let (alpha, phi) = (tick.after.alpha.radians(), tick.after.phi.radians());
    DisturbedState {
        trim_ticks: tick.trim_ticks,
        lateral: tick.lateral,
        ..DisturbedState::polar(tick.after.rho, alpha, phi, tick.discrete_state)
    }
}

/// Least number of ticks from entry into the local mode to exit, and the number of mode switches, in `ticks`
/// ticks.
fn provoked<L: SampledController>(
    controller: &L,
    period: f64,
    bounds: &NoiseBounds,
    (seed, ticks): (u64, u64),
) -> (u64, u64) {
    let mut rng = Rng(seed);
    let lyapunov = LyapunovFunction { distance: 4.0, knee: 1.2, approach: 0.3 };
    let fresh = DiscreteState {
        local_mode: false,
        reverse: false,
        turn_direction: 0,
        drive_direction: 0,
        sidestep: 0,
    };
    let (mut least, mut changes, mut taken) = (u64::MAX, 0, None);
    let mut disturbed_state = DisturbedState::polar(0.03, 0.0, 0.0, fresh);
    for tick in 0..ticks {
        if tick % 1000 == 0 {
            let rho = 0.03 * rng.either().abs();
            disturbed_state = DisturbedState::polar(rho, PI * rng.either(), PI * rng.either(), fresh);
            taken = None;
        }
        provoke(&mut disturbed_state, bounds, &mut rng);
        let transition = disturbed_state.simulate(controller, &DRIVE, period, &lyapunov, true);
        match (disturbed_state.discrete_state.local_mode, transition.discrete_state.local_mode) {
            // The first decision may enter the local mode anywhere below the exit distance; it does not count as an entry.
            (false, true) if disturbed_state.discrete_state.turn_direction == 0 => taken = None,
            (false, true) => (taken, changes) = (Some(tick), changes + 1),
            (true, false) => {
                least = taken.map_or(least, |taken| least.min(tick - taken));
                changes += 1;
            }
            _ => {}
        }
        disturbed_state = onward(&transition);
    }
    (least, changes)
}

#[test]
fn bounded_noise_does_not_make_the_mode_switch_chatter() {
    for (k, period) in [0.02, 0.1].into_iter().enumerate() {
        let bounds = noise(0.007, 0.25);
        for deadband in [None, Some(Deadband::from_noise(0.005, period))] {
            let controller = deployed(HybridLaw { deadband, ..hybrid(period) });
            let terminal_phase = terminal_phase(&controller, period, bounds).expect("certified");
            let dwell = terminal_phase.switch_dwell as u64;
            let (least, changes) = provoked(&controller, period, &bounds, (k as u64, trials()));
            println!(
                "{period} s, {deadband:?}: certified {dwell} ticks, least observed {least}, {changes} switches"
            );
            assert!(
                terminal_phase.has_switch_hysteresis() && dwell as f64 * period > 0.1,
                "{terminal_phase:?}"
            );
            assert!(least >= dwell, "left the local mode after {least} ticks");
        }
    }
}

#[test]
fn certificate_reports_chatter_under_large_noise() {
    for period in [0.02, 0.1] {
        let bounds = noise(0.02, 1.2);
        let controller = deployed(hybrid(period));
        assert!(!terminal_phase(&controller, period, bounds).expect("certified").has_switch_hysteresis());
        let (least, changes) = provoked(&controller, period, &bounds, (9, 100_000));
        println!("{period} s: {changes} mode switches in 100000 ticks");
        assert!(least == 1 && changes > 30_000, "{least}, {changes}");
    }
}

#[test]
fn heading_error_decreases_to_its_bound_in_local_mode_under_noise() {
    for (k, (period, position, heading_deg)) in
        [(0.02, 0.007, 0.25), (0.1, 0.007, 0.25), (0.02, 0.02, 1.2), (0.1, 0.02, 1.2)].into_iter().enumerate()
    {
        let bounds = noise(position, heading_deg);
        let controller = deployed(hybrid(period));
        let terminal_phase = terminal_phase(&controller, period, bounds).expect("certified");
        let bound = terminal_phase.heading_bound.expect("shown");
        assert!(bound < 10_f64.to_radians(), "{terminal_phase:?}");
        let lyapunov = LyapunovFunction { distance: 4.0, knee: 1.2, approach: 0.3 };
        let value = |goal: &NavigationVariables<f64>| {
            let ahead = goal.rho * goal.alpha.sin_cos().1 / terminal_phase.length;
            0.5 * (goal.heading_error().radians().powi(2) + ahead * ahead)
        };
        let mut rng = Rng(40 + k as u64);
        let (mut looked, mut least) = (0_u64, f64::INFINITY);
        while looked < trials() / 4 {
            let side = if rng.flip() { 1 } else { -1 };
            let discrete_state = DiscreteState {
                local_mode: true,
                reverse: rng.flip(),
                turn_direction: side,
                drive_direction: 0,
                sidestep: 0,
            };
            let alpha = PI * rng.either();
            let error = (bound + (2.5 - bound) * rng.either().abs()) * rng.either().signum();
            let mut disturbed_state =
                DisturbedState::polar(0.06 * rng.either().abs(), alpha, alpha + error, discrete_state);
            disturb(&mut disturbed_state, &bounds, &mut rng);
            let tick = disturbed_state.simulate(&controller, &DRIVE, period, &lyapunov, true);
            let seen_side =
                tick.before.heading_error().radians() * f64::from(tick.discrete_state.turn_direction) < 0.0;
            if tick.discrete_state.claims_heading() && seen_side {
                looked += 1;
                let fall = (value(&tick.before) - value(&tick.after)) / period;
                least = least.min(fall);
                assert!(fall > 0.0, "V increases by {}: {disturbed_state:?} {tick:?}", -fall);
            }
        }
        println!("{period} s, {position} m: bound {:.1}°, least decrease {least:.4}/s", bound.to_degrees());
    }
}

/// Laws for which one of the claims is false.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    /// Exit from the local mode at 0.58 capture radii.
    NarrowHysteresis,
    /// Entry to and exit from the local mode at the same distance.
    NoHysteresis,
    /// No turn in local mode before the position is reached.
    WaitsForArrival,
    /// Reverse motion instead of a stop at the goal.
    BacksAwayAtRest,
    /// Entry into the local mode for one tick at a large distance, without a turn.
    TakesOverFarOut,
}

struct Mutant {
    law: DeployedController,
    fault: Fault,
}

impl SampledController for Mutant {
    fn compute<S: Scalar>(&self, seen: &NavigationVariables<S>, before: HybridState<S>) -> ControlOutput<S> {
        let mut before = before;
        match self.fault {
            Fault::NoHysteresis => before.local_mode = S::Mask::splat(false),
            Fault::NarrowHysteresis
            | Fault::WaitsForArrival
            | Fault::BacksAwayAtRest
            | Fault::TakesOverFarOut => {}
        }
        let mut output = self.law.compute(seen, before);
        let ahead = seen.rho * seen.alpha.sin_cos().1;
        let zero = S::from_f64(0.0);
        match self.fault {
            Fault::NarrowHysteresis => {
                let state = output.state;
                let local_mode = state.local_mode.and(seen.rho.lt(S::from_f64(0.58 * 0.033)));
                let trim_ticks = S::select(local_mode, state.trim_ticks, zero);
                let sidestep = S::select(local_mode, state.sidestep, zero);
                output.state = HybridState { local_mode, trim_ticks, sidestep, ..state };
            }
            Fault::WaitsForArrival => {
                let waits = output.state.local_mode.and(ahead.abs().gt(S::from_f64(0.35 * 0.033)));
                let still = Twist::new(output.twist.v, zero);
                output.twist = Twist::select(waits, still, output.twist);
            }
            Fault::BacksAwayAtRest => {
                let rests = ahead.abs().lt(S::from_f64(0.02));
                let away = Twist::new(ahead * S::from_f64(-2.0), output.twist.omega);
                output.twist = Twist::select(rests, away, output.twist);
            }
            Fault::TakesOverFarOut => {
                let far_out = seen.rho.gt(S::from_f64(0.033)).and(seen.rho.lt(S::from_f64(0.035)));
                let takes_over = far_out.and(!before.local_mode);
                output.state.local_mode = output.state.local_mode.or(takes_over);
                let still = Twist::new(output.twist.v, zero);
                output.twist = Twist::select(takes_over, still, output.twist);
            }
            Fault::NoHysteresis => {}
        }
        output
    }

    fn limit<S: Scalar>(&self, desired: Twist<S>) -> Twist<S> {
        self.law.limit(desired)
    }
}

#[test]
fn false_claims_are_not_certified() {
    // Other tests show that the law without a fault is certified.
    let plain = hybrid(0.02);
    let with_deadband = HybridLaw { deadband: Some(Deadband::from_noise(0.005, 0.02)), ..plain };
    let judged = |law: HybridLaw<f64>, fault: Fault, bounds| {
        certify(&request(&Mutant { law: deployed(law), fault }, law.gains.h, 0.02, bounds))
    };
    let (small, large) = (noise(0.007, 0.25), noise(0.02, 1.2));
    for fault in [Fault::NarrowHysteresis, Fault::NoHysteresis] {
        // The refusal is correct: the mode switch does chatter.
        for law in [plain, with_deadband] {
            let mutant = Mutant { law: deployed(law), fault };
            let (least, changes) = provoked(&mutant, 0.02, &small, (3, 100_000));
            println!("{fault:?}: left the local mode after {least} ticks, {changes} mode switches in 100000");
            assert_eq!(least, 1, "{fault:?}: no chatter");
        }
        let terminal_phase = judged(plain, fault, small).terminal_phase;
        assert!(
            !terminal_phase.is_some_and(|terminal_phase| terminal_phase.has_switch_hysteresis()),
            "{fault:?}: {terminal_phase:?}"
        );
    }
    let waits = judged(plain, Fault::WaitsForArrival, large).terminal_phase;
    assert!(waits.is_none_or(|terminal_phase| terminal_phase.heading_bound.is_none()), "{waits:?}");
    let takes_over = judged(plain, Fault::TakesOverFarOut, small);
    let terminal_phase = takes_over.terminal_phase;
    assert!(
        terminal_phase.is_none_or(|terminal_phase| terminal_phase.heading_bound.is_none()),
        "{terminal_phase:?}"
    );
    let stops =
        certify(&request(&deployed(with_deadband), with_deadband.gains.h, 0.02, small)).final_position_bound;
    let stops = stops.expect("shown");
    let backs = judged(with_deadband, Fault::BacksAwayAtRest, small);
    let stays = backs.final_position_bound.filter(|_| backs.certified);
    assert!(stays.is_none_or(|bound| bound > 2.0 * stops), "{stops} m without the fault; {backs:?}");
}
