//! The gains of both laws, and the defaults that fit a period and a robot.

use crate::kinematics::DiffDrive;
use crate::scalar::Scalar;

use super::braking::ACCELERATION_FRACTION;
use super::limits::Limits;

/// The gains of both laws of [Tran2012].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gains<S> {
    /// k_v \[1/s]: of the distance, Eq. (23) and (28).
    pub k_v: S,
    /// k_α \[1/s]: of the bearing, Eq. (23).
    pub k_alpha: S,
    /// h: weight of the direction of approach, Eq. (19).
    pub h: S,
    /// k_θ \[1/s]: of the heading error, Eq. (28).
    pub k_theta: S,
}

/// Parts of an error that are taken away in one period: below 1 where the sampled loop must not overshoot, and 1 for the
/// first step of a recursive mean.
const K_V_PER_PERIOD: f64 = 0.2;
const K_ALPHA_PER_PERIOD: f64 = 0.24;
const K_THETA_PER_PERIOD: f64 = 1.0;
const SMALL_ERROR_ALPHA_PER_PERIOD: f64 = 0.096;
const SMALL_ERROR_THETA_PER_PERIOD: f64 = 0.12;
/// The largest k_v \[1/s]: a third of a second for the last of the way is short enough, and the rest would follow noise.
const MAX_K_V: f64 = 9.0;
/// How far the rims have to go where braking evenly turns into settling exponentially \[m].
const SETTLING_DISTANCE: f64 = 0.09;
/// Weight of the direction of approach: the robot drives nearly straight and turns at the goal, as the time-optimal
/// paths of [BalkcomMason2002] do.
const H: f64 = 0.3;

impl<S: Scalar> Gains<S> {
    /// The paper's gains, Sec. 5.1. They are for continuous time: at the paper's period of 0.1 s k_α·ΔT is 10.
    ///
    /// h and k_θ are not printed; with h = 1 α and φ weigh the same.
    pub fn tran2012() -> Self {
        Self {
            k_v: S::from_f64(10.0),
            k_alpha: S::from_f64(100.0),
            h: S::from_f64(1.0),
            k_theta: S::from_f64(10.0),
        }
    }

    /// Gains for a loop of `period` \[s] whose wheels obey `limits`.
    ///
    /// A gain takes a fixed part of its error away in each period: 0.2 of the distance, 0.24 of the bearing, all of the
    /// heading error at the first tick of trimming. k_v is 9/s at the most. And a gain is no larger than that the wheels brake
    /// evenly, see [`BrakingProfile`](super::BrakingProfile), until the rims have 9 cm to go: √(2a/9 cm); twice that for the bearing, which the robot may
    /// overshoot on its way.
    pub fn for_loop(period: S, limits: &Limits<S>) -> Self {
        let even =
            (limits.wheel_acceleration * S::from_f64(2.0 * ACCELERATION_FRACTION / SETTLING_DISTANCE)).sqrt();
        let gain = |part: f64, most: S| (S::from_f64(part) / period).min(most);
        Self {
            k_v: gain(K_V_PER_PERIOD, even.min(S::from_f64(MAX_K_V))),
            k_alpha: gain(K_ALPHA_PER_PERIOD, even * S::from_f64(2.0)),
            h: S::from_f64(H),
            k_theta: gain(K_THETA_PER_PERIOD, even),
        }
    }
}

impl Gains<f64> {
    /// The same gains, rounded to another format.
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

/// What the law knows of the robot it steers: how fast it can be, and how often it is told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActuatorLimits<S> {
    /// Largest speed \[m/s].
    pub speed: S,
    /// Largest turn rate \[rad/s].
    pub turn_rate: S,
    /// Largest k_α at a small bearing \[1/s]: noise of the estimate is averaged over several periods.
    pub small_error_gain_alpha: S,
    /// Largest k_θ at a small heading error \[1/s].
    pub small_error_gain_theta: S,
}

impl<S: Scalar> ActuatorLimits<S> {
    /// The robot of `drive` and `limits`, told every `period` \[s].
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
    /// The same robot, rounded to another format.
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
