//! How a scan agrees with the map, counted.

use crate::scalar::Float;

/// How a scan agrees with the map at a pose.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BeamStats<S> {
    /// How many beams came back.
    pub beams: u16,
    /// How many of them end at the first wall in their way.
    pub hits: u16,
    /// How many end before it: things on no map do that.
    pub short: u16,
    /// How many end beyond it: nothing does that, except at the edge of a wall.
    pub behind_wall: u16,
    /// How many did not come back, though a wall should have sent them: 0 unless asked for, see [`super::MissedReturns`].
    pub missed_returns: u16,
    /// −2 log of the likelihood of them all, up to a constant: about 1 for an explained beam, at most 17.
    pub neg2_log_likelihood: S,
}

impl<S: Float> BeamStats<S> {
    /// The part of the beams that the map explains; 1 for a scan without beams, which contradicts nothing.
    pub fn hit_ratio(&self) -> S {
        if self.beams == 0 { S::from_f64(1.0) } else { self.ratio(self.hits) }
    }

    /// The part of the beams that end beyond the first wall.
    pub fn behind_wall_ratio(&self) -> S {
        self.ratio(self.behind_wall)
    }

    /// Two scans as one.
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
