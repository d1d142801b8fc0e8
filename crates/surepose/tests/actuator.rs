//! The actuator stage: pulses for speeds that the base ignores, and the pose at which a delayed command takes effect.

use proptest::prelude::*;
use surepose::control::{ActuatorModel, ActuatorState, Limits, MinSpeeds};
use surepose::geometry::{Angle, Body, Map, Pose};
use surepose::kinematics::{DiffDrive, Integration, Twist};

/// A component of a twist.
type Part = fn(&Twist<f64>) -> f64;

const DRIVE: DiffDrive<f64> = DiffDrive::new(0.05, 0.4);
const LIMITS: Limits<f64> = Limits::symmetric(0.3, 0.5);

fn twists() -> impl Strategy<Value = Vec<Twist<f64>>> {
    // Held for several periods, as the commands of a drive are, with rests in between.
    let held = (-0.05..0.05, -0.3..0.3, 1..20_usize, prop::bool::weighted(0.1));
    let expand = |parts: Vec<(f64, f64, usize, bool)>| {
        let twist = |(v, omega, _, rests): (f64, f64, usize, bool)| {
            if rests { Twist::zero() } else { Twist::new(v, omega) }
        };
        parts.into_iter().flat_map(|part| vec![twist(part); part.2]).collect()
    };
    prop::collection::vec(held, 1..20).prop_map(expand)
}

/// The largest difference of the sums of `asked` and `sent` since the last rest, times `period`, for speeds below `min`.
fn deviation(asked: &[f64], sent: &[f64], rests: &[bool], min: f64, period: f64) -> f64 {
    let (mut owed, mut most) = (0.0_f64, 0.0_f64);
    for ((asked, sent), rests) in asked.iter().zip(sent).zip(rests) {
        let is_slow = asked.abs() < 1.02 * min;
        owed = if *rests { 0.0 } else { owed + if is_slow { (asked - sent) * period } else { 0.0 } };
        most = most.max(owed.abs());
    }
    most
}

fn is_executable(speed: f64, min: f64) -> bool {
    // Rims are rounded on their way through the twist.
    speed.abs() < 1e-15 || speed.abs() >= min
}

proptest! {
    /// The base executes every speed that is sent; its distance is that of the request within half a pulse; zero stays zero.
    #[test]
    fn modulated_motion_stays_within_half_a_pulse(
        asked in twists(), v in 0.0..0.04, omega in 0.0..0.2, wheel in 0.0..0.03, by_wheel: bool,
        period in 0.01..0.2,
    ) {
        let min_speeds = if by_wheel {
            MinSpeeds { wheel, ..MinSpeeds::none() }
        } else {
            MinSpeeds { v, omega, wheel: 0.0 }
        };
        let model = ActuatorModel { min_speeds, ..ActuatorModel::ideal() };
        let mut state = ActuatorState::new();
        let sent: Vec<_> = asked.iter().map(|twist| state.execute(&model, &DRIVE, &LIMITS, *twist, period)).collect();
        let rests: Vec<_> = asked.iter().map(|twist| *twist == Twist::zero()).collect();
        for (asked, sent) in asked.iter().zip(&sent) {
            prop_assert!(*asked != Twist::zero() || *sent == Twist::zero());
        }
        let ticks = min_speeds.pulse_ticks(&DRIVE, &LIMITS, period);
        let parts: [(Part, f64, u16); 2] = if by_wheel {
            [(|twist| DRIVE.wheel_speeds_from_twist(*twist).right, wheel, ticks.wheel),
             (|twist| DRIVE.wheel_speeds_from_twist(*twist).left, wheel, ticks.wheel)]
        } else {
            [(|twist| twist.v, v, ticks.v), (|twist| twist.omega, omega, ticks.omega)]
        };
        for (part, min, ticks) in parts {
            let of = |twists: &[Twist<f64>]| twists.iter().map(part).collect::<Vec<_>>();
            prop_assert!(of(&sent).iter().all(|speed| is_executable(*speed, min)));
            let bound = 1.0011 * 1.02 * min * f64::from(ticks) * period / 2.0;
            let deviation = deviation(&of(&asked), &of(&sent), &rests, min, period);
            prop_assert!(deviation <= bound + 1e-12, "{} > {}", deviation, bound);
        }
    }

    /// The prediction is the pose that a base with this dead time has when the next command takes effect.
    #[test]
    fn a_delayed_base_is_where_the_prediction_says(
        commands in twists(), delay in 0.0..0.5, period in 0.02..0.2,
    ) {
        let model = ActuatorModel { delay, ..ActuatorModel::ideal() };
        let mut state = ActuatorState::new();
        let start: Pose<Map, Body, f64> = Pose::new(1.0, -2.0, Angle::from_degrees(170.0));
        let (mut pose, mut sent) = (start, Vec::new());
        // The base executes the command sent at time t from t + delay on: exact arcs between the instants of change.
        let drive_on = |pose: Pose<Map, Body, f64>, sent: &[Twist<f64>], from: f64, to: f64| {
            let mut pose = pose;
            for (index, command) in sent.iter().enumerate() {
                let starts: f64 = index as f64 * period + delay;
                let time = f64::min(starts + period, to) - starts.max(from);
                if time > 0.0 {
                    pose = pose.integrate(command.integrate_for(time), Integration::Arc);
                }
            }
            pose
        };
        for (index, command) in commands.iter().enumerate() {
            let now = index as f64 * period;
            let predicted = state.predict(&model, pose);
            let arrives = drive_on(pose, &sent, now, now + delay);
            prop_assert!(predicted.origin().distance(arrives.origin()) < 1e-9);
            prop_assert!((predicted.heading - arrives.heading).radians().abs() < 1e-9);
            state.execute(&model, &DRIVE, &LIMITS, *command, period);
            sent.push(*command);
            pose = drive_on(pose, &sent, now, now + period);
        }
    }
}

