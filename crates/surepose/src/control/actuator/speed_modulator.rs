//! Pulses in place of speeds that the base ignores.

use crate::control::limits::Limits;
use crate::kinematics::{DiffDrive, Twist, WheelPair};
use crate::scalar::Float;

/// Pulses exceed the minimum by 2 %: minima are configured in rounded numbers, and a pulse just below moves nothing.
const PULSE_MARGIN: f64 = 1.02;

/// Minimum speeds that a base executes; 0 for none. Slower commands do not move it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MinSpeeds<S> {
    /// Minimum rim speed of each wheel \[m/s].
    pub wheel: S,
    /// Minimum |v| \[m/s].
    pub v: S,
    /// Minimum |ω| \[rad/s].
    pub omega: S,
}

impl<S: Float> MinSpeeds<S> {
    /// A base that executes every speed.
    pub fn none() -> Self {
        let zero = S::from_f64(0.0);
        Self { wheel: zero, v: zero, omega: zero }
    }
}

/// Pulse modulation with error feedback (first-order sigma-delta modulation) of v, ω and both rims.
///
/// A speed at or above its minimum passes. A smaller one is added up to a distance; once this exceeds half of what one period
/// at the minimum covers, a pulse of one period at the minimum is sent and subtracted. Minima of v and ω apply first, then
/// that of the wheels.
///
/// A pulse of ω on top of a passing v stays within the limits of the wheels, as v yields to it; likewise a pulse of v on top of
/// a passing ω. A pulse from rest, and the end of one at rest, may exceed the acceleration
/// limit: the base executes no smaller change.
///
/// # Guarantee
/// After every period, the distance sent differs from the distance asked for by at most half a pulse: v_min·T/2 in path
/// length, ω_min·T/2 in heading, and u_min·T/2 in the travel of each wheel, each 2 % more, for speeds below the minimum. Zero stays
/// zero, and drops what is owed.
/// Tested by `actuator::modulated_motion_stays_within_half_a_pulse`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SpeedModulator<S> {
    /// Path length \[m], heading \[rad] and rim travels \[m] asked for and not sent.
    length: S,
    turn: S,
    travel: WheelPair<S>,
    /// Rim speeds of the last command \[m/s].
    last: WheelPair<S>,
}

impl<S: Float> SpeedModulator<S> {
    /// Nothing owed.
    pub(super) fn new() -> Self {
        let zero = S::from_f64(0.0);
        Self { length: zero, turn: zero, travel: WheelPair::zero(), last: WheelPair::zero() }
    }

    /// The twist to send in the next `period` \[s] for the `asked` one.
    pub(super) fn modulate(
        &mut self,
        min: &MinSpeeds<S>,
        drive: &DiffDrive<S>,
        limits: &Limits<S>,
        asked: Twist<S>,
        period: S,
    ) -> Twist<S> {
        if *min == MinSpeeds::none() {
            return asked;
        }
        if asked == Twist::zero() {
            *self = Self::new();
            return asked;
        }
        let base = Twist::new(
            pulse(&mut self.length, asked.v, min.v, period),
            pulse(&mut self.turn, asked.omega, min.omega, period),
        );
        let sent = if min.wheel > S::from_f64(0.0) {
            let rims = drive.wheel_speeds_from_twist(base);
            drive.twist_from_wheel_speeds(WheelPair::new(
                pulse(&mut self.travel.right, rims.right, min.wheel, period),
                pulse(&mut self.travel.left, rims.left, min.wheel, period),
            ))
        } else {
            self.yield_to_pulse(min, drive, limits, asked, base, period)
        };
        self.last = drive.wheel_speeds_from_twist(sent);
        sent
    }

    /// `sent`, with the part that passed changed by as much as keeps both rims within the limits, where there is room.
    fn yield_to_pulse(
        &self,
        min: &MinSpeeds<S>,
        drive: &DiffDrive<S>,
        limits: &Limits<S>,
        asked: Twist<S>,
        sent: Twist<S>,
        period: S,
    ) -> Twist<S> {
        let half = drive.wheel_separation * S::from_f64(0.5);
        let (v_passes, omega_passes) = (sent.v == asked.v, sent.omega == asked.omega);
        if v_passes == omega_passes {
            return sent;
        }
        let pulse = if v_passes { sent.omega * half } else { sent.v }.abs();
        let rims = drive.wheel_speeds_from_twist(sent);
        let room = |last: S, speed: S| {
            let low = (last - limits.largest_change(last, -S::from_f64(1.0), period).max(pulse))
                .max(-limits.wheel_speed);
            let high = (last + limits.largest_change(last, S::from_f64(1.0), period).max(pulse))
                .min(limits.wheel_speed);
            (low - speed, high - speed)
        };
        let (right, left) = (room(self.last.right, rims.right), room(self.last.left, rims.left));
        // A change of v moves both rims alike, one of ω in opposite directions.
        let left = if v_passes { left } else { (-left.1, -left.0) };
        let (low, high) = (right.0.max(left.0), right.1.min(left.1));
        let change = S::from_f64(0.0).clamp(low, high.max(low));
        let is_executable = |speed: S, minimum: S| {
            speed == S::from_f64(0.0) || speed.abs() >= minimum * S::from_f64(PULSE_MARGIN)
        };
        let yielded = if v_passes {
            Twist::new(sent.v + change, sent.omega)
        } else {
            Twist::new(sent.v, sent.omega + change / half)
        };
        let is_feasible = low <= high;
        if is_feasible && is_executable(yielded.v, min.v) && is_executable(yielded.omega, min.omega) {
            yielded
        } else {
            sent
        }
    }
}

/// `speed`, or a pulse at `min` or rest instead; `owed` is the distance asked for and not sent.
fn pulse<S: Float>(owed: &mut S, speed: S, min: S, period: S) -> S {
    let min = min * S::from_f64(PULSE_MARGIN);
    if min <= S::from_f64(0.0) || speed.abs() >= min {
        return speed;
    }
    *owed = *owed + speed * period;
    let quantum = min * period;
    if owed.abs() < quantum * S::from_f64(0.5) {
        return S::from_f64(0.0);
    }
    let sent = if *owed < S::from_f64(0.0) { -min } else { min };
    *owed = *owed - sent * period;
    sent
}
