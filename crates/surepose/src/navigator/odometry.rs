//! Odometry of a step: checked for plausibility, and replaced by the commands where it is missing.

use crate::estimation::WheelOdometry;
use crate::kinematics::WheelPair;
use crate::localization::{Odometry, SensorInput};
use crate::scalar::Float;

use super::Navigator;

/// Maximum ratio of reported wheel speed to the wheel speed limit; faster odometry is faulty or was reset.
const MAX_SPEED_RATIO: f64 = 5.0;

impl<S: Float, const HISTORY: usize, const BEAMS: usize, const HYPOTHESES: usize, const KEYFRAMES: usize>
    Navigator<S, HISTORY, BEAMS, HYPOTHESES, KEYFRAMES>
{
    /// The odometry of this step, or NaN, which the filter rejects and counts, where no wheel can have turned so fast.
    pub(super) fn plausible(&self, odometry: Odometry<S>, elapsed: S) -> Odometry<S> {
        let Odometry::WheelTravel(travel) = odometry else { return odometry };
        let controller = &self.config.controller;
        let fastest = controller.limits.wheel_speed * S::from_f64(MAX_SPEED_RATIO);
        let is_plausible = travel.max_abs() <= fastest * elapsed.max(controller.period);
        let nan = S::from_f64(f64::NAN);
        if is_plausible { odometry } else { Odometry::WheelTravel(WheelPair::new(nan, nan)) }
    }

    /// Odometry by the commands, in case it is missing or rejected. Wheels that belong to another controller may have done what
    /// odometry reports, or anything within their limits.
    pub(super) fn commanded_odometry(&self, input: &SensorInput<'_, S>, elapsed: S) -> WheelOdometry<S> {
        let controller = &self.config.controller;
        if self.goal.is_some() || self.rest_until.is_some() {
            let speeds = self.commands.expected_rims(&self.config);
            return WheelOdometry::from_command(speeds.scaled(elapsed));
        }
        match input.odometry {
            Odometry::WheelTravel(travel) if (travel.right + travel.left).is_finite() => {
                self.localizer.estimator().wheel_odometry(input.stamp, travel)
            }
            Odometry::WithVariance(odometry)
                if (odometry.travel.right + odometry.travel.left).is_finite() =>
            {
                odometry
            }
            _ => {
                let most = (controller.limits.wheel_speed * elapsed).squared();
                WheelOdometry { travel: WheelPair::zero(), variance: WheelPair::new(most, most) }
            }
        }
    }
}
