use surepose::control::{ActuatorModel, Controller, Direction, Tolerance};
use surepose_sim::{CancelToken, PlantModel, Traction};

use super::{
    DRIVE, HEADING_TOLERANCE, POSITION_TOLERANCE, PlantReport, PlantSweep, PoseSource, Precision, Starts,
    Sweep, SweepNoise, fitted_law, limits,
};

/// The robot of the benchmark on an ideal base.
fn ideal(runs: usize, period: f64, noise: SweepNoise) -> PlantSweep {
    let tolerance =
        Tolerance { position: POSITION_TOLERANCE, heading: HEADING_TOLERANCE, dwell: 1.0, hysteresis: 1.5 };
    PlantSweep {
        starts: Starts::Random(runs),
        controller: Controller {
            drive: DRIVE,
            law: fitted_law(period, Direction::Auto, noise),
            braking: None,
            limits: limits(),
            tolerance,
            period,
        },
        actuator: ActuatorModel::ideal(),
        stall_timeout: 5.0,
        progress_timeout: 20.0,
        drive: DRIVE,
        plant: PlantModel::default(),
        traction: Traction::default(),
        noise,
        threads: 2,
        seed: 1,
    }
}

fn run(sweep: &PlantSweep) -> PlantReport {
    sweep.run(&CancelToken::default())
}

/// On an ideal base, every trial takes the same time as in the sweep of the law alone.
#[test]
fn ideal_base_equals_the_sweep_of_the_law() {
    for period in [0.02, 0.1] {
        let plant = ideal(200, period, SweepNoise::NONE);
        let law = Sweep {
            starts: plant.starts.clone(),
            law: plant.controller.law,
            period,
            noise: SweepNoise::NONE,
            estimate: PoseSource::Given,
            precision: Precision::F64,
            threads: 1,
            seed: 1,
        };
        let (plant, law) = (run(&plant).figures, law.run(&CancelToken::default()));
        for (a, b) in plant.trials.iter().zip(&law.trials) {
            assert_eq!((a.success, a.steps, a.cusps), (b.success, b.steps, b.cusps), "{a:?} {b:?}");
            let path = a.path_m.zip(b.path_m).map_or(f64::NAN, |(a, b)| a - b);
            assert!(path.abs() < 1e-6, "{a:?} {b:?}");
        }
        assert_eq!((plant.runs, law.runs), (200, 200));
    }
}

#[test]
fn result_does_not_depend_on_the_number_of_threads() {
    let one = PlantSweep { threads: 1, ..ideal(30, 0.1, SweepNoise::BENCH) };
    let three = PlantSweep { threads: 3, ..one.clone() };
    assert_eq!(run(&one).figures.trials, run(&three).figures.trials);
}

#[test]
fn canceled_sweep_keeps_no_unfinished_trial() {
    let cancel = CancelToken::default();
    cancel.cancel();
    let report = ideal(30, 0.1, SweepNoise::NONE).run(&cancel);
    assert_eq!((report.figures.runs, report.figures.success_rate, report.timeouts), (0, None, 0));
}

/// A dead band that the robot does not know stops it before the goal, which is then aborted as `stalled`. Known, it parks.
#[test]
fn unknown_dead_band_stalls_the_robot() {
    let plant = PlantModel { min_speed: 0.03, ..PlantModel::default() };
    let unknown = PlantSweep { plant, ..ideal(20, 0.1, SweepNoise::NONE) };
    let report = run(&unknown);
    let (stalled, success) = (report.aborted.get("stalled").copied(), report.figures.success_rate);
    assert!(success < Some(0.5), "{report:?}");
    assert_eq!(
        stalled.map(|stalled| 1.0 - stalled as f64 / 20.0),
        success,
        "every other goal stalls: {report:?}"
    );
    let mut known = unknown;
    known.actuator.min_speeds.v = 0.03;
    assert_eq!(run(&known).figures.success_rate, Some(1.0));
}
