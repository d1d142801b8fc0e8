use core::f64::consts::{FRAC_PI_2, PI, TAU};

use surepose::control::{Direction, Gains, Law, Tran2012Law};
use surepose::geometry::Angle;
use surepose_sim::CancelToken;
use surepose_simd::uniform;

use super::{PoseSource, Precision, Quantiles, Start, Starts, Sweep, SweepNoise, SweepReport, fitted_law};

fn sweep(runs: usize, period: f64, noise: SweepNoise) -> Sweep {
    Sweep {
        starts: Starts::Random(runs),
        law: fitted_law(period, Direction::Auto, noise),
        period,
        noise,
        estimate: PoseSource::Given,
        precision: Precision::F64,
        threads: 2,
        seed: 1,
    }
}

fn run(sweep: &Sweep) -> SweepReport {
    sweep.run(&CancelToken::default())
}

/// Required figures of the default law at both periods.
#[test]
fn the_default_law_meets_its_required_figures() {
    for (period, noise, [p50, p95]) in [
        (0.02, SweepNoise::NONE, [1.01, 1.03]),
        (0.02, SweepNoise::BENCH, [1.11, 1.22]),
        (0.1, SweepNoise::NONE, [1.09, 1.23]),
        (0.1, SweepNoise::BENCH, [1.13, 1.30]),
    ] {
        let report = run(&sweep(20_000, period, noise));
        let report = SweepReport { trials: Vec::new(), ..report };
        let case = format!("{period} s, {noise:?}: {report:?}");
        assert_eq!(report.success_rate, Some(1.0), "{case}");
        let some = |spread: Option<Quantiles>| spread.expect("successful trials");
        let (ratio, path) = (some(report.time_ratio), some(report.path_ratio));
        assert!(ratio.p50 <= p50 && ratio.p95 <= p95 && path.p50 <= 1.02, "{case}");
        let cusps = report.cusps_mean.expect("successful trials");
        assert!(cusps <= if noise == SweepNoise::NONE { 0.3 } else { 2.0 }, "{case}");
        assert!(some(report.final_position_error_m).p95 <= 0.0045, "{case}");
        assert!(some(report.final_heading_error_deg).p95 <= 0.2, "{case}");
    }
}

/// Starts 1 to 4 cm from the goal, `around` it or exactly beside it, with headings within ±`heading_deg`.
fn starts_aside(count: usize, around: bool, heading_deg: f64) -> Starts {
    let draw = |k: usize| uniform(17, k as u64);
    let start = |k: usize| {
        let (distance, angle) = (0.01 + 0.03 * draw(3 * k), TAU * draw(3 * k + 1));
        let angle = if around { angle } else { FRAC_PI_2.copysign(angle - PI) };
        let heading = Angle::from_degrees(heading_deg * (2.0 * draw(3 * k + 2) - 1.0));
        Start::new(distance * angle.cos(), distance * angle.sin(), heading)
    };
    Starts::Given((0..count).map(start).collect())
}

/// A goal a little aside needs one sidestep, not a series of approaches.
#[test]
fn a_goal_a_little_aside_is_reached_soon() {
    for (around, heading_deg) in [(false, 10.0), (true, 10.0), (true, 180.0)] {
        for known in [SweepNoise::NONE, SweepNoise::BENCH] {
            let law = fitted_law(0.02, Direction::Auto, known);
            let starts = starts_aside(2000, around, heading_deg);
            let report = run(&Sweep { starts, law, ..sweep(0, 0.02, SweepNoise::BENCH) });
            let time = report.time_s.expect("successful trials");
            let case = format!("around: {around}, ±{heading_deg}°, {known:?}: {time:?}");
            assert_eq!(report.success_rate, Some(1.0), "{case}");
            assert!(time.p95 <= 8.0 && time.max <= 15.0, "{case}");
        }
    }
}

/// With a given noise level the law has a deadband.
#[test]
fn without_a_noise_parameter_the_law_follows_the_noise() {
    let aware = sweep(300, 0.02, SweepNoise::BENCH);
    let unaware = Sweep { law: fitted_law(0.02, Direction::Auto, SweepNoise::NONE), ..aware.clone() };
    let [aware, unaware] = [aware, unaware].map(|sweep| run(&sweep).cusps_mean.expect("successful trials"));
    assert!(aware < 3.0 && unaware > 15.0, "cusps: {aware} with the noise parameter, {unaware} without");
}

#[test]
fn every_direction_of_approach_and_both_formats_succeed() {
    for direction in [Direction::Forward, Direction::Reverse, Direction::Auto] {
        for precision in [Precision::F32, Precision::F64] {
            let law = fitted_law(0.1, direction, SweepNoise::BENCH);
            let report = run(&Sweep { law, precision, ..sweep(300, 0.1, SweepNoise::BENCH) });
            assert_eq!(report.success_rate, Some(1.0), "{direction:?}, {precision:?}");
        }
    }
}

