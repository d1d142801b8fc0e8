//! Who stands beside the loop and hears of everything.

use crate::drive::Wheels;
use crate::estimate::{Estimator, Measurement, Outcome, Refusal, Stamp, Stamped, Travel};
use crate::laser::{RangeFinder, Scan, Seen, Wall};
use crate::scalar::Float;

/// Hears, during a tick, of all that comes in and of what became of it: a supervisor, a recorder, or nobody, `()`.
pub trait Witness<S: Float, const N: usize> {
    /// Odometry until `stamp`: how far the rims were told to roll \[m], how far they are taken to have rolled, and
    /// what became of what the encoders said. Where that was refused, `travel` is what they were told.
    fn rolled(&mut self, stamp: Stamp, told: Wheels<S>, travel: Travel<S>, outcome: Result<(), Refusal>);

    /// A measurement, from a sensor or of a wall in a scan, and what became of it.
    fn measured(&mut self, measured: &Stamped<Measurement<S>>, outcome: Outcome);

    /// A scan, after what was seen in it corrected the estimate.
    ///
    /// The estimator is here for who can do better than to correct it: who finds a lost robot starts it anew.
    fn looked(&mut self, estimator: &mut Estimator<S, N>, sight: &Sight<'_, S>);
}

/// A scan, and what was made of it.
#[derive(Clone, Copy, Debug)]
pub struct Sight<'a, S> {
    /// When it was taken.
    pub stamp: Stamp,
    /// By what.
    pub laser: &'a RangeFinder<S>,
    /// The scan.
    pub scan: &'a Scan<'a, S>,
    /// What was seen in it.
    pub seen: &'a Seen<'a, S>,
    /// The walls of the map.
    pub walls: &'a [Wall<S>],
}

impl<S: Float, const N: usize> Witness<S, N> for () {
    fn rolled(&mut self, _: Stamp, _: Wheels<S>, _: Travel<S>, _: Result<(), Refusal>) {}
    fn measured(&mut self, _: &Stamped<Measurement<S>>, _: Outcome) {}
    fn looked(&mut self, _: &mut Estimator<S, N>, _: &Sight<'_, S>) {}
}
