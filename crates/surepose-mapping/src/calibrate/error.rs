//! Errors of a calibration.

use super::frontal::Singular;

/// Minimum number of line observations for a calibration.
pub(super) const MIN_RECORDS: usize = 50;

/// Reasons for which a calibration fails.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CalibrationError {
    /// A number in the options is not finite, or a standard deviation or radius is not positive.
    #[error(
        "options: every number must be finite, and radii, track, tick count and noise positive; check the configuration"
    )]
    BadOptions,
    /// The wheel counters have no two records at different times.
    #[error("wheel counters: no two records with different stamps; check the stamps")]
    NoTicks,
    /// Too few wall observations.
    #[error(
        "walls: too few observations (got {found}, expected at least {MIN_RECORDS}); record scans near walls"
    )]
    FewWalls {
        /// Number of wall observations.
        found: usize,
    },
    /// The normal matrix is singular.
    #[error("fit: the measurements do not determine a solution; record more motion in sight of walls")]
    Singular,
    /// The fit left the range of plausible geometries.
    #[error("fit: diverged; start with nominal values nearer to the truth")]
    Diverged,
    /// Canceled before completion.
    #[error("calibration: canceled before completion")]
    Stopped,
    /// The fit did not converge.
    #[error(
        "fit: did not converge, walls and odometry contradict each other; check the nominal geometry and the stamps"
    )]
    Unsettled,
}

impl From<Singular> for CalibrationError {
    fn from(_: Singular) -> Self {
        Self::Singular
    }
}
