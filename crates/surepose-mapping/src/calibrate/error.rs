//! Why a recording yields no calibration.

use super::frontal::Singular;

/// The fewest line observations of walls that are worth a try.
pub(super) const MIN_RECORDS: usize = 50;

/// Why there is no calibration.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CalibrationError {
    /// A number in the options is not finite, or a standard deviation or radius not positive.
    #[error(
        "the options hold a number that is not finite, or a radius, track, tick count or noise that is not positive"
    )]
    BadOptions,
    /// The wheels' counters have no two records of different times.
    #[error("the wheel counters have no two records of different times; are the stamps right?")]
    NoTicks,
    /// Too few walls were seen.
    #[error(
        "walls were seen {found} times, and it takes {MIN_RECORDS}: calibration needs a laser among walls"
    )]
    FewWalls {
        /// How often.
        found: usize,
    },
    /// Something is not determined at all.
    #[error("the measurements determine no solution")]
    Singular,
    /// The fit left what a robot can be.
    #[error("the fit diverged: begin nearer to the truth")]
    Diverged,
    /// Somebody ended it before it was done.
    #[error("ended before it was done")]
    Stopped,
    /// The fit did not settle.
    #[error("the fit did not settle: walls and odometry contradict each other")]
    Unsettled,
}

impl From<Singular> for CalibrationError {
    fn from(_: Singular) -> Self {
        Self::Singular
    }
}
