//! What is certified and what is refused: the figures that Surepose promises.

mod common;

use common::{DRIVE, hybrid, noise, paper_gains, request, shipped};
use surepose::{HybridLaw, Rest};
use surepose_cert::{MarginAsked, Noise, Reason, Request, certify, drift, margin_map};

/// Period \[s], noise of the position \[m] and of the heading \[°], and what is certified of it: the capture radius and the
/// final position bound \[m], rounded up. What is promised is 5 cm and 12 cm.
const CASES: [(f64, [f64; 2], [f64; 2]); 4] = [
    (0.02, [0.007, 0.25], [0.040, 0.049]),
    (0.02, [0.02, 1.2], [0.059, 0.072]),
    (0.1, [0.007, 0.25], [0.040, 0.049]),
    (0.1, [0.02, 1.2], [0.083, 0.101]),
];

#[test]
fn the_default_law_is_certified_at_both_periods_and_noises() {
    for (period, [position, heading_deg], [radius, last]) in CASES {
        let law = hybrid(period);
        let subject = shipped(law);
        let certificate = certify(&request(&subject, law.gains.h, period, noise(position, heading_deg)));
        assert!(certificate.certified, "{period} s, {position} m: {certificate:?}");
        assert!(certificate.capture_radius.is_some_and(|r| r <= radius), "{certificate:?}");
        assert!(certificate.final_position_bound.is_some_and(|bound| bound <= last), "{certificate:?}");
        assert!(certificate.decrease_rate.is_some_and(|rate| rate >= 0.2), "{certificate:?}");
    }
}

#[test]
fn a_law_that_is_told_of_noise_is_certified_too() {
    for (period, [position, heading_deg], [radius, last]) in CASES {
        let law = hybrid(period);
        let law = HybridLaw { rest: Some(Rest::of(0.005, period)), ..law };
        let subject = shipped(law);
        let certificate = certify(&request(&subject, law.gains.h, period, noise(position, heading_deg)));
        assert!(certificate.certified, "{period} s, {position} m: {certificate:?}");
        assert!(certificate.capture_radius.is_some_and(|r| r <= radius), "{certificate:?}");
        assert!(certificate.final_position_bound.is_some_and(|bound| bound <= last), "{certificate:?}");
    }
}

#[test]
fn the_heading_comes_to_its_bound_and_without_noise_the_switch_keeps_its_mind() {
    let law = hybrid(0.02);
    let subject = shipped(law);
    let quiet = certify(&request(&subject, law.gains.h, 0.02, noise(0.0, 0.0)));
    let settling = quiet.settling.expect("certified");
    assert!(settling.switch_keeps_its_mind(), "{settling:?}");
    let noisy = certify(&request(&subject, law.gains.h, 0.02, noise(0.007, 0.25)));
    let settling = noisy.settling.expect("certified");
    assert!(settling.heading_bound.is_some_and(|bound| bound < 8_f64.to_radians()), "{settling:?}");
}

#[test]
fn a_longer_period_is_found_and_a_much_longer_one_is_not() {
    let law = hybrid(0.02);
    let subject = shipped(law);
    let asked = Request { longest_period: 1.0, ..request(&subject, law.gains.h, 0.02, noise(0.007, 0.25)) };
    let longest = certify(&asked).max_period.expect("certified");
    assert!((0.04..0.2).contains(&longest), "{longest}");
    let slow = certify(&request(&subject, law.gains.h, 2.0 * longest, noise(0.007, 0.25)));
    assert!(!slow.certified, "{slow:?}");
}

#[test]
fn the_paper_s_gains_are_refused_at_a_tenth_of_a_second_with_a_confirmed_counterexample() {
    let subject = shipped(paper_gains(0.1));
    for noise in [noise(0.0, 0.0), noise(0.007, 0.25)] {
        let certificate = certify(&request(&subject, 1.0, 0.1, noise));
        assert!(!certificate.certified);
        assert_eq!(certificate.reason, Some(Reason::UnstableByItself));
        let found = certificate.counterexample.expect("a concrete situation");
        let again = found.situation.simulate(&subject, &DRIVE, 0.1, &certificate.weight, found.limited);
        assert_eq!(again, found.consequence);
        assert!(again.weight_after > again.weight_before, "{again:?}");
        // What goes wrong is visible without W: the bearing of the leading end swings through and grows.
        let bearing = |goal: &surepose::Navigation<f64>| goal.alpha.radians().sin().abs();
        assert!(bearing(&again.after) > bearing(&again.before), "{again:?}");
    }
}

