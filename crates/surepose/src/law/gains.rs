//! The gains of both laws, and the defaults that fit a period and a robot.

use crate::drive::Drive;
use crate::limit::Limits;
use crate::scalar::Scalar;

use super::braking::SHARE;

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
const QUIET_ALPHA_PER_PERIOD: f64 = 0.096;
const QUIET_THETA_PER_PERIOD: f64 = 0.12;
/// The largest k_v \[1/s]: a third of a second for the last of the way is short enough, and the rest would follow noise.
const K_V_MOST: f64 = 9.0;
/// How far the rims have to go where braking evenly turns into settling exponentially \[m].
const SETTLING_WAY: f64 = 0.09;
/// Weight of the direction of approach: the robot drives nearly straight and turns at the goal, as the time-optimal
/// paths of [BalkcomMason2002] do.
const H: f64 = 0.3;

impl<S: Scalar> Gains<S> {
    /// The paper's gains, Sec. 5.1. They are for continuous time: at the paper's period of 0.1 s k_α·ΔT is 10.
    ///
    /// h and k_θ are not printed; with h = 1 α and φ weigh the same.
    pub fn paper() -> Self {
        Self { k_v: S::of(10.0), k_alpha: S::of(100.0), h: S::of(1.0), k_theta: S::of(10.0) }
    }

    /// Gains for a loop of `period` \[s] whose wheels obey `limits`.
    ///
    /// A gain takes a fixed part of its error away in each period: 0.2 of the distance, 0.24 of the bearing, all of the
    /// heading error at the first tick of trimming. k_v is 9/s at the most. And a gain is no larger than that the wheels brake
    /// evenly, see [`Braking`](super::Braking), until the rims have 9 cm to go: √(2a/9 cm); twice that for the bearing, which the robot may
    /// overshoot on its way.
    pub fn for_loop(period: S, limits: &Limits<S>) -> Self {
        let even = (limits.wheel_acceleration * S::of(2.0 * SHARE / SETTLING_WAY)).sqrt();
        let gain = |part: f64, most: S| (S::of(part) / period).min(most);
        Self {
            k_v: gain(K_V_PER_PERIOD, even.min(S::of(K_V_MOST))),
            k_alpha: gain(K_ALPHA_PER_PERIOD, even * S::of(2.0)),
            h: S::of(H),
            k_theta: gain(K_THETA_PER_PERIOD, even),
        }
    }
}

impl Gains<f64> {
    /// The same gains, rounded to another format.
    #[inline(always)]
    pub fn cast<T: Scalar>(&self) -> Gains<T> {
        Gains {
            k_v: T::of(self.k_v),
            k_alpha: T::of(self.k_alpha),
            h: T::of(self.h),
            k_theta: T::of(self.k_theta),
        }
    }
}

/// What the law knows of the robot it steers: how fast it can be, and how often it is told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Actuation<S> {
    /// Largest speed \[m/s].
    pub speed: S,
    /// Largest turn rate \[rad/s].
    pub turn_rate: S,
    /// Largest k_α at a small bearing \[1/s]: noise of the estimate is averaged over several periods.
    pub quiet_alpha: S,
    /// Largest k_θ at a small heading error \[1/s].
    pub quiet_theta: S,
}

impl<S: Scalar> Actuation<S> {
    /// The robot of `drive` and `limits`, told every `period` \[s].
    pub fn of(drive: &Drive<S>, limits: &Limits<S>, period: S) -> Self {
        Self {
            speed: limits.wheel_speed,
            turn_rate: limits.wheel_speed / (drive.track * S::of(0.5)),
            quiet_alpha: S::of(QUIET_ALPHA_PER_PERIOD) / period,
            quiet_theta: S::of(QUIET_THETA_PER_PERIOD) / period,
        }
    }
}

impl Actuation<f64> {
    /// The same robot, rounded to another format.
    #[inline(always)]
    pub fn cast<T: Scalar>(&self) -> Actuation<T> {
        Actuation {
            speed: T::of(self.speed),
            turn_rate: T::of(self.turn_rate),
            quiet_alpha: T::of(self.quiet_alpha),
            quiet_theta: T::of(self.quiet_theta),
        }
    }
}
