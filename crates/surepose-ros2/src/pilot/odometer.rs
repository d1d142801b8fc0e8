//! From odometry's poses to how far the rims rolled in a period.

use surepose::closed_loop::Controller;
use surepose::{Body, Frame, Pose, Stamp, Stamped, Twist, Wheels};
use surepose_lab::replay::motion_between;

use crate::convert::Refused;

/// The frame in which odometry counts: it starts anywhere, and drifts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Odom;

impl Frame for Odom {}

/// A stamp that is earlier than the last one by so much \[s] is of a clock that was set back.
const SET_BACK: f64 = 1.0;

/// Rims that roll so many times faster than they can have not rolled: odometry was reset, or is broken.
const IMPOSSIBLE: f64 = 5.0;

/// A period is over if less than this part of the time between two odometries is left of it.
const NEAREST: f64 = 0.5;

/// What odometry said since the last tick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Odometer {
    last: Stamped<Pose<Odom, Body, f64>>,
    ticked: Stamp,
    /// So far the rims rolled since then \[m]; NaN where that cannot be said.
    rims: Wheels<f64>,
}

impl Odometer {
    /// The first odometry.
    pub(crate) fn starting(at: Stamped<Pose<Odom, Body, f64>>) -> Self {
        Self { last: at, ticked: at.stamp, rims: Wheels::rest() }
    }

    /// When odometry last came.
    pub(crate) fn stamp(&self) -> Stamp {
        self.last.stamp
    }

    /// Whether a stamp says that the clock was set back.
    pub(crate) fn is_set_back(&self, stamp: Stamp) -> bool {
        stamp.since(self.last.stamp) < -SET_BACK
    }

    /// Takes in odometry, and gives the way of the rims \[m] since the last tick if it is time for one. It is NaN, which the
    /// filter refuses and counts, where odometry jumped.
    ///
    /// # Errors
    /// [`Refused::OutOfOrder`].
    pub(crate) fn roll(
        &mut self,
        controller: &Controller<f64>,
        at: Stamped<Pose<Odom, Body, f64>>,
    ) -> Result<Option<Wheels<f64>>, Refused> {
        let dt = at.stamp.since(self.last.stamp);
        if dt <= 0.0 {
            return Err(Refused::OutOfOrder);
        }
        let motion = motion_between(self.last.value, at.value);
        let rims = controller.drive.rims_from_twist(Twist::new(motion.length, motion.turn));
        let possible =
            rims.largest() <= IMPOSSIBLE * controller.limits.wheel_speed * dt.max(controller.period);
        let (right, left) = if possible { (rims.right, rims.left) } else { (f64::NAN, f64::NAN) };
        self.rims = Wheels::new(self.rims.right + right, self.rims.left + left);
        self.last = at;
        if at.stamp.since(self.ticked) < controller.period - NEAREST * dt {
            return Ok(None);
        }
        self.ticked = at.stamp;
        Ok(Some(std::mem::replace(&mut self.rims, Wheels::rest())))
    }
}