#[test]
fn noise_as_large_as_the_disc_is_refused_with_a_confirmed_counterexample() {
    let law = hybrid(0.02);
    let subject = shipped(law);
    let certificate = certify(&request(&subject, law.gains.h, 0.02, noise(0.2, 5.0)));
    assert_eq!(certificate.reason, Some(Reason::NoDescent));
    let found = certificate.counterexample.expect("a concrete situation");
    assert!(found.limited && found.consequence.weight_after >= found.consequence.weight_before);
    let off = found.situation.noise_x.hypot(found.situation.noise_y);
    assert!(off <= 0.2 && found.situation.noise_heading.abs() <= 5_f64.to_radians());
}

#[test]
fn numbers_that_make_no_sense_are_refused() {
    let law = hybrid(0.02);
    let subject = shipped(law);
    let plain = request(&subject, law.gains.h, 0.02, noise(0.007, 0.25));
    for asked in [
        Request { period: f64::NAN, ..plain },
        Request { period: 0.0, ..plain },
        Request { noise: noise(f64::INFINITY, 0.0), ..plain },
        Request { noise: noise(-0.1, 0.0), ..plain },
        Request { h: -1.0, ..plain },
        Request { workspace: f64::INFINITY, ..plain },
    ] {
        assert_eq!(certify(&asked).reason, Some(Reason::Unusable), "{asked:?}");
    }
}

#[test]
fn gaussian_noise_of_the_bench_lets_w_fall_on_average() {
    for period in [0.02, 0.1] {
        let law = hybrid(period);
        let subject = shipped(law);
        let pose = Request {
            largest_capture_radius: 0.3,
            ..request(&subject, law.gains.h, period, noise(0.005, 0.3))
        };
        let found = drift(&pose).expect("a drift");
        println!("{period} s, pose noise: {found:?}");
        assert!(found.radius < 0.15 && found.rate > 0.05, "{found:?}");
        let wheels = Noise { rim_speed_part: 0.05, ..pose.noise };
        println!(
            "{period} s, wheels too: {:?}",
            drift(&Request { noise: wheels, largest_capture_radius: 1.0, ..pose })
        );
    }
}

#[test]
fn the_margin_is_positive_all_round_where_the_law_is_certified() {
    let law = hybrid(0.02);
    let subject = shipped(law);
    let asked = request(&subject, law.gains.h, 0.02, noise(0.007, 0.25));
    let weight = certify(&asked).weight;
    let at = |rho: f64, per_quadrant, boxes| {
        let asked_for = MarginAsked { rho: (rho, rho), per_quadrant, boxes, bare: false, shown: None };
        margin_map(&asked, weight, asked_for, |_| true).expect("nobody ends it")
    };
    let map = at(0.1, 12, 24);
    assert_eq!(map.fall.len(), 48 * 48);
    assert!(map.fall.iter().all(|fall| *fall > 0.0));
    // More work gives better bounds, everywhere.
    let coarse = at(0.1, 12, 12);
    assert!(map.fall.iter().zip(&coarse.fall).all(|(fine, coarse)| fine >= coarse));
    let too_near = at(0.012, 6, 24);
    assert!(too_near.fall.iter().any(|fall| *fall < 0.0));
}

#[test]
fn nothing_is_claimed_where_the_robot_may_have_arrived_and_rest() {
    let law = hybrid(0.02);
    let subject = shipped(law);
    let asked = request(&subject, law.gains.h, 0.02, noise(0.007, 0.25));
    let radius = |rests_within| certify(&Request { rests_within, ..asked }).capture_radius;
    // The default tolerance, widened by its release, is inside of what is shown anyhow.
    assert_eq!(radius(0.015), radius(0.0));
    assert!(radius(0.06).is_some_and(|radius| (0.067..0.068).contains(&radius)));
    assert_eq!(certify(&Request { rests_within: 0.145, ..asked }).reason, Some(Reason::RestsTooFar));
}
