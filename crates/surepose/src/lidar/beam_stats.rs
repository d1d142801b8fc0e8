//! Counts of how a scan agrees with the map.

use crate::scalar::Float;

/// Agreement of a scan with the map at a pose.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BeamStats<S> {
    /// Number of beams with a return.
    pub beams: u16,
    /// Number of beams that end at the first wall on their ray.
    pub hits: u16,
    /// Number of beams that end before the first wall, at objects that are not on the map.
    pub short: u16,
    /// Number of beams that end behind the first wall. This is possible only at the edge of a wall.
    pub behind_wall: u16,
    /// Number of beams without a return that a wall should have returned, see [`super::MissedReturns`]; 0 if not
    /// evaluated.
    pub missed_returns: u16,
    /// −2 log likelihood of all beams up to a constant: about 1 for an explained beam, at most 17 for any.
    pub neg2_log_likelihood: S,
}

impl<S: Float> BeamStats<S> {
    /// Fraction of the beams that the map explains, 0 to 1; 1 for a scan without beams.
    pub fn hit_ratio(&self) -> S {
        if self.beams == 0 { S::from_f64(1.0) } else { self.ratio(self.hits) }
    }

    /// Fraction of the beams that end behind the first wall, 0 to 1.
    pub fn behind_wall_ratio(&self) -> S {
        self.ratio(self.behind_wall)
    }

    /// Sums the counts of two scans.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Self {
            beams: self.beams.saturating_add(other.beams),
            hits: self.hits.saturating_add(other.hits),
            short: self.short.saturating_add(other.short),
            behind_wall: self.behind_wall.saturating_add(other.behind_wall),
            missed_returns: self.missed_returns.saturating_add(other.missed_returns),
            neg2_log_likelihood: self.neg2_log_likelihood + other.neg2_log_likelihood,
        }
    }

    fn ratio(&self, count: u16) -> S {
        S::from_f64(f64::from(count)).div_or_zero(S::from_f64(f64::from(self.beams)))
    }
}
