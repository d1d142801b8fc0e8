//! Bases with known parameters are found again from commands and quantized odometry.

#![allow(clippy::expect_used, reason = "a failed precondition fails the test")]

use core::f64::consts::TAU;

use surepose::kinematics::{DiffDrive, Twist, WheelPair};
use surepose::time::Stamp;
use surepose_io::recording::StampedTicks;
use surepose_sim::{Plant, PlantModel, Seed};

use super::calibrate_actuator;
use crate::calibrate::outcome::ParameterEstimate;
use crate::calibrate::recording::{CalibrationRecording, StampedCommand};

/// Encoder resolution, and the periods of odometry and commands \[s].
const TICKS_PER_TURN: f64 = 4096.0;
const ODOMETRY_PERIOD: f64 = 0.05;
const COMMAND_PERIOD: f64 = 0.1;

fn drive() -> DiffDrive<f64> {
    DiffDrive::new(0.06, 0.36)
}

/// Two minutes of commands: each is held for 0.4 to 1.6 s; a third of them are slow, some are rest.
fn recording(model: &PlantModel, seed: u64, smallest: f64) -> CalibrationRecording {
    let (drive, mut draw) = (drive(), Seed(seed).stream("commands"));
    let mut plant = Plant::default();
    let (mut twist, mut until) = (Twist::zero(), 0.0);
    let mut turned = WheelPair::zero();
    let mut recording = CalibrationRecording {
        ticks_per_turn: TICKS_PER_TURN,
        ticks: Vec::new(),
        scans: Vec::new(),
        headings: Vec::new(),
        commands: Vec::new(),
    };
    let step = 0.005;
    for k in 0..24_000_u32 {
        let now = f64::from(k) * step;
        if now >= until {
            until = now + draw.uniform(0.4, 1.6);
            let scale = if draw.uniform(0.0, 1.0) < 0.35 { 0.15 } else { 1.0 };
            let size = |value: f64, least: f64| value + least.copysign(value);
            twist = Twist::new(
                size(scale * draw.uniform(-0.35, 0.35), smallest),
                size(scale * draw.uniform(-1.0, 1.0), 4.0 * smallest),
            );
            if draw.uniform(0.0, 1.0) < 0.15 {
                twist = Twist::zero();
            }
        }
        if k % (COMMAND_PERIOD / step).round() as u32 == 0 {
            plant.send(model, Stamp::from_seconds(now), drive.wheel_rates_from_twist(twist));
            recording.commands.push(StampedCommand { time: now, twist });
        }
        if k % (ODOMETRY_PERIOD / step).round() as u32 == 0 {
            let ticks = |turned: f64| (turned / TAU * TICKS_PER_TURN).floor() as i64;
            recording.ticks.push(StampedTicks {
                time: now,
                left: ticks(turned.left),
                right: ticks(turned.right),
            });
        }
        let moved = plant.advance(model, &drive, Stamp::from_seconds(now), step);
        turned = WheelPair::new(turned.right + moved.right.mean * step, turned.left + moved.left.mean * step);
    }
    recording
}

fn found(recording: &CalibrationRecording, key: &str) -> Option<ParameterEstimate> {
    let estimates = calibrate_actuator(recording, &drive());
    estimates.iter().find(|(parameter, _)| parameter.key == key).map(|(_, estimate)| *estimate)
}

/// Asserts that `truth` is within `tolerance` and four standard errors of the estimate.
fn assert_found(case: &str, recording: &CalibrationRecording, key: &str, truth: f64, tolerance: f64) {
    let estimate = found(recording, key).expect("the key is reported");
    let (Some(value), Some(std)) = (estimate.value, estimate.std_error) else {
        panic!("{case}: {key} is not excited: {:?}", estimate.not_excited);
    };
    println!("{case}: {key} {value:.4} ± {std:.4}, truth {truth}");
    assert!(
        (value - truth).abs() <= tolerance.max(4.0 * std),
        "{case}: {key} {value} ± {std}, truth {truth}"
    );
    assert!(std <= tolerance, "{case}: {key} {value} ± {std}: a standard error above {tolerance}");
}

#[test]
fn delay_lag_and_limits_are_found() {
    for seed in [1, 2] {
        let model = PlantModel {
            command_delay: 0.12,
            wheel_acceleration: 0.6,
            wheel_deceleration: 1.0,
            ..PlantModel::default()
        };
        let limited = recording(&model, seed, 0.0);
        assert_found("limited", &limited, "command_delay_s", 0.12, 0.01);
        assert_found("limited", &limited, "wheel_acceleration_limit_m_s2", 0.6, 0.03);
        assert_found("limited", &limited, "wheel_deceleration_limit_m_s2", 1.0, 0.05);
        let model = PlantModel { command_delay: 0.08, lag: 0.15, ..PlantModel::default() };
        let lagging = recording(&model, seed, 0.0);
        assert_found("lagging", &lagging, "command_delay_s", 0.08, 0.01);
        assert_found("lagging", &lagging, "motor_time_constant_s", 0.15, 0.01);
    }
}

#[test]
fn minimum_speeds_are_found() {
    for seed in [1, 2] {
        let model = PlantModel {
            command_delay: 0.1,
            min_speed: 0.02,
            min_turn_rate: 0.08,
            wheel_acceleration: 0.6,
            wheel_deceleration: 0.6,
            ..PlantModel::default()
        };
        let base = recording(&model, seed, 0.0);
        assert_found("base", &base, "min_speed_m_s", 0.02, 0.004);
        assert_found("base", &base, "min_turn_rate_deg_s", 0.08_f64.to_degrees(), 1.0);
        assert!(found(&base, "min_wheel_speed_m_s").is_none(), "of the base, not of the wheels");
        let wheels = recording(&PlantModel { min_wheel_speed: 0.03, ..PlantModel::default() }, seed, 0.0);
        assert_found("wheels", &wheels, "min_wheel_speed_m_s", 0.03, 0.004);
    }
}

/// A parameter that the recording does not show has no value.
#[test]
fn ideal_base_has_neither_lag_nor_limits() {
    let ideal = recording(&PlantModel::default(), 3, 0.0);
    assert_found("ideal", &ideal, "command_delay_s", 0.0, 0.01);
    for key in [
        "motor_time_constant_s",
        "wheel_acceleration_limit_m_s2",
        "wheel_deceleration_limit_m_s2",
        "min_speed_m_s",
        "min_turn_rate_deg_s",
    ] {
        let estimate = found(&ideal, key).expect("the key is reported");
        assert!(estimate.value.is_none() && estimate.not_excited.is_some(), "{key}: {estimate:?}");
    }
    // The commands are all above the dead band, so that it cannot be seen.
    let fast = recording(&PlantModel { min_speed: 0.02, ..PlantModel::default() }, 4, 0.03);
    assert!(found(&fast, "min_speed_m_s").is_none_or(|estimate| estimate.value.is_none()));
}

#[test]
fn commands_of_another_clock_or_too_few_give_no_value() {
    let mut late = recording(&PlantModel::default(), 5, 0.0);
    for command in &mut late.commands {
        command.time += 1e6;
    }
    assert!(found(&late, "command_delay_s").is_some_and(|estimate| estimate.value.is_none()));
    let none = CalibrationRecording { commands: Vec::new(), ..late };
    assert!(calibrate_actuator(&none, &drive()).is_empty());
}
