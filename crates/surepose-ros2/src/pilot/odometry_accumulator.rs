//! From odometry's poses to how far the rims rolled in a period.

use surepose::closed_loop::Controller;
use surepose::{Body, Frame, Motion, Pose, Stamp, Stamped, Twist, WheelPair};

use crate::convert::MessageError;

/// The frame in which odometry counts: it starts anywhere, and drifts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Odom;

impl Frame for Odom {}

/// A stamp that is earlier than the last one by so much \[s] is of a clock that was set back.
const CLOCK_SET_BACK: f64 = 1.0;

/// Rims that roll so many times faster than they can have not rolled: odometry was reset, or is broken.
const MAX_SPEED_FACTOR: f64 = 5.0;

/// A period is over if less than this part of the time between two odometries is left of it.
const NEAREST: f64 = 0.5;

/// What odometry said since the last tick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OdometryAccumulator {
    last: Stamped<Pose<Odom, Body, f64>>,
    ticked: Stamp,
    /// So far the rims rolled since then \[m]; NaN where that cannot be said.
    rims: WheelPair<f64>,
}

impl OdometryAccumulator {
    /// The first odometry.
    pub(crate) fn new(at: Stamped<Pose<Odom, Body, f64>>) -> Self {
        Self { last: at, ticked: at.stamp, rims: WheelPair::zero() }
    }

    /// When odometry last came.
    pub(crate) fn stamp(&self) -> Stamp {
        self.last.stamp
    }

    /// Whether a stamp says that the clock was set back.
    pub(crate) fn is_set_back(&self, stamp: Stamp) -> bool {
        stamp.since(self.last.stamp) < -CLOCK_SET_BACK
    }

    /// Takes in odometry, and gives the way of the rims \[m] since the last tick if it is time for one. It is NaN, which the
    /// filter refuses and counts, where odometry jumped.
    ///
    /// # Errors
    /// [`MessageError::OutOfOrder`].
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
        let possible =
            rims.max_abs() <= MAX_SPEED_FACTOR * controller.limits.wheel_speed * dt.max(controller.period);
        let (right, left) = if possible { (rims.right, rims.left) } else { (f64::NAN, f64::NAN) };
        self.rims = WheelPair::new(self.rims.right + right, self.rims.left + left);
        self.last = at;
        if at.stamp.since(self.ticked) < controller.period - NEAREST * dt {
            return Ok(None);
        }
        self.ticked = at.stamp;
        Ok(Some(std::mem::replace(&mut self.rims, WheelPair::zero())))
    }
}
