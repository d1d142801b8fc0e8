//! How a scan agrees with the map, counted.

use crate::scalar::Float;

/// How a scan agrees with the map at a pose.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Agreement<S> {
    /// How many beams came back.
    pub beams: u16,
    /// How many of them end at the first wall in their way.
    pub explained: u16,
    /// How many end before it: things on no map do that.
    pub before: u16,
    /// How many end beyond it: nothing does that, except at the edge of a wall.
    pub beyond: u16,
    /// How many did not come back, though a wall should have sent them: 0 unless asked for, see [`super::Silence`].
    pub missing: u16,
    /// −2 log of the likelihood of them all, up to a constant: about 1 for an explained beam, at most 17.
    pub misfit: S,
}

impl<S: Float> Agreement<S> {
    /// The part of the beams that the map explains; 1 for a scan without beams, which contradicts nothing.
    pub fn explained_share(&self) -> S {
        if self.beams == 0 { S::of(1.0) } else { self.share(self.explained) }
    }

    /// The part of the beams that end beyond the first wall.
    pub fn beyond_share(&self) -> S {
        self.share(self.beyond)
    }

    /// Two scans as one.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Self {
            beams: self.beams.saturating_add(other.beams),
            explained: self.explained.saturating_add(other.explained),
            before: self.before.saturating_add(other.before),
            beyond: self.beyond.saturating_add(other.beyond),
            missing: self.missing.saturating_add(other.missing),
            misfit: self.misfit + other.misfit,
        }
    }

    fn share(&self, count: u16) -> S {
        S::of(f64::from(count)).over_positive(S::of(f64::from(self.beams)))
    }
}
