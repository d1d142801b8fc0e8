//! Pose measurements from a scan by ray casting to the first wall.

mod initial_beliefs;

use crate::estimation::{Belief, Ekf, PoseMeasurement};
use crate::linalg::Covariance;
use crate::map::Wall;
use crate::scalar::{Float, Scalar};

use super::beam_stats::BeamStats;
use super::beam_subset::BeamSubset;
use super::scan::{RangeFinder, Scan, ScanError};

use initial_beliefs::initial_beliefs;

/// Maximum number of beams of a scan that are compared with the map.
const BEAMS: usize = 128;

/// Maximum number of linearizations from one initial pose.
const MAX_ITERATIONS: u8 = 12;

/// Minimum pose uncertainty of the last linearizations: x and y \[m] and heading \[rad].
///
/// It decides which beams the map explains: those that end within a few of these standard deviations of a wall.
const MIN_LINEARIZATION_STD: [f64; 3] = [0.03, 0.03, 0.015];

/// Pose uncertainty of the last linearizations for a range noise of 1 m: x and y \[m] and heading \[rad].
///
/// On a map with cells of 10 cm, to which the range noise is set, a smaller one accepts few beams, and several wrong
/// headings explain as many as the right one.
const LINEARIZATION_STD_PER_RANGE_STD: [f64; 3] = [1.0, 1.0, 0.3];

/// Step \[m], \[rad] below which the iteration has converged.
const CONVERGED_STEP: f64 = 1e-3;

/// Weight of −2 log of the beams' likelihood against the belief, where results from several headings compete.
///
/// The errors of neighboring beams are correlated, so a scan counts as a few independent measurements.
const LIKELIHOOD_WEIGHT: f64 = 0.03;

/// Scan matching by the beam model, see [`BeamSubset::measure_pose`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeamModelMatcher<S> {
    /// Minimum fraction of beams that the map explains for a pose measurement, 0 to 1.
    pub min_hit_ratio: S,
    /// Standard deviations of x \[m], y \[m] and θ \[rad] of the error common to all beams of a scan.
    pub scan_std: [S; 3],
}

/// Result of comparing a scan with the map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeamMatch<S> {
    /// Agreement of the scan with the map at the pose found.
    pub stats: BeamStats<S>,
    /// Pose measured by the explained beams; `None` where the map explains too few.
    pub fix: Option<PoseMeasurement<S>>,
}

impl<S: Float> BeamModelMatcher<S> {
    /// Matches `scan` with the walls, starting at the belief at the time of the scan.
    ///
    /// Each iteration casts a ray for every beam and solves for the pose. The first assumes the uncertainty of the
    /// belief, each later one half as much, down to a few centimeters. Where the heading uncertainty permits wrong
    /// walls, several initial headings are tried and the most likely result is kept. The belief only guides the
    /// search; the measurement does not include it.
    ///
    /// The work is bounded: twelve iterations for each of at most 21 headings, times 128 beams times the walls within
    /// reach. A tracked pose needs one heading and two or three iterations.
    ///
    /// # Errors
    /// [`ScanError`] for a scan or laser that is invalid.
    pub fn match_scan(
        &self,
        ekf: &Ekf<S>,
        laser: &RangeFinder<S>,
        scan: &Scan<'_, S>,
        belief: &Belief<S>,
        walls: &[Wall<S>],
    ) -> Result<BeamMatch<S>, ScanError> {
        let beams = BeamSubset::<S, BEAMS>::from_scan(laser, scan)?;
        let mut best: Option<(S, Belief<S>)> = None;
        for initial in initial_beliefs(belief) {
            let Some(near) = iterate(ekf, &beams, &initial, walls, laser.range_std) else { continue };
            let stats = beams.evaluate(near.pose, &near.covariance, walls);
            let cost = stats.neg2_log_likelihood * S::from_f64(LIKELIHOOD_WEIGHT)
                + belief.covariance.mahalanobis_squared(near.error(belief.pose));
            if best.is_none_or(|(least, _)| cost < least) {
                best = Some((cost, near));
            }
        }
        let Some((_, near)) = best else {
            let stats = BeamStats { beams: beams.beams() as u16, ..BeamStats::default() };
            return Ok(BeamMatch { stats, fix: None });
        };
        let (stats, fix) = beams.measure_pose(&near, walls);
        let is_enough = stats.hits > 0 && stats.hit_ratio() >= self.min_hit_ratio;
        let fix = fix.ok().filter(|_| is_enough).map(|fix| fix.inflated(self.scan_std.map(Scalar::squared)));
        Ok(BeamMatch { stats, fix })
    }
}

/// Pose to which the iterations from `initial` converge, with the uncertainty of the last linearization.
fn iterate<S: Float>(
    ekf: &Ekf<S>,
    beams: &BeamSubset<S, BEAMS>,
    initial: &Belief<S>,
    walls: &[Wall<S>],
    range_std: S,
) -> Option<Belief<S>> {
    let last = [0, 1, 2].map(|axis| {
        let scaled = range_std * S::from_f64(LINEARIZATION_STD_PER_RANGE_STD[axis]);
        scaled.max(S::from_f64(MIN_LINEARIZATION_STD[axis]))
    });
    let mut std = [0, 1, 2].map(|axis| initial.covariance.std(axis).max(last[axis]));
    let mut pose = initial.pose;
    for _ in 0..MAX_ITERATIONS {
        let near = Belief::new(pose, std);
        let fix = beams.measure_pose(&near, walls).1.ok()?;
        let found = ekf.correct(*initial, &fix.innovation(initial), S::from_f64(f64::MAX)).belief;
        let step = found.error(pose);
        pose = found.pose;
        let is_final = (0..3).all(|axis| std[axis] <= last[axis]);
        if is_final && step.iter().all(|step| step.abs() < S::from_f64(CONVERGED_STEP)) {
            break;
        }
        std = [0, 1, 2].map(|axis| (std[axis] * S::from_f64(0.5)).max(last[axis]));
    }
    Some(Belief { pose, covariance: Covariance::from_std(last) })
}
