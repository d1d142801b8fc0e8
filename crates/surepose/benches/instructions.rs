//! Repeats one operation for instruction counts under callgrind; see `cargo xtask instructions`.
//!
//! `instructions NAME COUNT` runs operation NAME (`law`, `predict`, `compass`, `wall`, `cycle`, `delayed`, `considered`,
//! `step`) COUNT times.

use std::hint::black_box;
use std::process::ExitCode;

use surepose::control::{
    Controller, ControllerState, Direction, HybridState, Limits, NavigationVariables, Tolerance,
};
use surepose::estimation::{
    Belief, ConsideredParameters, DelayedEkf, Ekf, Gate, HeadingMeasurement, LineMeasurement, Measurement,
    WheelOdometry,
};
use surepose::geometry::{Angle, Goal, Line, Map, Pose};
use surepose::kinematics::{DiffDrive, Integration, WheelPair};
use surepose::time::{Stamp, Stamped};

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let (name, count) = (arguments.next(), arguments.next().and_then(|n| n.parse().ok()));
    if name.as_deref() == Some("--bench") {
        println!("run `cargo xtask instructions`, which counts instructions");
        return ExitCode::SUCCESS;
    }
    let (Some(name), Some(count)) = (name, count) else {
        eprintln!("usage: instructions law|predict|compass|wall|cycle|delayed|considered|step COUNT");
        return ExitCode::from(2);
    };
    let bench = Bench::new();
    let mut filter = bench.filter(&ConsideredParameters::default());
    if name == "considered" {
        filter = bench.filter(&all_considered());
    }
    let work: fn(&Bench, u32) = match name.as_str() {
        "delayed" | "considered" => {
            for k in 0..count {
                delayed_cycle(&mut filter, black_box(k));
            }
            return ExitCode::SUCCESS;
        }
        "law" => law,
        "predict" => predict,
        "compass" => compass,
        "wall" => wall,
        "cycle" => cycle,
        "step" => step,
        other => {
            eprintln!("unknown operation {other}");
            return ExitCode::from(2);
        }
    };
    for k in 0..count {
        work(&bench, black_box(k));
    }
    ExitCode::SUCCESS
}

/// Time between ticks \[s].
const PERIOD: f64 = 0.02;

struct Bench {
    ekf: Ekf<f64>,
    gate: Gate<f64>,
    controller: Controller<f64>,
    belief: Belief<f64>,
    walls: [Line<Map, f64>; 4],
}

impl Bench {
    fn new() -> Self {
        let drive = DiffDrive::new(0.05, 0.6);
        let limits = Limits::symmetric(0.3, 100.0);
        let tolerance = Tolerance { position: 0.01, heading: 0.017, dwell: 1.0, hysteresis: 1.5 };
        let quarter = |k: f64| Angle::from_degrees(90.0 * k);
        Self {
            ekf: Ekf { drive, delta: 0.0025, integration: Integration::Arc },
            gate: Gate::new(0.99),
            controller: Controller::fitted(drive, limits, PERIOD, Direction::Auto, tolerance),
            belief: Belief::new(Pose::new(1.5, 1.0, Angle::from_degrees(20.0)), [0.01, 0.01, 0.01]),
            walls: [
                Line::new(6.0, quarter(0.0)),
                Line::new(4.0, quarter(1.0)),
                Line::new(0.0, quarter(2.0)),
                Line::new(0.0, quarter(3.0)),
            ],
        }
    }

    fn sighting(&self, k: usize) -> LineMeasurement<f64> {
        let wall = self.walls[k];
        let seen = self.belief.pose.inverse() * wall;
        LineMeasurement {
            wall,
            seen,
            distance_variance: 1e-5,
            direction_variance: 1e-5,
            covariance: 1e-6,
            wall_variance: 0.0,
        }
    }

    fn filter(&self, parameters: &ConsideredParameters<f64>) -> DelayedEkf<f64, 64> {
        DelayedEkf::new(self.ekf, self.gate, 1.0, Stamp::default(), self.belief).with_considered(parameters)
    }

    fn rims(k: u32) -> WheelPair<f64> {
        let swing = f64::from(k % 16) * 1e-4;
        WheelPair::new(0.02 + swing, 0.02 - swing)
    }
}

