//! The first half of a tick: from what is sensed to where the robot is.

use crate::estimate::{Belief, Estimator, Refusal, Stamp, Stamped, Travel};
use crate::laser::{Eye, Scan, Wall};
use crate::scalar::Float;

use super::{Sensed, Sight, Signal, Witness};

/// The filter with its history, and the eye that reads scans for it.
///
/// A robot without a laser has a [blind](Eye::blind) eye.
#[derive(Clone, Debug)]
pub struct Localiser<S, const N: usize, const BEAMS: usize> {
    /// The filter.
    pub estimator: Estimator<S, N>,
    /// What reads scans.
    pub eye: Eye<S, BEAMS>,
}

impl<S: Float, const N: usize, const BEAMS: usize> Localiser<S, N, BEAMS> {
    /// Where am I? Odometry predicts; each measurement and each wall seen, gated, corrects.
    ///
    /// `told` is how far the rims were told to roll since the last tick, in case the encoders say nothing usable: a
    /// [guess](Travel::guessed), unless somebody knows better.
    ///
    /// The work is bounded: one filter step for odometry, and for each measurement and each wall at most `N` + 2; for
    /// each scan, one extraction and one matching.
    pub fn sense(
        &mut self,
        sensed: &Sensed<'_, S>,
        told: Travel<S>,
        walls: &[Wall<S>],
        witness: &mut impl Witness<S, N>,
    ) -> Belief<S> {
        self.roll(sensed.stamp, sensed.travel, told, witness);
        for signal in sensed.signals {
            self.hear(signal, walls, witness);
        }
        self.estimator.belief()
    }

    /// Corrects by what a sensor says, where it does not come together with odometry.
    pub fn hear(
        &mut self,
        signal: &Stamped<Signal<'_, S>>,
        walls: &[Wall<S>],
        witness: &mut impl Witness<S, N>,
    ) {
        match &signal.value {
            Signal::Measurement(measurement) => {
                let measured = Stamped::new(signal.stamp, *measurement);
                witness.measured(&measured, self.estimator.measure(measured));
            }
            Signal::Scan(scan) => self.look(signal.stamp, scan, walls, witness),
        }
    }

    /// Predicts by odometry; where that is refused, by what the wheels were told.
    fn roll(&mut self, stamp: Stamp, travel: Travel<S>, told: Travel<S>, witness: &mut impl Witness<S, N>) {
        let outcome = self.estimator.roll_by(stamp, travel);
        if outcome.is_err() {
            let _counted = self.estimator.roll_by(stamp, told);
        }
        let travel = if outcome.is_ok() { travel } else { told };
        witness.rolled(stamp, told.rims, travel, outcome);
    }

    /// Finds the walls of a scan on the map, from where the robot is believed to have been when it was taken, and
    /// corrects by them.
    fn look(
        &mut self,
        stamp: Stamp,
        scan: &Scan<'_, S>,
        walls: &[Wall<S>],
        witness: &mut impl Witness<S, N>,
    ) {
        let Self { estimator, eye } = self;
        // A scan from before the history cannot be matched. That is counted, as is one that cannot be read.
        let Ok(belief) = estimator.recall(stamp) else { return };
        let laser = eye.laser;
        let Ok(seen) = eye.see(estimator.ekf(), &belief, scan, walls) else {
            return estimator.refuse(Refusal::UnreadableScan);
        };
        for measurement in seen.measurements() {
            let measured = Stamped::new(stamp, measurement);
            witness.measured(&measured, estimator.measure(measured));
        }
        witness.looked(estimator, &Sight { stamp, laser: &laser, scan, seen: &seen, walls });
    }
}
