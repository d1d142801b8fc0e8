//! Noise of wheel odometry, from the speeds of the last half second.

use crate::estimation::ekf::WheelOdometry;
use crate::estimation::history::Event;
use crate::kinematics::WheelPair;
use crate::scalar::Float;
use crate::time::Stamp;

use super::DelayedEkf;

/// Averaging window of the speed in the odometry noise \[s]: long compared with a period, short compared with the
/// acceleration time of a robot.
const ODOMETRY_NOISE_WINDOW: f64 = 0.5;

impl<S: Float, const N: usize> DelayedEkf<S, N> {
    /// Odometry for the wheel travel `travel` \[m] since the last call, up to the time `stamp`.
    ///
    /// # Departure
    /// [Tran2012] Eq. (15) takes the variance from the measured speed, δω². A wheel speed that is measured too high is then
    /// less certain than one measured too low. A heading update couples the two errors and moves the robot by their
    /// product, whose mean is not 0: with 20 % wheel noise by a thirtieth of the travel. Here the square is the mean over
    /// the last half second, of which this interval is a small part.
    /// Tested by `odometry::noisy_odometry_with_heading_updates_is_unbiased`.
    pub fn wheel_odometry(&self, stamp: Stamp, travel: WheelPair<S>) -> WheelOdometry<S> {
        let own = stamp.since(self.stamp());
        if own.is_nan() || own <= 0.0 {
            return self.ekf.wheel_odometry(travel);
        }
        let recent = || {
            core::iter::once((own, travel)).chain(self.odometry_since(stamp.after(-ODOMETRY_NOISE_WINDOW)))
        };
        let (count, whole) = recent().fold((0.0, 0.0), |(count, whole), (dt, _)| (count + 1.0, whole + dt));
        // Jittering stamps may give an interval of nearly zero duration and an implausible speed. Intervals that a late
        // measurement split are validly short.
        let time = |dt: f64| S::from_f64(dt.max(0.25 * whole / count));
        let (mut all, mut sum) = (S::from_f64(0.0), WheelPair::zero());
        for (dt, travel) in recent() {
            let (dt, speeds) = (time(dt), travel.scaled(S::from_f64(1.0) / time(dt)));
            all = all + dt;
            sum = WheelPair::new(
                sum.right + speeds.right.squared() * dt,
                sum.left + speeds.left.squared() * dt,
            );
        }
        WheelOdometry { travel, variance: sum.scaled(time(own).squared() / all * self.ekf.delta) }
    }

    /// Odometry intervals that ended after `since`, newest first: duration \[s] and wheel travel \[m].
    fn odometry_since(&self, since: Stamp) -> impl Iterator<Item = (f64, WheelPair<S>)> + '_ {
        let stamp = |count: usize| self.history.after(count).0;
        let newest_first = (0..self.history.len()).rev().take_while(move |index| stamp(index + 1) > since);
        newest_first.filter_map(move |index| match self.history.get(index)?.event {
            Event::Odometry(odometry) => Some((stamp(index + 1).since(stamp(index)), odometry.wheels.travel)),
            Event::Measurement(_) => None,
        })
    }
}
