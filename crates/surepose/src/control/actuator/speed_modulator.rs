//! Pulses in place of speeds that the base ignores.

use crate::control::limits::Limits;
use crate::kinematics::{DiffDrive, Twist, WheelPair};
use crate::scalar::Float;

/// Pulses exceed the minimum by 2 %: minima are configured in rounded numbers, and a pulse just below moves nothing.
const PULSE_MARGIN: f64 = 1.02;

/// Longest pulse, in periods.
const MAX_PULSE_TICKS: f64 = 100.0;

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

    /// Length of a pulse of each speed in periods: one, or as many as the wheels need to reach the minimum.
    pub fn pulse_ticks(&self, drive: &DiffDrive<S>, limits: &Limits<S>, period: S) -> PulseTicks {
        let ticks = |rim_speed: S| {
            let ramp = rim_speed * S::from_f64(PULSE_MARGIN) / (limits.wheel_acceleration * period);
            // A cast from a NaN is 0; rounding of a whole number does not lengthen the pulse.
            ((ramp.to_f64() - 1e-6).clamp(0.0, MAX_PULSE_TICKS) as u16).saturating_add(1)
        };
        let swing = drive.wheel_separation * S::from_f64(0.5);
        PulseTicks { wheel: ticks(self.wheel), v: ticks(self.v), omega: ticks(self.omega * swing) }
    }
}

/// Lengths of pulses in periods.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PulseTicks {
    /// Of a wheel.
    pub wheel: u16,
    /// Of v.
    pub v: u16,
    /// Of ω.
    pub omega: u16,
}

/// Pulse modulation with error feedback (first-order sigma-delta modulation) of v, ω and both rims.
///
/// A speed at or above its minimum passes. A smaller one is added up to a distance; once this exceeds half of what a pulse
/// covers, a pulse at the minimum is sent and subtracted. Minima of v and ω apply first, then that of the wheels. A pulse lasts
/// one period, or as long as the wheels take to reach the minimum: a shorter one would move the base by less than it should.
///
/// A pulse of ω on top of a passing v stays within the limits of the wheels, as v yields to it; likewise a pulse of v on top of
/// a passing ω. A pulse from rest, and the end of one at rest, may exceed the acceleration
/// limit: the base executes no smaller change.
///
/// # Guarantee
/// After every period, the distance sent differs from the distance asked for by at most half a pulse: v_min·t/2 in path
/// length, ω_min·t/2 in heading, and u_min·t/2 in the travel of each wheel, each 2 % more, for speeds below the minimum and
/// pulses of length t. Zero stays zero, and drops what is owed.
/// Tested by `actuator::modulated_motion_stays_within_half_a_pulse`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SpeedModulator<S> {
    v: PulseChannel<S>,
    omega: PulseChannel<S>,
    right: PulseChannel<S>,
    left: PulseChannel<S>,
    /// Rim speeds of the last command \[m/s].
    last: WheelPair<S>,
}

impl<S: Float> SpeedModulator<S> {
    /// Modulator without a remainder.
    pub(super) fn new() -> Self {
        let channel = PulseChannel::new();
        Self { v: channel, omega: channel, right: channel, left: channel, last: WheelPair::zero() }
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
        let ticks = min.pulse_ticks(drive, limits, period);
        let base = Twist::new(
            self.v.modulate(asked.v, min.v, ticks.v, period),
            self.omega.modulate(asked.omega, min.omega, ticks.omega, period),
        );
        let sent = if min.wheel > S::from_f64(0.0) {
            let rims = drive.wheel_speeds_from_twist(base);
            drive.twist_from_wheel_speeds(WheelPair::new(
                self.right.modulate(rims.right, min.wheel, ticks.wheel, period),
                self.left.modulate(rims.left, min.wheel, ticks.wheel, period),
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

/// One speed: what is owed, and the pulse that is being sent.
#[derive(Clone, Copy, Debug, PartialEq)]
struct PulseChannel<S> {
    /// Distance asked for and not sent \[m] or \[rad].
    owed: S,
    /// Speed of the present pulse, and its remaining periods.
    pulse: (S, u16),
}

impl<S: Float> PulseChannel<S> {
    fn new() -> Self {
        Self { owed: S::from_f64(0.0), pulse: (S::from_f64(0.0), 0) }
    }

    /// `speed`, or a pulse of `ticks` periods at `min`, or rest.
    fn modulate(&mut self, speed: S, min: S, ticks: u16, period: S) -> S {
        let zero = S::from_f64(0.0);
        let min = min * S::from_f64(PULSE_MARGIN);
        if min <= zero || speed.abs() >= min {
            self.pulse = (zero, 0);
            return speed;
        }
        self.owed = self.owed + speed * period;
        let half = min * period * S::from_f64(0.5 * f64::from(ticks));
        // A pulse ends early where the speed asked for has changed its sign.
        let (sent, _) = self.pulse;
        let left = self.owed - sent * period;
        if left * sent < zero && left.abs() > half * S::from_f64(1.0 + 1e-3) {
            self.pulse.1 = 0;
        }
        if self.pulse.1 == 0 {
            if self.owed.abs() < half {
                return zero;
            }
            self.pulse = (if self.owed < zero { -min } else { min }, ticks);
        }
        let (sent, remaining) = self.pulse;
        self.pulse.1 = remaining.saturating_sub(1);
        self.owed = self.owed - sent * period;
        sent
    }
}
