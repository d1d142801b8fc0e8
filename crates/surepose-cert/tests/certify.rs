//! Tests of certified and refused controllers, with the promised figures.

mod common;

use common::{DRIVE, LIMITS, deployed, hybrid, noise, paper_gains, request};
use surepose::control::{ActuatorModel, Deadband, Gains, HybridLaw, Law, MinSpeeds, Tran2012Law};
use surepose_cert::{
    ActuatorErrors, DeployedController, MarginRequest, NoiseBounds, RefusalReason, Request, certify, drift,
    margin_map,
};

/// Period \[s]; noise of position \[m] and heading \[°]; upper bounds of capture radius and final position
/// bound \[m].
///
/// The specification requires 5 cm and 12 cm.
const CASES: [(f64, [f64; 2], [f64; 2]); 4] = [
    (0.02, [0.007, 0.25], [0.040, 0.049]),
    (0.02, [0.02, 1.2], [0.0521, 0.0635]),
    (0.1, [0.007, 0.25], [0.040, 0.049]),
    (0.1, [0.02, 1.2], [0.0521, 0.0778]),
];

#[test]
fn the_default_law_is_certified_at_both_periods_and_noises() {
    for (period, [position, heading_deg], [radius, last]) in CASES {
        let law = hybrid(period);
        let controller = deployed(law);
        let certificate = certify(&request(&controller, law.gains.h, period, noise(position, heading_deg)));
        assert!(certificate.certified, "{period} s, {position} m: {certificate:?}");
        assert!(certificate.capture_radius.is_some_and(|r| r <= radius), "{certificate:?}");
        assert!(certificate.final_position_bound.is_some_and(|bound| bound <= last), "{certificate:?}");
        assert!(certificate.decrease_rate.is_some_and(|rate| rate >= 0.2), "{certificate:?}");
    }
}

#[test]
fn law_with_deadband_is_certified() {
    for (period, [position, heading_deg], [radius, last]) in CASES {
        let law = hybrid(period);
        let law = HybridLaw { deadband: Some(Deadband::from_noise(0.005, period)), ..law };
        let controller = deployed(law);
        let certificate = certify(&request(&controller, law.gains.h, period, noise(position, heading_deg)));
        assert!(certificate.certified, "{period} s, {position} m: {certificate:?}");
        assert!(certificate.capture_radius.is_some_and(|r| r <= radius), "{certificate:?}");
        assert!(certificate.final_position_bound.is_some_and(|bound| bound <= last), "{certificate:?}");
    }
}

/// Errors of the actuators at 0.02 s, 7 mm and 0.25°: name, dead time \[s], minimum wheel speed \[m/s], wheel error, and the upper bound of
/// the capture radius \[m].
const ACTUATORS: [(&str, f64, f64, f64, f64); 4] = [
    ("dead time of one tick", 0.02, 0.0, 0.0, 0.0436),
    ("dead time of two ticks", 0.04, 0.0, 0.0, 0.0521),
    ("ignores 10 mm/s", 0.0, 0.01, 0.0, 0.0389),
    ("5 % of wheel error", 0.0, 0.0, 0.05, 0.0488),
];

#[test]
fn actuator_errors_widen_the_radius_by_a_little() {
    let law = hybrid(0.02);
    let controller = deployed(law);
    for (name, delay, wheel, part, radius) in ACTUATORS {
        let min_speeds = MinSpeeds { wheel, ..MinSpeeds::none() };
        // The base is late, and the controller does not know it.
        let errors = ActuatorErrors { model: ActuatorModel { min_speeds, ..ActuatorModel::ideal() }, delay };
        let sensed = NoiseBounds { rim_speed_part: part, ..noise(0.007, 0.25) };
        let bounds = errors.widen(sensed, &DRIVE, &LIMITS, 0.02);
        let certificate = certify(&request(&controller, law.gains.h, 0.02, bounds));
        println!("{name}: {:?}, {:?}", certificate.capture_radius, certificate.final_position_bound);
        assert!(certificate.capture_radius.is_some_and(|r| r <= radius), "{name}: {certificate:?}");
        assert!(certificate.final_position_bound.is_some(), "{name}: {certificate:?}");
    }
}

