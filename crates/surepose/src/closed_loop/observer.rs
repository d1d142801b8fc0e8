//! Who stands beside the loop and hears of everything.

use crate::estimate::{
    DelayedEkf, Measurement, MeasurementOutcome, RejectReason, Stamp, Stamped, WheelOdometry,
};
use crate::kinematics::WheelPair;
use crate::laser::{RangeFinder, Scan, ScanObservation, Wall};
use crate::scalar::Float;

/// Hears, during a tick, of all that comes in and of what became of it: a supervisor, a recorder, or nobody, `()`.
pub trait LoopObserver<S: Float, const N: usize> {
    /// Odometry until `stamp`: how far the rims were told to roll \[m], how far they are taken to have rolled, and
    /// what became of what the encoders said. Where that was refused, `travel` is what they were told.
    fn on_odometry(
        &mut self,
        stamp: Stamp,
        commanded: WheelPair<S>,
        travel: WheelOdometry<S>,
        outcome: Result<(), RejectReason>,
    );

    /// A measurement, from a sensor or of a wall in a scan, and what became of it.
    fn on_measurement(&mut self, measurement: &Stamped<Measurement<S>>, outcome: MeasurementOutcome);

    /// A scan, after what was seen in it corrected the estimate.
    ///
    /// The estimator is here for who can do better than to correct it: who finds a lost robot starts it anew.
    fn on_scan(&mut self, estimator: &mut DelayedEkf<S, N>, event: &ScanEvent<'_, S>);
}

/// A scan, and what was made of it.
#[derive(Clone, Copy, Debug)]
pub struct ScanEvent<'a, S> {
    /// When it was taken.
    pub stamp: Stamp,
    /// By what.
    pub laser: &'a RangeFinder<S>,
    /// The scan.
    pub scan: &'a Scan<'a, S>,
    /// What was seen in it.
    pub observation: &'a ScanObservation<'a, S>,
    /// The walls of the map.
    pub walls: &'a [Wall<S>],
}

impl<S: Float, const N: usize> LoopObserver<S, N> for () {
    fn on_odometry(&mut self, _: Stamp, _: WheelPair<S>, _: WheelOdometry<S>, _: Result<(), RejectReason>) {}
    fn on_measurement(&mut self, _: &Stamped<Measurement<S>>, _: MeasurementOutcome) {}
    fn on_scan(&mut self, _: &mut DelayedEkf<S, N>, _: &ScanEvent<'_, S>) {}
}
