//! Adversaries against the shipped step: the bounds for wheels that follow at once, and for wheels that do not.
//!
//! Set `SUREPOSE_CERT_TRIALS=10000000` for the long run.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a failed precondition fails the test")]

mod common;

use common::{DRIVE, noise, request, trials};
use surepose::control::{
    ActuatorModel, BrakingProfile, Controller, Direction, HybridLaw, Law, Limits, MinSpeeds, Tolerance,
};
use surepose_cert::{
    ActuatorErrors, AdversarySearch, Certificate, DeployedController, Request, WorstDrives, certify,
};

/// The shipped controller whose wheels accelerate by at most `acceleration` \[m/s²].
fn shipped(period: f64, acceleration: f64) -> Controller<f64> {
    let limits = Limits::symmetric(0.3, acceleration);
    let law = HybridLaw::fitted(&DRIVE, &limits, period, Direction::Auto);
    let braking = BrakingProfile::from_limits_if_needed(&DRIVE, &limits, &law.gains);
    let tolerance = Tolerance { position: 0.01, heading: 1_f64.to_radians(), dwell: 1.0, hysteresis: 1.5 };
    Controller { drive: DRIVE, law: Law::Hybrid(law), braking, limits, tolerance, period }
}

/// Certificate for wheels that follow at once, and the worst drives of the shipped controller.
fn searched(
    controller: &Controller<f64>,
    actuators: ActuatorErrors,
    ticks: u64,
) -> (Certificate, WorstDrives) {
    let Controller { law, braking, limits, period, .. } = *controller;
    let sensed = noise(0.007, 0.25);
    let bounds = actuators.widen(sensed, &DRIVE, &limits, period);
    let certified = DeployedController { law, drive: DRIVE, braking, limits };
    let certificate = certify(&Request { limits, ..request(&certified, law.gains().h, period, bounds) });
    let (radius, last) = (certificate.capture_radius.unwrap(), certificate.final_position_bound.unwrap());
    let search = AdversarySearch {
        controller,
        actuators,
        noise: sensed,
        capture_radius: radius,
        final_position_bound: last,
        time_bound: certificate.time_bound.unwrap(),
        ticks,
    };
    let worst = search.run();
    println!(
        "{period} s, {} m/s²: certified {radius:.4} m, then {last:.4} m; kept out at {:.4} m, then {:.4} m",
        limits.wheel_acceleration, worst.kept_out, worst.farthest
    );
    (certificate, worst)
}

#[test]
fn wheels_that_follow_at_once_keep_the_bounds_against_adversaries() {
    for period in [0.02, 0.1] {
        let (certificate, worst) = searched(&shipped(period, 1e9), ActuatorErrors::ideal(), trials() / 2);
        let (radius, last) = (certificate.capture_radius.unwrap(), certificate.final_position_bound.unwrap());
        assert!(worst.kept_out < radius && worst.farthest <= last && worst.violation.is_none(), "{worst:?}");
        // The bounds are not far from what an adversary reaches.
        assert!(radius < 4.0 * worst.kept_out && last < 3.0 * worst.farthest, "{worst:?}");
    }
}

/// The base is later than the controller knows, or as late as it knows, or ignores small speeds.
#[test]
fn delays_and_dead_bands_keep_the_bounds_against_adversaries() {
    let ideal = ActuatorModel::ideal();
    let min_speeds = MinSpeeds { wheel: 0.01, ..MinSpeeds::none() };
    for actuators in [
        ActuatorErrors { model: ideal, delay: 0.02 },
        ActuatorErrors { model: ideal, delay: 0.04 },
        ActuatorErrors::from_model(ActuatorModel { delay: 0.04, ..ideal }),
        ActuatorErrors::from_model(ActuatorModel { min_speeds, ..ideal }),
    ] {
        let (certificate, worst) = searched(&shipped(0.02, 1e9), actuators, trials());
        let (radius, last) = (certificate.capture_radius.unwrap(), certificate.final_position_bound.unwrap());
        assert!(worst.kept_out < radius && worst.farthest <= last, "{actuators:?}: {worst:?}");
    }
}

/// The limit of the acceleration is an assumption, not a formality.
#[test]
fn slow_wheels_leave_the_bounds() {
    let controller = shipped(0.1, 0.2);
    let (certificate, worst) = searched(&controller, ActuatorErrors::ideal(), 4_000_000);
    let violation = worst.violation.expect("a drive");
    let samples = violation.samples(&controller);
    let entered =
        samples.iter().position(|sample| sample.distance < certificate.capture_radius.unwrap()).unwrap();
    let farthest = samples[entered..].iter().map(|sample| sample.distance).fold(0.0, f64::max);
    assert!(farthest > 1.05 * certificate.final_position_bound.unwrap(), "{worst:?}");
    // Every estimate of that drive is within the noise bounds.
    for sample in samples {
        let off = (sample.pose[0] - sample.estimate[0]).hypot(sample.pose[1] - sample.estimate[1]);
        assert!(off <= 0.007, "{sample:?}");
    }
}