/// The turn direction keeps the side at ±π. The law of the paper has none, so noise selects it at every tick.
#[test]
fn law_of_the_paper_descends_without_noise_and_is_refused_with_it() {
    let gains = Gains { k_v: 1.0, k_alpha: 4.0, h: 0.3, k_theta: 2.0 };
    let law = Tran2012Law { gains, capture_radius: 0.02, capture_heading: std::f64::consts::PI };
    let controller = DeployedController { law: Law::Tran2012(law), ..deployed(hybrid(0.02)) };
    let quiet = certify(&request(&controller, gains.h, 0.02, noise(0.0, 0.0)));
    // The capture is shown; the heading error has the same cut at ±π, where only rounding selects the side.
    assert_eq!(quiet.reason, Some(RefusalReason::LocalLaw));
    let noisy = certify(&request(&controller, gains.h, 0.02, noise(0.007, 0.25)));
    assert_eq!(noisy.reason, Some(RefusalReason::NoDescent));
    let found = noisy.counterexample.expect("a concrete state");
    let bearing = found.transition.before.alpha.radians().abs();
    assert!(found.transition.lyapunov_after > found.transition.lyapunov_before && bearing > 3.1, "{found:?}");
}

#[test]
fn heading_bound_and_switch_hysteresis_hold_without_noise() {
    let law = hybrid(0.02);
    let controller = deployed(law);
    let quiet = certify(&request(&controller, law.gains.h, 0.02, noise(0.0, 0.0)));
    let terminal_phase = quiet.terminal_phase.expect("certified");
    assert!(terminal_phase.has_switch_hysteresis(), "{terminal_phase:?}");
    let noisy = certify(&request(&controller, law.gains.h, 0.02, noise(0.007, 0.25)));
    let terminal_phase = noisy.terminal_phase.expect("certified");
    assert!(
        terminal_phase.heading_bound.is_some_and(|bound| bound < 8_f64.to_radians()),
        "{terminal_phase:?}"
    );
}

#[test]
fn longest_period_is_found_and_twice_as_long_is_refused() {
    let law = hybrid(0.02);
    let controller = deployed(law);
    let asked =
        Request { max_period_searched: 1.0, ..request(&controller, law.gains.h, 0.02, noise(0.007, 0.25)) };
    let longest = certify(&asked).max_period.expect("certified");
    assert!((0.04..0.2).contains(&longest), "{longest}");
    let slow = certify(&request(&controller, law.gains.h, 2.0 * longest, noise(0.007, 0.25)));
    assert!(!slow.certified, "{slow:?}");
}

#[test]
fn paper_gains_at_100_ms_are_refused_with_a_confirmed_counterexample() {
    let controller = deployed(paper_gains(0.1));
    for noise in [noise(0.0, 0.0), noise(0.007, 0.25)] {
        let certificate = certify(&request(&controller, 1.0, 0.1, noise));
        assert!(!certificate.certified);
        assert_eq!(certificate.reason, Some(RefusalReason::UnstableByItself));
        let found = certificate.counterexample.expect("a concrete state");
        let again =
            found.disturbed_state.simulate(&controller, &DRIVE, 0.1, &certificate.lyapunov, found.limited);
        assert_eq!(again, found.transition);
        assert!(again.lyapunov_after > again.lyapunov_before, "{again:?}");
        // What goes wrong is visible without W: the bearing of the leading end swings through and grows.
        let bearing = |goal: &surepose::control::NavigationVariables<f64>| goal.alpha.radians().sin().abs();
        assert!(bearing(&again.after) > bearing(&again.before), "{again:?}");
    }
}

#[test]
fn noise_above_the_capture_radius_is_refused_with_a_confirmed_counterexample() {
    let law = hybrid(0.02);
    let controller = deployed(law);
    let certificate = certify(&request(&controller, law.gains.h, 0.02, noise(0.2, 5.0)));
    assert_eq!(certificate.reason, Some(RefusalReason::NoDescent));
    let found = certificate.counterexample.expect("a concrete state");
    assert!(found.limited && found.transition.lyapunov_after >= found.transition.lyapunov_before);
    let off = found.disturbed_state.noise_x.hypot(found.disturbed_state.noise_y);
    assert!(off <= 0.2 && found.disturbed_state.noise_heading.abs() <= 5_f64.to_radians());
}

