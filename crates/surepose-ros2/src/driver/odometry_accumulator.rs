//! Converts odometry poses to the travel of the wheels per control period.

use surepose::control::Controller;
use surepose::geometry::{Body, Frame, Pose};
use surepose::kinematics::{Motion, Twist, WheelPair};
use surepose::time::{Stamp, Stamped};

use crate::convert::MessageError;

/// Odometry frame of REP 105: arbitrary origin, with drift.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Odom;

impl Frame for Odom {}

/// Smallest step back of the stamps that means a clock that was set back \[s].
const CLOCK_SET_BACK: f64 = 1.0;

/// A period ends if less than this fraction of the odometry period remains of it.
const NEAREST: f64 = 0.5;

/// Shortest gap in odometry \[s], also in periods.
const GAP: f64 = 0.25;
const MAX_PERIODS: f64 = 2.5;

/// Maximum ratio of a wheel's mean speed over a gap to the speed limit; faster odometry jumped.
const MAX_SPEED_RATIO: f64 = 2.0;

/// Odometry since the last step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OdometryAccumulator {
    last: Stamped<Pose<Odom, Body, f64>>,
    ticked: Stamp,
    /// Travel of the wheels since then \[m]; NaN after an odometry jump.
    rims: WheelPair<f64>,
}

impl OdometryAccumulator {
    /// Starts at the first odometry.
    pub(crate) fn new(at: Stamped<Pose<Odom, Body, f64>>) -> Self {
        Self { last: at, ticked: at.stamp, rims: WheelPair::zero() }
    }

    /// Last odometry pose.
    pub(crate) fn pose(&self) -> Pose<Odom, Body, f64> {
        self.last.value
    }

    /// Stamp of the last odometry.
    pub(crate) fn stamp(&self) -> Stamp {
        self.last.stamp
    }

    /// Whether `stamp` means that the clock was set back.
    pub(crate) fn is_set_back(&self, stamp: Stamp) -> bool {
        stamp.since(self.last.stamp) < -CLOCK_SET_BACK
    }

    /// Motions over a gap in odometry that ends at `at`, and their times; `None` if there is no gap, or for a jump that no wheel
    /// could make. The first one includes the travel since the last period.
    ///
    /// A gap is longer than [`GAP`] and several periods: one arc would lose part of the way.
    pub(crate) fn take_gap(
        &mut self,
        controller: &Controller<f64>,
        at: Stamped<Pose<Odom, Body, f64>>,
    ) -> Option<[(Stamp, WheelPair<f64>); 3]> {
        let dt = at.stamp.since(self.last.stamp);
        if dt < GAP.max(MAX_PERIODS * controller.period) {
            return None;
        }
        let drive = controller.drive;
        let mut travels = Motion::turn_drive_turn(self.last.value, at.value)
            .map(|motion| drive.wheel_speeds_from_twist(Twist::new(motion.length, motion.turn)));
        let is_possible = travels
            .iter()
            .all(|travel| travel.max_abs() <= MAX_SPEED_RATIO * controller.limits.wheel_speed * dt);
        if !is_possible {
            return None;
        }
        let rims = std::mem::replace(&mut self.rims, WheelPair::zero());
        travels[0] = WheelPair::new(travels[0].right + rims.right, travels[0].left + rims.left);
        let start = self.last.stamp;
        (self.last, self.ticked) = (at, at.stamp);
        let stamp = |part: f64| start.after(dt * part / 3.0);
        Some([(stamp(1.0), travels[0]), (stamp(2.0), travels[1]), (at.stamp, travels[2])])
    }

    /// Adds an odometry pose; at the end of a period, returns the travel of the wheels \[m] since the last step.
    ///
    /// The travel is NaN after an odometry jump; the filter rejects and counts it. `None`: the period is not over.
    ///
    /// # Errors
    /// [`MessageError::OutOfOrder`] for a stamp that is not later than the last one.
    pub(crate) fn add(
        &mut self,
        controller: &Controller<f64>,
        at: Stamped<Pose<Odom, Body, f64>>,
    ) -> Result<Option<WheelPair<f64>>, MessageError> {
        let dt = at.stamp.since(self.last.stamp);
        if dt <= 0.0 {
            return Err(MessageError::OutOfOrder);
        }
        let motion = Motion::between(self.last.value, at.value);
        let rims = controller.drive.wheel_speeds_from_twist(Twist::new(motion.length, motion.turn));
        self.rims = WheelPair::new(self.rims.right + rims.right, self.rims.left + rims.left);
        self.last = at;
        if at.stamp.since(self.ticked) < controller.period - NEAREST * dt {
            return Ok(None);
        }
        self.ticked = at.stamp;
        Ok(Some(std::mem::replace(&mut self.rims, WheelPair::zero())))
    }
}
