//! The full loop in lanes: consistency, and independence of the number of threads.

use surepose::control::Direction;
use surepose_sim::CancelToken;

use super::{Filter, PoseSource, Precision, Starts, Sweep, SweepNoise, SweepReport, fitted_law};

fn run(runs: usize, filter: Filter, change: impl FnOnce(Sweep) -> Sweep) -> SweepReport {
    let sweep = Sweep {
        starts: Starts::Random(runs),
        law: fitted_law(0.1, Direction::Auto, SweepNoise::NONE),
        period: 0.1,
        noise: SweepNoise::BENCH,
        estimate: PoseSource::Filtered(filter),
        precision: Precision::F64,
        threads: 2,
        seed: 1,
    };
    change(sweep).run(&CancelToken::default())
}

/// Returns the mean NEES over the trials with equal weights, and its standard error. Trials are independent,
/// periods of a trial are not.
fn nees(report: &SweepReport) -> (f64, f64) {
    let means: Vec<f64> = report.trials.iter().filter_map(|trial| trial.nees_mean).collect();
    let count = means.len() as f64;
    let mean = means.iter().sum::<f64>() / count;
    let variance = means.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (count - 1.0);
    (mean, (variance / count).sqrt())
}

/// χ² with three degrees of freedom has the mean 3. The gate, which rejects the largest sensor errors, and
/// linearization change it by about 1 %.
#[test]
fn the_filter_is_consistent_in_both_formats_and_periods() {
    for precision in [Precision::F32, Precision::F64] {
        for period in [0.02, 0.1] {
            let law = fitted_law(period, Direction::Auto, SweepNoise::NONE);
            let report = run(4000, Filter::BENCH, |sweep| Sweep { law, period, precision, ..sweep });
            let (mean, error) = nees(&report);
            assert!((mean - 3.0).abs() < 0.03 + 4.0 * error, "{precision:?}, {period} s: {mean} ± {error}");
            assert!(error < 0.03, "{error}");
            let refused = report.refused_part.expect("a filter");
            assert!((0.0005..0.0015).contains(&refused), "rejected fraction {refused}, expected 0.001");
            assert_eq!(report.success_rate, Some(1.0), "{precision:?}, {period} s");
        }
    }
}

#[test]
fn wrong_sensor_noise_makes_the_filter_inconsistent() {
    let proud = Filter { wall_distance_std: 0.5 * Filter::BENCH.wall_distance_std, ..Filter::BENCH };
    let humble = Filter { delta: 4.0 * Filter::BENCH.delta, ..Filter::BENCH };
    let [proud, humble] = [proud, humble].map(|filter| nees(&run(1000, filter, |sweep| sweep)).0);
    assert!(proud > 3.5 && humble < 2.7, "{proud}, {humble}");
}

#[test]
fn with_exact_sensors_only_wheel_noise_remains() {
    let exact = run(200, Filter::BENCH, |sweep| Sweep { noise: SweepNoise::NONE, ..sweep });
    let noisy = run(200, Filter::BENCH, |sweep| sweep);
    assert!(exact.position_rmse_m < noisy.position_rmse_m, "{exact:?}");
    // Every measurement is consistent with the initial error of the belief.
    assert!(exact.refused_part.is_some_and(|part| part < 1e-3), "{:?}", exact.refused_part);
}

#[test]
fn beliefs_do_not_depend_on_threads() {
    let [one, three] = [1, 3].map(|threads| run(600, Filter::BENCH, |sweep| Sweep { threads, ..sweep }));
    assert_eq!(one.trials, three.trials);
}
