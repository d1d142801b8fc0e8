//! From odometry's poses to how far the rims rolled in a period.

use surepose::control::Controller;
use surepose::geometry::{Body, Frame, Pose};
use surepose::kinematics::{Motion, Twist, WheelPair};
use surepose::time::{Stamp, Stamped};

use crate::convert::MessageError;

/// The frame in which odometry counts: it starts anywhere, and drifts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Odom;

impl Frame for Odom {}

/// A stamp that is earlier than the last one by so much \[s] is of a clock that was set back.
const CLOCK_SET_BACK: f64 = 1.0;

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
        self.rims = WheelPair::new(self.rims.right + rims.right, self.rims.left + rims.left);
        self.last = at;
        if at.stamp.since(self.ticked) < controller.period - NEAREST * dt {
            return Ok(None);
        }
        self.ticked = at.stamp;
        Ok(Some(std::mem::replace(&mut self.rims, WheelPair::zero())))
    }
}
