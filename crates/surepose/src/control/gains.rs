//! Gains of both laws, and their defaults for a control period and a robot.

use crate::kinematics::DiffDrive;
use crate::scalar::Scalar;

use super::limits::Limits;
use super::tuning::{
    ACCELERATION_FRACTION, APPROACH_WEIGHT, K_ALPHA_PER_PERIOD, K_THETA_PER_PERIOD, K_V_PER_PERIOD, MAX_K_V,
    SETTLING_DISTANCE, SMALL_ERROR_ALPHA_PER_PERIOD, SMALL_ERROR_THETA_PER_PERIOD,
};

/// Gains of both laws of [Tran2012].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gains<S> {
    /// k_v \[1/s]: gain of the distance, Eq. (23) and (28).
    pub k_v: S,
    /// k_α \[1/s]: gain of the bearing, Eq. (23).
    pub k_alpha: S,
    /// h \[1]: weight of the direction of approach, Eq. (19).
    pub h: S,
    /// k_θ \[1/s]: gain of the heading error, Eq. (28).
    pub k_theta: S,
}

impl<S: Scalar> Gains<S> {
    /// Returns the paper's gains, Sec. 5.1.
    ///
    /// They suit continuous time: at the paper's period of 0.1 s, k_α·ΔT is 10. The paper does not print h and k_θ.
    /// With h = 1, α and φ have equal weights.
    pub fn tran2012() -> Self {
        Self {
            k_v: S::from_f64(10.0),
            k_alpha: S::from_f64(100.0),
            h: S::from_f64(1.0),
            k_theta: S::from_f64(10.0),
        }
    }

    /// Computes the gains for a loop of `period` \[s] and wheels with `limits`.
    ///
    /// Each gain removes a fixed fraction of its error in each period: 0.2 of the distance, 0.24 of the bearing. The first
    /// tick of trimming removes the whole heading error. k_v is at most 9/s.
    ///
    /// Each gain is also at most √(2a/9 cm), and that of the bearing at most twice this value. So the wheels decelerate
    /// at a constant rate until 9 cm of wheel travel remain, see `BrakingProfile`. The bearing may overshoot on the way.
    pub fn for_loop(period: S, limits: &Limits<S>) -> Self {
        let weaker = limits.wheel_acceleration.min(limits.wheel_deceleration);
        let even = (weaker * S::from_f64(2.0 * ACCELERATION_FRACTION / SETTLING_DISTANCE)).sqrt();
        let gain = |part: f64, most: S| (S::from_f64(part) / period).min(most);
        Self {
            k_v: gain(K_V_PER_PERIOD, even.min(S::from_f64(MAX_K_V))),
            k_alpha: gain(K_ALPHA_PER_PERIOD, even * S::from_f64(2.0)),
            h: S::from_f64(APPROACH_WEIGHT),
            k_theta: gain(K_THETA_PER_PERIOD, even),
        }
    }
}

impl Gains<f64> {
    /// Converts the gains to the scalar type `T`, rounded.
    #[inline(always)]
    pub fn cast<T: Scalar>(&self) -> Gains<T> {
        Gains {
            k_v: T::from_f64(self.k_v),
            k_alpha: T::from_f64(self.k_alpha),
            h: T::from_f64(self.h),
            k_theta: T::from_f64(self.k_theta),
        }
    }
}

/// Speed limits of the robot and gain limits that follow from the control period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActuatorLimits<S> {
    /// Maximum speed \[m/s].
    pub speed: S,
    /// Maximum turn rate \[rad/s].
    pub turn_rate: S,
    /// Maximum k_α at a small bearing \[1/s]; averages estimate noise over several periods.
    pub small_error_gain_alpha: S,
    /// Maximum k_θ at a small heading error \[1/s].
    pub small_error_gain_theta: S,
}

impl<S: Scalar> ActuatorLimits<S> {
    /// Derives the limits from `drive`, `limits` and the control `period` \[s].
    pub fn from_limits(drive: &DiffDrive<S>, limits: &Limits<S>, period: S) -> Self {
        Self {
            speed: limits.wheel_speed,
            turn_rate: limits.wheel_speed / (drive.wheel_separation * S::from_f64(0.5)),
            small_error_gain_alpha: S::from_f64(SMALL_ERROR_ALPHA_PER_PERIOD) / period,
            small_error_gain_theta: S::from_f64(SMALL_ERROR_THETA_PER_PERIOD) / period,
        }
    }
}

impl ActuatorLimits<f64> {
    /// Converts the limits to the scalar type `T`, rounded.
    #[inline(always)]
    pub fn cast<T: Scalar>(&self) -> ActuatorLimits<T> {
        ActuatorLimits {
            speed: T::from_f64(self.speed),
            turn_rate: T::from_f64(self.turn_rate),
            small_error_gain_alpha: T::from_f64(self.small_error_gain_alpha),
            small_error_gain_theta: T::from_f64(self.small_error_gain_theta),
        }
    }
}