/// Wheel saturation keeps the paper's law from diverging without noise; with noise it rarely comes to rest.
#[test]
fn the_papers_law_fails_under_noise() {
    let law = Law::Tran2012(Tran2012Law {
        gains: Gains::tran2012(),
        capture_radius: 0.01,
        capture_heading: core::f64::consts::PI,
    });
    let [clean, noisy] = [SweepNoise::NONE, SweepNoise::BENCH]
        .map(|noise| run(&Sweep { law, ..sweep(50, 0.02, noise) }).success_rate.unwrap_or(0.0));
    assert!(clean > 0.99 && noisy < 0.5, "success rates: {clean} without noise, {noisy} with noise");
}

#[test]
fn threads_and_progress_do_not_change_results() {
    let one = run(&Sweep { threads: 1, ..sweep(200, 0.1, SweepNoise::BENCH) });
    let four = run(&Sweep { threads: 4, ..sweep(200, 0.1, SweepNoise::BENCH) });
    assert_eq!(one.trials, four.trials);
    let other = run(&Sweep { seed: 2, ..sweep(200, 0.1, SweepNoise::BENCH) });
    assert_ne!(one.trials, other.trials);
}

#[test]
fn parts_of_a_sweep_repeat_its_trials() {
    let sweep = sweep(300, 0.1, SweepNoise::BENCH);
    let part =
        |first, count| run(&Sweep { starts: Starts::RandomFrom { first, count }, ..sweep.clone() }).trials;
    assert_eq!([part(0, 100), part(100, 200)].concat(), run(&sweep).trials);
}

#[test]
fn a_sweep_canceled_at_once_has_no_figures() {
    let cancel = CancelToken::default();
    cancel.cancel();
    let report = sweep(1000, 0.1, SweepNoise::NONE).run(&cancel);
    assert!(report.runs == 0 && report.time_s.is_none() && report.success_rate.is_none());
}

/// Half of these trials fail, which takes ten times longer: a canceled sweep must not be biased to quick
/// trials.
#[test]
fn a_canceled_sweep_equals_a_shorter_one() {
    let law = Law::Tran2012(Tran2012Law {
        gains: Gains::tran2012(),
        capture_radius: 0.033,
        capture_heading: core::f64::consts::PI,
    });
    let of = |runs| Sweep { law, threads: 2, ..sweep(runs, 0.1, SweepNoise::BENCH) };
    let cancel = CancelToken::default();
    let stopped = std::thread::scope(|scope| {
        let stopped = scope.spawn(|| of(10_000_000).run(&cancel));
        while cancel.completed() < 5000 {
            std::thread::yield_now();
        }
        cancel.cancel();
        stopped.join().unwrap()
    });
    assert!(stopped.runs > 3000, "{}", stopped.runs);
    let shorter = run(&of(stopped.runs));
    assert_eq!(stopped.success_rate, shorter.success_rate);
    assert!(stopped.success_rate.is_some_and(|rate| rate < 0.8));
    assert_eq!(stopped.trials, shorter.trials);
}

#[test]
fn trials_use_the_given_starts() {
    let starts = vec![
        Start::new(-1.0, 0.0, Angle::zero()),
        Start::new(0.0, 0.0, Angle::zero()),
        Start::new(0.0, 0.0, Angle::half_turn()),
    ];
    let report = run(&Sweep { starts: Starts::Given(starts), ..sweep(0, 0.02, SweepNoise::NONE) });
    assert_eq!((report.runs, report.success_rate), (3, Some(1.0)));
    let [ahead, there, round] = [0, 1, 2].map(|k| report.trials[k]);
    // 0.99 m at 0.3 m/s, and some time for braking.
    assert!(ahead.time_s.is_some_and(|time| (3.3..3.5).contains(&time)), "{ahead:?}");
    assert_eq!((there.time_s, there.time_ratio(), there.steps), (Some(0.0), None, 50));
    // Half a turn at 1 rad/s.
    assert!(round.time_s.is_some_and(|time| (3.1..3.5).contains(&time)), "{round:?}");
}

#[test]
fn the_report_has_the_documented_keys() {
    let json = serde_json::to_value(run(&sweep(20, 0.1, SweepNoise::BENCH))).expect("serializable data");
    for key in [
        "runs",
        "success_rate",
        "steps",
        "wall_s",
        "steps_per_s",
        "time_s",
        "time_ratio",
        "path_ratio",
        "final_position_error_m",
        "final_heading_error_deg",
        "cusps_mean",
        "seed",
    ] {
        assert!(!json[key].is_null(), "{key} is missing");
    }
    assert!(json["time_s"]["p50"].as_f64() <= json["time_s"]["p95"].as_f64());
}

#[test]
fn quantiles_are_those_of_the_sample() {
    let spread = Quantiles::from_values((1..=100).rev().map(f64::from)).expect("not empty");
    assert_eq!((spread.p50, spread.p95, spread.max), (50.0, 95.0, 100.0));
    assert_eq!(Quantiles::from_values([]), None);
}
