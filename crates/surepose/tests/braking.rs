//! Braking before the goal stays within the wheel acceleration limit at every speed limit.

use surepose::control::{BrakingProfile, Controller, ControllerState, Direction, Gains, Limits, Tolerance};
use surepose::geometry::{Angle, Body, Goal, Map, Pose};
use surepose::kinematics::{DiffDrive, Integration};

const DRIVE: DiffDrive<f64> = DiffDrive::new(0.05, 0.6);
/// Fraction of the wheel acceleration limit used for braking.
const SHARE: f64 = 0.7;

fn controller(speed: f64, acceleration: f64, period: f64) -> Controller<f64> {
    let limits = Limits::symmetric(speed, acceleration);
    let tolerance = Tolerance { position: 0.01, heading: 1f64.to_radians(), dwell: 1.0, hysteresis: 1.5 };
    Controller::fitted(DRIVE, limits, period, Direction::Auto, tolerance)
}

/// Parks from `start`; returns the time to the goal \[s] and the time in which the limits exceed the desired speed \[s].
///
/// The time to the goal is infinite if the robot does not arrive.
fn park(controller: &Controller<f64>, start: [f64; 3]) -> (f64, f64) {
    let goal: Pose<Map, Goal, f64> = Pose::new(0.0, 0.0, Angle::zero());
    let mut pose: Pose<Map, Body, f64> = Pose::new(start[0], start[1], Angle::from_radians(start[2]));
    let (mut state, mut late) = (ControllerState::new(), 0.0);
    for tick in 1..100_000 {
        let step = controller.step(state, pose, goal);
        pose = pose.integrate(step.limited.integrate_for(controller.period), Integration::Arc);
        let faster = controller.drive.wheel_speeds_from_twist(step.limited).max_abs()
            - controller.drive.wheel_speeds_from_twist(step.desired).max_abs();
        if faster > 1e-9 {
            late += controller.period;
        }
        state = step.state;
        if state.goal_checker.reached(&controller.tolerance) {
            return (f64::from(tick) * controller.period, late);
        }
    }
    (f64::INFINITY, late)
}

#[test]
fn braking_is_never_harder_than_the_wheels_can() {
    for acceleration in [0.05, 0.5, 5.0] {
        let limits = Limits::symmetric(1.0, acceleration);
        let braking = BrakingProfile::from_limits(&DRIVE, &limits);
        let allowed = SHARE * acceleration;
        for gain in [0.5, 2.0, 9.0] {
            let speed = |way: f64| gain * braking.linear_gain_factor(gain, way) * way;
            for k in 1..2000 {
                let (way, step) = (0.005 * f64::from(k), 1e-6);
                let deceleration = speed(way) * (speed(way + step) - speed(way - step)) / (2.0 * step);
                assert!(deceleration < allowed, "{acceleration} m/s², {gain}/s, {way} m: {deceleration}");
                // Distance at constant deceleration, and the exponential end.
                let solved = speed(way).powi(2) / (2.0 * allowed) + speed(way) / gain;
                assert!((solved / way - 1.0).abs() < 1e-9, "{way} m: {solved}");
            }
            assert!(
                (braking.linear_gain_factor(gain, 0.0) - 1.0).abs() < 1e-12,
                "the gain is reduced at the goal"
            );
            let (turn, way) = (braking.angular_gain_factor(gain, -1.0), 0.5 * DRIVE.wheel_separation);
            assert!(
                (turn - braking.linear_gain_factor(gain, way)).abs() < 1e-12,
                "the braking of a turn differs from that of its rim travel"
            );
        }
    }
}

#[test]
fn gains_within_the_limits_are_not_reduced() {
    let gains = |k: f64| Gains { k_v: k, k_alpha: k, h: 0.3, k_theta: k };
    let limits = Limits::symmetric(0.3, 0.5);
    assert!(
        BrakingProfile::from_limits_if_needed(&DRIVE, &limits, &gains(1.1)).is_none()
            && BrakingProfile::from_limits_if_needed(&DRIVE, &limits, &gains(1.2)).is_some()
    );
}

/// Straight ahead, only the distance to the goal determines the command.
#[test]
fn the_wheels_follow_to_the_goal() {
    for (speed, acceleration) in [(0.3, 0.5), (1.0, 0.5), (3.0, 0.5), (1.0, 0.1), (0.3, 5.0)] {
        let (_, late) = park(&controller(speed, acceleration, 0.02), [-4.0, 0.0, 0.0]);
        assert!(late < 0.03, "{speed} m/s, {acceleration} m/s²: {late} s");
    }
}

/// Higher limits of speed or acceleration do not delay the arrival by more than a tick and the hysteresis.
#[test]
fn higher_limits_do_not_delay_the_arrival() {
    const SLACK: f64 = 1.06;
    let starts = [[-2.0, -2.0, 0.0], [-4.0, 0.0, 0.0], [-1.0, 0.5, 2.0], [0.0, 1.0, -0.5], [3.0, -1.0, 1.0]];
    for (start, period) in starts.iter().flat_map(|start| [(*start, 0.02), (*start, 0.1)]) {
        let time = |speed, acceleration| park(&controller(speed, acceleration, period), start).0;
        let speeds = [0.1, 0.2, 0.3, 0.5, 1.0, 2.0].map(|speed| time(speed, 0.5));
        let accelerations = [0.02, 0.05, 0.1, 0.5, 2.0, 10.0].map(|acceleration| time(0.5, acceleration));
        for times in [speeds, accelerations] {
            let better = times.windows(2).all(|pair| pair[1] < SLACK * pair[0]);
            assert!(better && times[0].is_finite(), "{start:?}: {times:.1?} s");
        }
    }
}