/// For a base with lag the predicted pose moves with the command itself: the law sees a base without lag.
#[test]
fn the_prediction_hides_the_lag() {
    for (time_constant, period) in [(0.3, 0.02), (0.3, 0.2), (0.1, 0.1), (1.0, 0.05)] {
        let model = ActuatorModel { time_constant, ..ActuatorModel::ideal() };
        let (mut state, mut speed, mut travelled, mut asked) =
            (ActuatorState::new(), 0.0_f64, 0.0_f64, 0.0_f64);
        for tick in 0..400 {
            let predicted = state.predict(&model, Pose::new(travelled, 0.0, Angle::zero()));
            assert!(
                (predicted.x - asked).abs() < 4e-3 * 0.2 * time_constant,
                "τ {time_constant} s, period {period} s: {} against {asked}",
                predicted.x
            );
            let command = if tick % 50 < 25 { 0.2 } else { -0.1 };
            state.execute(&model, &DRIVE, &LIMITS, Twist::new(command, 0.0), period);
            // The exact response of u′ = (c − u)/τ, and its integral.
            let kept = (-period / time_constant).exp();
            travelled += command * period + (speed - command) * time_constant * (1.0 - kept);
            speed = command + (speed - command) * kept;
            asked += command * period;
        }
    }
}

/// A base that accelerates slowly reaches the minimum speed within a pulse, and covers what was asked for.
#[test]
fn pulses_last_until_the_wheels_reach_the_minimum() {
    let limits = Limits::symmetric(0.3, 0.1);
    let min_speeds = MinSpeeds { v: 0.03, ..MinSpeeds::none() };
    let model = ActuatorModel { min_speeds, ..ActuatorModel::ideal() };
    let (period, mut state, mut speed, mut travelled) = (0.02, ActuatorState::new(), 0.0_f64, 0.0_f64);
    for _ in 0..500 {
        let sent = state.execute(&model, &DRIVE, &limits, Twist::new(0.004, 0.0), period).v;
        let change = limits.wheel_acceleration * period;
        speed += (sent - speed).clamp(-change, change);
        travelled += speed * period;
    }
    // Ten seconds at 4 mm/s, within half a pulse of 0.32 s and what the last one still covers.
    assert!((travelled - 0.04).abs() <= 0.03 * 0.32, "{travelled}");
}

/// A pulse on top of a passing speed keeps the wheels within their limits: the passing speed yields.
#[test]
fn pulses_keep_the_limits_on_the_way() {
    let min_speeds = MinSpeeds { v: 0.02, omega: 0.08, wheel: 0.0 };
    let model = ActuatorModel { min_speeds, ..ActuatorModel::ideal() };
    let period = 0.1;
    for omega in [0.01, -0.03, 0.06] {
        let (mut state, mut limited, mut last, mut turned) =
            (ActuatorState::new(), Twist::zero(), Twist::zero(), 0.0_f64);
        for tick in 0..60 {
            let target = if tick < 40 { Twist::new(0.3, omega) } else { Twist::zero() };
            limited = LIMITS.limit(&DRIVE, target, limited, period);
            let sent = state.execute(&model, &DRIVE, &LIMITS, limited, period);
            let rims = DRIVE.wheel_speeds_from_twist(sent);
            assert!(rims.max_abs() <= LIMITS.wheel_speed + 1e-12, "{omega}, tick {tick}: {rims:?}");
            let change = DRIVE.wheel_speeds_from_twist(sent - last).max_abs();
            let ends = sent == Twist::zero();
            assert!(
                ends || change <= LIMITS.wheel_acceleration * period + 1e-12,
                "{omega}, tick {tick}: {change}"
            );
            turned += if tick < 40 { (sent.omega - limited.omega) * period } else { 0.0 };
            last = sent;
        }
        assert!(turned.abs() <= 1.02 * 0.08 * period / 2.0 + 1e-12, "{omega}: {turned}");
    }
}

/// Braking may be harder or softer than accelerating, for each wheel and both directions.
#[test]
fn wheels_brake_at_their_own_rate() {
    for (up, down) in [(0.5, 1.0), (0.5, 0.2)] {
        let limits = Limits { wheel_speed: 0.4, wheel_acceleration: up, wheel_deceleration: down };
        for (start, target) in [(0.0, 0.4), (0.4, 0.0), (-0.4, 0.0), (0.4, 0.2), (0.01, -0.4), (0.3, -0.3)] {
            let mut twist: Twist<f64> = Twist::new(start, 0.0);
            let mut time = 0.0;
            while (twist.v - target).abs() > 1e-9 && time < 10.0 {
                let next = limits.limit(&DRIVE, Twist::new(target, 0.0), twist, 0.02);
                let (is_braking, change) = (next.v.abs() < twist.v.abs(), (next.v - twist.v).abs());
                let reverses = next.v * twist.v < 0.0;
                let most = if reverses {
                    up.min(down)
                } else if is_braking {
                    down
                } else {
                    up
                };
                assert!(change <= most * 0.02 + 1e-12, "{twist:?} to {next:?}");
                twist = next;
                time += 0.02;
            }
            let braking = if start * target < 0.0 || f64::abs(target) < f64::abs(start) {
                (start.abs() - if start * target < 0.0 { 0.0 } else { target.abs() }) / down
            } else {
                0.0
            };
            let speeding =
                if f64::abs(target) > 0.0 && start * target <= 0.0 { target.abs() / up } else { 0.0 };
            assert!((time - braking - speeding).abs() <= 0.061, "{start} to {target}: {time} s");
        }
    }
}
