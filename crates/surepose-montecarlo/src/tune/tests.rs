use std::cell::Cell;

use surepose::control::{Direction, Gains, Law};

use crate::sweep::{PoseSource, Precision, Quantiles, Starts, Sweep, SweepNoise, SweepReport, fitted_law};

use super::{GainCandidate, Tune, TuneProgress, no_worse};

fn tune(law: Law<f64>, rounds: usize) -> Tune {
    let fallback = GainCandidate::from_law(&fitted_law(0.1, Direction::Auto, SweepNoise::BENCH));
    let scaled = |factor: f64| {
        let GainCandidate { gains: Gains { k_v, k_alpha, h, k_theta }, capture_radius } =
            GainCandidate::from_law(&law);
        let gains =
            Gains { k_v: k_v * factor, k_alpha: k_alpha * factor, h: h * factor, k_theta: k_theta * factor };
        GainCandidate { gains, capture_radius: capture_radius * factor }
    };
    Tune {
        sweep: Sweep {
            starts: Starts::Random(3000),
            law,
            period: 0.1,
            noise: SweepNoise::BENCH,
            estimate: PoseSource::Given,
            precision: Precision::F64,
            threads: 2,
            seed: 1,
        },
        fallback,
        least: scaled(0.1),
        most: scaled(10.0),
        rounds,
    }
}

fn fitted() -> Law<f64> {
    fitted_law(0.1, Direction::Auto, SweepNoise::BENCH)
}

/// A test certificate: it holds up to a capture radius that fast gains would exceed.
fn narrow(law: &Law<f64>) -> bool {
    GainCandidate::from_law(law).capture_radius <= 0.034
}

#[test]
fn the_result_is_faster_certified_and_reproducible() {
    let run = || tune(fitted(), 6).run(&narrow, &TuneProgress::default());
    let tuned = run();
    let best = tuned.best.expect("certified initial gains");
    assert!(narrow(&best.with(&fitted())) && best != tuned.start, "{best:?}");
    let after = tuned.after.expect("a best candidate");
    let (now, then) = (after.time_ratio.expect("arrived"), tuned.before.time_ratio.expect("arrived"));
    assert!(now.p50 < then.p50 - 0.005 && now.p95 <= then.p95, "got {now:?}, initially {then:?}");
    assert_eq!(after.success_rate, Some(1.0));
    assert_eq!(run().best, Some(best));
}

/// Faster in the median and at 95 %, but with a slower slowest trial: rejected.
#[test]
fn a_slower_slowest_trial_is_worse() {
    let before = tune(fitted(), 0).sweep.run(&surepose_sim::CancelToken::default());
    let (ratio, time) = (before.time_ratio.expect("arrived"), before.time_s.expect("arrived"));
    let quicker = Quantiles { p50: 0.9 * ratio.p50, p95: 0.9 * ratio.p95, ..ratio };
    let with_slowest = |max: f64| SweepReport {
        time_ratio: Some(quicker),
        time_s: Some(Quantiles { max, ..time }),
        ..before.clone()
    };
    assert!(no_worse(&with_slowest(time.max), &before));
    assert!(!no_worse(&with_slowest(time.max + 0.1), &before));
}

#[test]
fn without_a_certificate_there_is_no_result() {
    let tuned = tune(fitted(), 1).run(&|_| false, &TuneProgress::default());
    assert!(tuned.best.is_none() && tuned.after.is_none() && !tuned.start_certified);
    assert_eq!(tuned.before.runs, 3000);
}

/// Refused initial gains are replaced by certified ones, even if those are slower.
#[test]
fn refused_gains_are_replaced() {
    let law = GainCandidate { gains: Gains::tran2012(), capture_radius: 0.05 }.with(&fitted());
    let tuned = tune(law, 0).run(&narrow, &TuneProgress::default());
    assert!(!tuned.start_certified);
    assert_eq!(tuned.best, Some(GainCandidate::from_law(&fitted())));
}

/// If only the initial gains are certified, they are returned.
#[test]
fn without_a_better_candidate_the_gains_are_unchanged() {
    let start = GainCandidate::from_law(&fitted());
    let tuned = tune(fitted(), 1).run(&|law| GainCandidate::from_law(law) == start, &TuneProgress::default());
    assert_eq!((tuned.best, tuned.after.map(|r| r.trials)), (Some(start), Some(tuned.before.trials)));
}

#[test]
fn a_canceled_search_keeps_the_best_so_far() {
    let progress = TuneProgress::default();
    let asked = Cell::new(0);
    let tuned = tune(fitted(), 50).run(
        &|law| {
            asked.set(asked.get() + 1);
            if asked.get() == 2 {
                progress.cancel();
            }
            narrow(law)
        },
        &progress,
    );
    assert!(tuned.best.is_some_and(|best| narrow(&best.with(&fitted()))));
    assert!(tuned.before.runs == 2000 && asked.get() == 2, "{} certificates", asked.get());
}

#[test]
fn written_and_used_candidates_are_identical() {
    let candidate = GainCandidate::from_law(&fitted());
    let rounded = GainCandidate::from_logarithms(candidate.logarithms());
    let again = GainCandidate::from_logarithms(rounded.logarithms());
    assert_eq!(rounded, again);
    assert!((rounded.gains.k_v / candidate.gains.k_v - 1.0).abs() < 5e-4);
    assert!(rounded.gains.k_v.to_string().len() <= 6, "{}", rounded.gains.k_v);
}
