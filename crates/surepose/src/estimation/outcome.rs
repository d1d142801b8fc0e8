//! What became of a measurement: accepted, or rejected for a reason that has a name and a count.

/// The fate of one measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MeasurementOutcome {
    /// It corrected the belief; its normalized innovation squared.
    Accepted {
        /// νᵀ S⁻¹ ν, χ² distributed for a consistent filter.
        nis: f64,
    },
    /// It changed nothing.
    Rejected(RejectReason),
}

/// The fate of the odometry of one step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OdometryOutcome {
    /// It predicted the belief.
    Used,
    /// It was rejected, and the command predicted the belief.
    Rejected(RejectReason),
    /// There was none, and the command predicted the belief.
    Missing,
}

/// Why a measurement was rejected.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum RejectReason {
    /// A value is NaN or infinite, or a range or travel is impossibly large.
    NotFinite,
    /// A variance is not positive, or one that no sensor has, or a covariance is not positive definite.
    BadVariance,
    /// Its stamp is older than the history reaches.
    Stale,
    /// Its stamp is later than the odometry reaches.
    Future,
    /// Its innovation lies outside the χ² gate.
    Outlier,
    /// A scan whose bearings are none, of a laser that is none, or with more beams than there is room for.
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

/// How many measurements were accepted; and how many of them, of the scans and of the stretches of odometry were rejected, for
/// each reason.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MeasurementStats {
    /// Measurements that corrected the belief.
    pub accepted: u32,
    /// Stretches of odometry that ended before the newest belief: the clock was set back.
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

    /// How many were rejected for `reason`.
    pub fn rejected(&self, reason: RejectReason) -> u32 {
        self.rejected.get(reason as usize).copied().unwrap_or(0)
    }

    /// How many were rejected in all.
    pub fn rejected_total(&self) -> u32 {
        self.rejected.iter().fold(0, |sum, n| sum.saturating_add(*n))
    }
}
