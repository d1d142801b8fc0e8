//! The wheels' speed controller: the PID of [Tran2012] Sec. 5.2, with anti-windup.

use crate::kinematics::MAX_WHEEL_RATE;
use crate::scalar::{Mask, Scalar};

/// A PID controller of one wheel's turn rate that says what part of the supply the motor gets.
///
/// `u = k_f·ω* + k_p·e + I − k_d·ω̇` with e = ω* − ω, limited to ±1; `İ = k_i·e + k_t·(u_limited − u)`.
///
/// | symbol | meaning | unit |
/// |---|---|---|
/// | `feed_forward` | k_f, the duty per turn rate at which the unloaded wheel settles | s/rad |
/// | `proportional` | k_p | s/rad |
/// | `integral` | k_i | 1/rad |
/// | `derivative` | k_d, on the measured rate: a step of the desired one does not kick | s²/rad |
/// | `tracking` | k_t, how fast the integral gives way where the duty is at its limit; below 1/period | 1/s |
///
/// The last term of İ is the anti-windup, back-calculation [Astrom2006]: while the motor has all it can get, the
/// integral settles where the duty just reaches its limit, and not beyond.
///
/// # Departure
/// [Tran2012] names the PID and its result (±5 % of the speed), not its form or gains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pid<S> {
    /// k_f \[s/rad].
    pub feed_forward: S,
    /// k_p \[s/rad].
    pub proportional: S,
    /// k_i \[1/rad].
    pub integral: S,
    /// k_d \[s²/rad].
    pub derivative: S,
    /// k_t \[1/s].
    pub tracking: S,
}

/// State of the controller from one step to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PidState<S> {
    /// I, the duty that the integral asks for.
    integral: S,
    /// The turn rate measured last \[rad/s].
    measured: S,
}

impl<S: Scalar> PidState<S> {
    /// At rest.
    pub fn zero() -> Self {
        Self { integral: S::from_f64(0.0), measured: S::from_f64(0.0) }
    }
}

impl<S: Scalar> Pid<S> {
    /// The duty in [−1, 1] for the next `period` \[s] > 0, and the state to pass to the next step.
    ///
    /// A wheel that shall rest and does gets no duty: what the integral still held would make it creep. A rate that
    /// is not a number, measured or desired, is no news: the integral and the feed-forward carry on without it.
    #[inline]
    pub fn step(&self, state: PidState<S>, desired: S, measured: S, period: S) -> (S, PidState<S>) {
        let (zero, one) = (S::from_f64(0.0), S::from_f64(1.0));
        let is_valid = |rate: S| rate.abs().lt(S::from_f64(MAX_WHEEL_RATE));
        let known = is_valid(measured).and(is_valid(desired));
        let desired = S::select(is_valid(desired), desired, zero);
        let measured = S::select(is_valid(measured), measured, state.measured);
        let error = S::select(known, desired - measured, zero);

        let damping = self.derivative * (measured - state.measured) / period;
        let unlimited = self.feed_forward * desired + self.proportional * error + state.integral - damping;
        let duty = unlimited.clamp(-one, one);

        let integral_rate = self.integral * error + self.tracking * (duty - unlimited);
        let moving = desired.abs().gt(zero).or(measured.abs().gt(zero));
        let integral = S::select(moving, state.integral + integral_rate * period, zero);
        (S::select(moving, duty, zero), PidState { integral, measured })
    }
}

#[cfg(test)]
mod tests {
    use super::{Pid, PidState};

    const PERIOD: f64 = 0.01;

    fn pid() -> Pid<f64> {
        Pid { feed_forward: 0.0, proportional: 0.15, integral: 2.0, derivative: 0.0, tracking: 20.0 }
    }

    /// A motor that settles at 10 rad/s per duty with a lag of 80 ms and a load that eats `load` rad/s.
    fn drive(pid: &Pid<f64>, load: f64, desired: impl Fn(usize) -> f64) -> [f64; 900] {
        let (mut state, mut rate) = (PidState::zero(), 0.0);
        core::array::from_fn(|k| {
            let (duty, next) = pid.step(state, desired(k), rate, PERIOD);
            assert!(duty.abs() <= 1.0);
            state = next;
            rate += (10.0 * duty - load - rate) * (PERIOD / 0.08);
            rate
        })
    }

    #[test]
    fn integral_removes_the_error_that_a_load_makes() {
        let rates = drive(&pid(), 1.5, |_| 6.0);
        assert!((rates[899] - 6.0).abs() < 1e-6, "{}", rates[899]);
        let without = Pid { integral: 0.0, ..pid() };
        assert!((drive(&without, 1.5, |_| 6.0)[899] - 6.0).abs() > 1.0);
    }

    /// Asked for more than the motor can give, then for what it can: with anti-windup the wheel obeys at once.
    #[test]
    fn anti_windup_leaves_saturation_at_once() {
        let desired = |k: usize| if k < 300 { 14.0 } else { 5.0 };
        let settled = |rates: &[f64]| rates[300..].iter().position(|rate| (rate - 5.0).abs() < 0.25);
        let with = settled(&drive(&pid(), 0.0, desired)).unwrap();
        let wound_up = Pid { tracking: 0.0, ..pid() };
        let without = settled(&drive(&wound_up, 0.0, desired)).unwrap_or(900);
        assert!(with < 40 && without > 3 * with, "{with} steps with, {without} without");
    }

    #[test]
    fn resting_wheel_gets_no_duty_and_does_not_creep() {
        let stop = |k: usize| if k < 200 { 6.0 } else { 0.0 };
        let (mut state, mut rate) = (PidState::zero(), 0.0_f64);
        let mut duty = 0.0;
        for k in 0..400 {
            // An encoder this coarse reads 0 long before the wheel stands.
            let measured = (rate / 0.5).trunc() * 0.5;
            (duty, state) = pid().step(state, stop(k), measured, PERIOD);
            rate += (10.0 * duty - rate) * (PERIOD / 0.08);
        }
        assert_eq!(duty.to_bits(), 0.0_f64.to_bits());
        assert!(rate.abs() < 1e-3);
    }

    #[test]
    fn broken_rates_change_nothing() {
        let (_, state) = pid().step(PidState::zero(), 6.0, 5.0, PERIOD);
        for (desired, measured) in [(6.0, f64::NAN), (f64::NAN, 5.0), (6.0, f64::INFINITY), (1e300, 5.0)] {
            let (duty, after) = pid().step(state, desired, measured, PERIOD);
            assert!(duty.abs() <= 1.0, "{desired} {measured}: {duty}");
            assert_eq!(after, state, "{desired} {measured}");
        }
    }
}
