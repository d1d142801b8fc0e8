//! Outcomes of measurements: accepted, or rejected for a named and counted reason.

/// Outcome of one measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MeasurementOutcome {
    /// The measurement corrected the belief.
    Accepted {
        /// Normalized innovation squared νᵀ S⁻¹ ν, χ² distributed for a consistent filter.
        nis: f64,
    },
    /// The measurement did not change the belief.
    Rejected(RejectReason),
}

/// Outcome of the odometry of one step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OdometryOutcome {
    /// Odometry predicted the belief.
    Used,
    /// Odometry was rejected, and the command predicted the belief.
    Rejected(RejectReason),
    /// Odometry was missing, and the command predicted the belief.
    Missing,
}

/// Reason for the rejection of a measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum RejectReason {
    /// A value is NaN or infinite, or a range or travel is impossibly large.
    NotFinite,
    /// A variance is not positive or outside the range of sensors, or a covariance is not positive definite.
    BadVariance,
    /// The stamp is older than the history.
    Stale,
    /// The stamp is later than the odometry.
    Future,
    /// The innovation lies outside the χ² gate.
    Outlier,
    /// Scan with invalid beam angles, an invalid laser model, or more beams than the capacity.
    UnreadableScan,
}

impl RejectReason {
    /// Every reason, in the order of [`MeasurementStats`].
    pub const ALL: [Self; 6] =
        [Self::NotFinite, Self::BadVariance, Self::Stale, Self::Future, Self::Outlier, Self::UnreadableScan];

    /// The name used in reports and JSON.
    pub const fn name(self) -> &'static str {
        match self {
            Self::NotFinite => "not_finite",
            Self::BadVariance => "bad_variance",
            Self::Stale => "stale",
            Self::Future => "future",
            Self::Outlier => "outlier",
            Self::UnreadableScan => "unreadable_scan",
        }
    }
}

/// Counts of accepted measurements, and of rejected measurements, scans and odometry by reason.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MeasurementStats {
    /// Measurements that corrected the belief.
    pub accepted: u32,
    /// Odometry that ended before the newest belief: the clock was set back.
    pub clock_resets: u32,
    rejected: [u32; RejectReason::ALL.len()],
}

impl MeasurementStats {
    /// Counts one outcome.
    pub fn count(&mut self, outcome: MeasurementOutcome) {
        match outcome {
            MeasurementOutcome::Accepted { .. } => self.accepted = self.accepted.saturating_add(1),
            MeasurementOutcome::Rejected(reason) => {
                if let Some(entry) = self.rejected.get_mut(reason as usize) {
                    *entry = entry.saturating_add(1);
                }
            }
        }
    }

    /// Number of rejections for `reason`.
    pub fn rejected(&self, reason: RejectReason) -> u32 {
        self.rejected.get(reason as usize).copied().unwrap_or(0)
    }

    /// Number of all rejections.
    pub fn rejected_total(&self) -> u32 {
        self.rejected.iter().fold(0, |sum, n| sum.saturating_add(*n))
    }
}
