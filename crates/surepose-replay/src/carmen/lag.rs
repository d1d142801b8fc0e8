//! Estimates the lag between odometry and scans of a log, with its standard error.

use surepose::geometry::{Body, Map, Pose};
use surepose_io::recording::{Recording, StampedPose};

use crate::odometry::{RecordedOdometry, pose_of};

/// Prior of the lag in odometry records: mean and standard deviation. Loggers stamp a scan with the odometry received last.
const PRIOR: (f64, f64) = (0.5, 0.5);

/// Lags that are tried, in odometry records: the largest one, and their distance.
const MAX_LAG: f64 = 6.0;
const STEP: f64 = 0.05;

/// Noise of the heading difference between scans \[rad], at least: that of the reference.
const MIN_NOISE: f64 = 0.005;

/// Residuals beyond so many standard deviations count as outliers, with constant cost.
const OUTLIER: f64 = 3.0;

/// Delay of a scan's record, in odometry records.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScanLag {
    /// Records that the robot moved on between the scan and its line in the log.
    pub records: f64,
    /// Standard error \[records].
    pub std: f64,
}

impl ScanLag {
    /// The lag of a log without reference poses.
    pub const UNKNOWN: Self = Self { records: PRIOR.0, std: PRIOR.1 };

    /// Estimates the lag of `log`.
    ///
    /// During turns, the reference headings lag behind odometry. The lag minimizes the heading differences from scan to scan,
    /// robustly. It is one number of the whole log, a property of its recorder; a turn rate that is constant leaves it unknown.
    pub(super) fn estimate(log: &Recording<StampedPose>, odometry: &RecordedOdometry) -> Self {
        let views: Vec<_> = log.scans.iter().zip(&log.reference).collect();
        let pairs: Vec<Pair> = views
            .windows(2)
            .map(|pair| Pair {
                counts: [pair[0].0.odometry_before, pair[1].0.odometry_before],
                turn: (pose_of(pair[1].1).heading - pose_of(pair[0].1).heading).radians(),
            })
            .filter(|pair| (pair.counts[0]..=pair.counts[1]).skip(1).all(|count| !odometry.is_gap(count)))
            .collect();
        let residuals =
            |lag: f64| -> Vec<f64> { pairs.iter().filter_map(|pair| pair.residual(odometry, lag)).collect() };
        let mut magnitudes: Vec<f64> = residuals(PRIOR.0).iter().map(|residual| residual.abs()).collect();
        if magnitudes.len() < 5 {
            return Self::UNKNOWN;
        }
        magnitudes.sort_by(f64::total_cmp);
        let mut noise = 1.5 * magnitudes[magnitudes.len() / 2];
        let mut best = Self::UNKNOWN;
        // The noise of the residuals is that at the lag found.
        for _ in 0..3 {
            noise = noise.max(MIN_NOISE);
            let cost = |lag: f64| -> f64 {
                let prior = (lag - PRIOR.0) / (2.0 * PRIOR.1);
                let limit = OUTLIER * OUTLIER;
                let terms = residuals(lag).into_iter().map(|residual| (residual / noise).powi(2).min(limit));
                terms.sum::<f64>() + prior * prior
            };
            let count = (MAX_LAG / STEP) as u32;
            let lags = (0..=count).map(|step| f64::from(step) * STEP);
            let Some((_, lag)) = lags.map(|lag| (cost(lag), lag)).min_by(|a, b| a.0.total_cmp(&b.0)) else {
                break;
            };
            let information: f64 = residuals(lag)
                .iter()
                .zip(residuals(lag + STEP))
                .filter(|(at, _)| at.abs() < OUTLIER * noise)
                .map(|(at, beside)| ((beside - at) / STEP / noise).powi(2))
                .sum();
            let prior = 1.0 / PRIOR.1.powi(2);
            best = Self { records: lag, std: 1.0 / libm::sqrt(information + prior) };
            let mut at: Vec<f64> = residuals(lag).iter().map(|residual| residual.abs()).collect();
            at.sort_by(f64::total_cmp);
            noise = 1.5 * at[at.len() / 2];
        }
        best
    }
}

/// Two successive scans, with the turn between them by the reference \[rad].
struct Pair {
    counts: [usize; 2],
    turn: f64,
}

impl Pair {
    /// Turn by the reference beyond that by odometry, for this lag; `None` without odometry.
    fn residual(&self, odometry: &RecordedOdometry, lag: f64) -> Option<f64> {
        let pose = |count: usize| odometry.pose_after(odometry.before(count, lag));
        let [from, to]: [Pose<Map, Body, f64>; 2] = [pose(self.counts[0])?, pose(self.counts[1])?];
        let turn = (to.heading - from.heading).radians();
        Some(surepose::geometry::Angle::from_radians(self.turn - turn).radians())
    }
}