#[test]
fn invalid_parameters_are_refused() {
    let law = hybrid(0.02);
    let controller = deployed(law);
    let plain = request(&controller, law.gains.h, 0.02, noise(0.007, 0.25));
    for asked in [
        Request { period: f64::NAN, ..plain },
        Request { period: 0.0, ..plain },
        Request { noise: noise(f64::INFINITY, 0.0), ..plain },
        Request { noise: noise(-0.1, 0.0), ..plain },
        Request { h: -1.0, ..plain },
        Request { workspace: f64::INFINITY, ..plain },
    ] {
        assert_eq!(certify(&asked).reason, Some(RefusalReason::Unusable), "{asked:?}");
    }
}

#[test]
fn w_decreases_on_average_under_gaussian_bench_noise() {
    for period in [0.02, 0.1] {
        let law = hybrid(period);
        let controller = deployed(law);
        let pose = Request {
            max_capture_radius: 0.3,
            ..request(&controller, law.gains.h, period, noise(0.005, 0.3))
        };
        let found = drift(&pose).expect("a drift condition");
        println!("{period} s, pose noise: {found:?}");
        assert!(found.radius < 0.15 && found.rate > 0.05, "{found:?}");
        let wheels = NoiseBounds { rim_speed_part: 0.05, ..pose.noise };
        println!(
            "{period} s, pose and wheel noise: {:?}",
            drift(&Request { noise: wheels, max_capture_radius: 1.0, ..pose })
        );
    }
}

/// The wheels stop at an estimate within the tolerance, widened by its release.
#[test]
fn average_decrease_is_claimed_only_where_the_wheels_turn() {
    let law = hybrid(0.02);
    let controller = deployed(law);
    let asked = request(&controller, law.gains.h, 0.02, noise(0.005, 0.3));
    let plain = drift(&asked).expect("a drift condition");
    let rests = |rests_within| drift(&Request { rests_within, ..asked });
    assert_eq!(rests(0.015).map(|found| found.radius), Some(plain.radius));
    let wide = rests(0.75).expect("a drift condition");
    assert!(wide.radius >= 0.75 + 4.5 * 0.005 && wide.expected_time < plain.expected_time, "{wide:?}");
    assert_eq!(rests(6.0), None, "the wheels may stop anywhere");
}

#[test]
fn margin_is_positive_in_all_cells_where_the_law_is_certified() {
    let law = hybrid(0.02);
    let controller = deployed(law);
    let asked = request(&controller, law.gains.h, 0.02, noise(0.007, 0.25));
    let lyapunov = certify(&asked).lyapunov;
    let at = |rho: f64, per_quadrant, boxes| {
        let asked_for = MarginRequest { rho: (rho, rho), per_quadrant, boxes, bare: false, shown: None };
        margin_map(&asked, lyapunov, asked_for, |_| true).expect("not canceled")
    };
    let map = at(0.1, 12, 24);
    assert_eq!(map.fall.len(), 48 * 48);
    assert!(map.fall.iter().all(|fall| *fall > 0.0));
    // More bisections give better bounds everywhere.
    let coarse = at(0.1, 12, 12);
    assert!(map.fall.iter().zip(&coarse.fall).all(|(fine, coarse)| fine >= coarse));
    let too_near = at(0.012, 6, 24);
    assert!(too_near.fall.iter().any(|fall| *fall < 0.0));
}

#[test]
fn no_margin_is_claimed_inside_the_deadband_region() {
    let law = hybrid(0.02);
    let controller = deployed(law);
    let asked = request(&controller, law.gains.h, 0.02, noise(0.007, 0.25));
    let radius = |rests_within| certify(&Request { rests_within, ..asked }).capture_radius;
    // The default tolerance, widened by its release factor, lies within the certified radius.
    assert_eq!(radius(0.015), radius(0.0));
    assert!(radius(0.06).is_some_and(|radius| (0.067..0.068).contains(&radius)));
    assert_eq!(certify(&Request { rests_within: 0.145, ..asked }).reason, Some(RefusalReason::RestsTooFar));
}