#[inline(never)]
fn law(bench: &Bench, k: u32) {
    let angle = f64::from(k % 64) * 0.1 - 3.1;
    let navigation = NavigationVariables {
        rho: 1.0 + angle * 0.2,
        alpha: Angle::from_radians(angle),
        phi: Angle::from_radians(angle * 0.7),
    };
    black_box(bench.controller.law.compute(black_box(&navigation), HybridState::new()));
}

#[inline(never)]
fn predict(bench: &Bench, k: u32) {
    black_box(bench.ekf.predict(black_box(bench.belief), bench.ekf.wheel_odometry(Bench::rims(k))));
}

#[inline(never)]
fn compass(bench: &Bench, _: u32) {
    let compass = black_box(HeadingMeasurement { heading: Angle::from_degrees(20.1), std: 0.002 });
    let belief = black_box(bench.belief);
    black_box(bench.ekf.correct(belief, &compass.innovation(&belief), bench.gate.threshold(1)));
}

#[inline(never)]
fn wall(bench: &Bench, _: u32) {
    let belief = black_box(bench.belief);
    black_box(bench.ekf.correct(belief, &black_box(seen()[0]).innovation(&belief), bench.gate.threshold(2)));
}

/// Prediction, compass and four walls, each gated: the cycle of the paper's Fig. 4.
#[inline(never)]
fn cycle(bench: &Bench, k: u32) {
    let mut belief = bench.ekf.predict(black_box(bench.belief), bench.ekf.wheel_odometry(Bench::rims(k)));
    let compass = black_box(HeadingMeasurement { heading: Angle::from_degrees(20.1), std: 0.002 });
    belief = bench.ekf.correct(belief, &compass.innovation(&belief), bench.gate.threshold(1)).belief;
    for wall in black_box(seen()) {
        belief = bench.ekf.correct(belief, &wall.innovation(&belief), bench.gate.threshold(2)).belief;
    }
    black_box(belief);
}

/// All parameters that the filter can consider, with the deviations of an ordinary robot.
fn all_considered() -> ConsideredParameters<f64> {
    ConsideredParameters {
        compass_bias: 0.02,
        compass_delay: 0.01,
        laser_position: 0.005,
        laser_heading: 0.005,
        range_scale: 0.002,
        laser_delay: 0.01,
        radius_scale: 0.005,
        radius_difference: 0.005,
        separation_scale: 0.005,
        wall: 0.005,
    }
}

/// The measurements of [`cycle`] in the filter with history; odometry stands still, so that all of them pass the gate.
#[inline(never)]
fn delayed_cycle(filter: &mut DelayedEkf<f64, 64>, k: u32) {
    let stamp = Stamp::from_nanoseconds(20_000_000 * (i64::from(k) + 1));
    let swing = 1e-4 * f64::from(k % 2) - 5e-5;
    let odometry =
        WheelOdometry { travel: WheelPair::new(swing, -swing), variance: WheelPair::new(1e-8, 1e-8) };
    let _ = black_box(filter.predict_with(stamp, black_box(odometry)));
    let compass = black_box(HeadingMeasurement { heading: Angle::from_degrees(20.1), std: 0.002 });
    black_box(filter.update(Stamped::new(stamp, Measurement::Heading(compass))));
    for wall in black_box(seen()) {
        black_box(filter.update(Stamped::new(stamp, Measurement::Line(*wall))));
    }
}

/// From an estimated pose to turn rates of the wheels.
#[inline(never)]
fn step(bench: &Bench, k: u32) {
    let goal: Pose<Map, Goal, f64> = Pose::new(2.0, 2.0, Angle::from_degrees(f64::from(k % 90)));
    black_box(bench.controller.step(black_box(ControllerState::new()), bench.belief.pose, black_box(goal)));
}

/// The four walls as seen from the belief, made once.
fn seen() -> &'static [LineMeasurement<f64>; 4] {
    static SEEN: std::sync::OnceLock<[LineMeasurement<f64>; 4]> = std::sync::OnceLock::new();
    SEEN.get_or_init(|| {
        let bench = Bench::new();
        core::array::from_fn(|k| bench.sighting(k))
    })
}
