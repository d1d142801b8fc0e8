//! Bench of actuators, reduced: fewer trials per cell than `cargo xtask long`, pooled over the control periods.

#![allow(clippy::expect_used, reason = "a failed precondition fails the test")]

use std::collections::BTreeMap;

use surepose_experiments::actuators::{PERIODS, actuator_cells};

/// Trials per cell.
const RUNS: usize = 25;
/// Success rate that the trials of one base must have. With 75 to 100 trials the required 99 % and 97 % cannot be distinguished.
const REQUIRED: f64 = 0.96;

#[test]
fn robots_park_on_every_base_that_they_know() {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let mut bases: BTreeMap<(Vec<&str>, bool), Vec<f64>> = BTreeMap::new();
    for cell in actuator_cells().into_iter().filter(|cell| cell.is_feasible) {
        let report = cell.run(RUNS, threads, 7).expect("valid options");
        let success = report.figures.success_rate.expect("trials");
        bases.entry((cell.factors, cell.noisy)).or_default().push(success);
    }
    for (base, rates) in &bases {
        let mean = rates.iter().sum::<f64>() / rates.len() as f64;
        assert!(mean >= REQUIRED, "{base:?}: {rates:?}");
    }
}

/// The bench has an ideal base, 14 factors and their 70 pairs of different kinds; a base whose least motion in one period is
/// larger than the tolerance is not judged.
#[test]
fn bench_has_every_pair_of_factors() {
    let cells = actuator_cells();
    assert_eq!(cells.len(), 2 * PERIODS.len() * (1 + 14 + 70));
    for cell in &cells {
        let is_coarse = cell.period > 0.15
            && cell.factors.iter().any(|name| ["turn rate 5.7 °/s", "wheels 30 mm/s"].contains(name));
        assert_eq!(cell.is_feasible, !is_coarse, "{cell:?}");
    }
}
