//! Motion monitor: compares commanded with measured motion.

use crate::kinematics::WheelPair;
use crate::scalar::Float;

/// Time constant of the sums of commanded and measured motion \[s].
const MEMORY: f64 = 1.0;
/// Commanded motion below which nothing is concluded \[m of rim travel].
const MIN_COMMANDED: f64 = 0.002;
/// A channel that does less than this fraction of its command does not move.
const STUCK_FRACTION: f64 = 0.05;
/// A channel that does at least this fraction of its command moves.
const MOVING_FRACTION: f64 = 0.5;
/// A channel is judged only where its command is at least this fraction of the fastest one.
const RELEVANT_FRACTION: f64 = 0.3;
/// Rim speed that every base executes \[m/s]: a wheel that stands still at it is blocked.
const EXECUTABLE_SPEED: f64 = 0.05;

/// A part of the motion whose command is compared with odometry.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MotionChannel {
    /// Turn rate of the base.
    Turn,
    /// Forward speed of the base.
    Forward,
    /// Speed of the right wheel.
    RightWheel,
    /// Speed of the left wheel.
    LeftWheel,
}

/// Reason for which commanded motion does not happen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MotionFault {
    /// The command is so small that the base may ignore it.
    Stalled(MotionChannel),
    /// The command moved the base before, or is one that every base executes.
    Blocked(MotionChannel),
}

/// Compares commanded motion with odometry: of v, ω and both wheels.
///
/// Sums with a memory of 1 s make it independent of the control period, of encoder resolution and of pulses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionMonitor<S> {
    channels: [(MotionChannel, ChannelMotion<S>); 4],
}

impl<S: Float> MotionMonitor<S> {
    /// Monitor before the first command.
    pub fn new() -> Self {
        let channels = [
            MotionChannel::Turn,
            MotionChannel::Forward,
            MotionChannel::RightWheel,
            MotionChannel::LeftWheel,
        ];
        Self { channels: channels.map(|channel| (channel, ChannelMotion::new())) }
    }

    /// Takes the `expected` rim speeds \[m/s] of the last `elapsed` \[s] and the rim `travel` \[m] that odometry measured.
    pub fn update(&mut self, expected: WheelPair<S>, travel: WheelPair<S>, elapsed: S) {
        let is_usable = travel.right.is_finite() && travel.left.is_finite() && elapsed > S::from_f64(0.0);
        if !is_usable {
            return;
        }
        let half = S::from_f64(0.5);
        let channels = |rims: WheelPair<S>| {
            [(rims.right - rims.left) * half, (rims.right + rims.left) * half, rims.right, rims.left]
        };
        let (commanded, measured) = (channels(expected), channels(travel));
        let relevant = commanded.iter().fold(S::from_f64(0.0), |most, speed| most.max(speed.abs()))
            * S::from_f64(RELEVANT_FRACTION);
        let kept = S::from_f64(MEMORY) / (S::from_f64(MEMORY) + elapsed);
        for (index, (_, channel)) in self.channels.iter_mut().enumerate() {
            let speed = commanded[index];
            let speed = if speed.abs() >= relevant { speed } else { S::from_f64(0.0) };
            channel.update(speed, measured[index], elapsed, kept);
        }
    }

    /// Speed that has not followed its command for `timeout` \[s]; `None` if all do.
    pub fn fault(&self, timeout: S) -> Option<MotionFault> {
        let stuck = self.channels.iter().find(|(_, channel)| channel.stuck_for >= timeout);
        stuck.map(|(name, channel)| {
            if self.is_blocked(channel) { MotionFault::Blocked(*name) } else { MotionFault::Stalled(*name) }
        })
    }

    /// Whether the base executes the command of this channel otherwise.
    ///
    /// A base may ignore a small v or ω although its wheels moved as slowly before, as parts of a faster twist: what v and ω
    /// are doing now must have moved the base, too.
    fn is_blocked(&self, stuck: &ChannelMotion<S>) -> bool {
        let is_executable = stuck.mean_command() >= S::from_f64(EXECUTABLE_SPEED);
        let [turn, forward, ..] = &self.channels;
        let has_moved = [turn, forward].iter().all(|(_, channel)| channel.moves() || channel.has_moved());
        is_executable || (stuck.has_moved() && has_moved)
    }

    /// Starts timing anew, for a new goal; the speeds that moved the base are kept.
    pub fn restart(&mut self) {
        for (_, channel) in &mut self.channels {
            *channel = ChannelMotion { least_moving: channel.least_moving, ..ChannelMotion::new() };
        }
    }
}

impl<S: Float> Default for MotionMonitor<S> {
    fn default() -> Self {
        Self::new()
    }
}

/// One channel, as the rim travel of a wheel.
#[derive(Clone, Copy, Debug, PartialEq)]
struct ChannelMotion<S> {
    /// Recent commanded and measured travel without their signs \[m], and time with a command \[s].
    commanded: S,
    measured: S,
    active: S,
    /// Time without motion despite commands \[s].
    stuck_for: S,
    /// Lowest mean command at which the channel moved \[m/s].
    least_moving: S,
}

impl<S: Float> ChannelMotion<S> {
    fn new() -> Self {
        let zero = S::from_f64(0.0);
        let least_moving = S::from_f64(EXECUTABLE_SPEED);
        Self { commanded: zero, measured: zero, active: zero, stuck_for: zero, least_moving }
    }

    fn update(&mut self, speed: S, travel: S, elapsed: S, kept: S) {
        let zero = S::from_f64(0.0);
        let is_active = speed.abs() > zero;
        self.commanded = (self.commanded + speed.abs() * elapsed) * kept;
        self.measured = (self.measured + if is_active { travel.abs() } else { zero }) * kept;
        self.active = (self.active + if is_active { elapsed } else { zero }) * kept;
        if self.commanded < S::from_f64(MIN_COMMANDED) {
            return;
        }
        if self.measured < self.commanded * S::from_f64(STUCK_FRACTION) {
            self.stuck_for = self.stuck_for + elapsed;
        } else {
            self.stuck_for = zero;
        }
        if self.moves() {
            self.least_moving = self.least_moving.min(self.mean_command());
        }
    }

    /// Mean speed of the recent commands \[m/s].
    fn mean_command(&self) -> S {
        self.commanded.div_or_zero(self.active)
    }

    /// Whether the channel follows its command, which may be none.
    fn moves(&self) -> bool {
        self.measured >= self.commanded * S::from_f64(MOVING_FRACTION)
    }

    /// Whether the present command moved the channel before, or is one that every base executes.
    fn has_moved(&self) -> bool {
        self.mean_command() >= self.least_moving
    }
}

#[cfg(test)]
mod tests {
    use super::{MotionChannel, MotionFault, MotionMonitor};
    use crate::kinematics::WheelPair;

    const TIMEOUT: f64 = 4.0;

    /// Fault after `seconds` of these commands \[m/s], and when it came; `did` maps commands to measured rim speeds.
    fn fault_after(
        seconds: f64,
        period: f64,
        command: impl Fn(usize) -> [f64; 2],
        did: impl Fn([f64; 2]) -> [f64; 2],
    ) -> Option<(f64, MotionFault)> {
        let mut monitor = MotionMonitor::new();
        let pair = |[right, left]: [f64; 2]| WheelPair::new(right, left);
        (0..(seconds / period) as usize).find_map(|tick| {
            let commanded = command(tick);
            let travel = pair(did(commanded)).scaled(period);
            monitor.update(pair(commanded), travel, period);
            monitor.fault(TIMEOUT).map(|fault| (tick as f64 * period, fault))
        })
    }

    #[test]
    fn a_base_that_ignores_slow_commands_stalls_and_a_held_one_is_blocked() {
        for period in [0.02, 0.1, 0.2] {
            let stalled = fault_after(20.0, period, |_| [0.015, -0.015], |_| [0.0; 2]);
            assert_eq!(stalled.map(|(_, fault)| fault), Some(MotionFault::Stalled(MotionChannel::Turn)));
            let blocked = fault_after(20.0, period, |_| [0.2, 0.2], |_| [0.0; 2]);
            assert_eq!(blocked.map(|(_, fault)| fault), Some(MotionFault::Blocked(MotionChannel::Forward)));
            // One wheel is held after five seconds.
            let moves = (5.0 / period) as usize;
            let mut monitor = MotionMonitor::new();
            let end = (0..1000).find(|tick| {
                let right = if *tick < moves { 0.2 } else { 0.0 };
                monitor.update(
                    WheelPair::new(0.2, 0.2),
                    WheelPair::new(right * period, 0.2 * period),
                    period,
                );
                monitor.fault(TIMEOUT).is_some()
            });
            let took = end.map(|tick: usize| tick as f64 * period - 5.0);
            assert!(took.is_some_and(|took| took < 9.0), "{took:?}");
            assert_eq!(monitor.fault(TIMEOUT), Some(MotionFault::Blocked(MotionChannel::RightWheel)));
        }
    }

    /// A base that stood still at a command that moved it before is blocked, whatever the speed.
    #[test]
    fn a_command_that_moved_the_base_before_blocks_it() {
        let mut monitor = MotionMonitor::new();
        for (seconds, moves) in [(10.0, true), (20.0, false)] {
            for _ in 0..(seconds / 0.1) as usize {
                let speed = if moves { 0.02 } else { 0.025 };
                let travel = if moves { speed * 0.1 } else { 0.0 };
                monitor.update(WheelPair::new(speed, speed), WheelPair::new(travel, travel), 0.1);
            }
        }
        assert_eq!(monitor.fault(TIMEOUT), Some(MotionFault::Blocked(MotionChannel::Forward)));
    }

    /// Wheels that moved slowly within a fast twist are not blocked where the base ignores a slow twist.
    #[test]
    fn a_base_that_ignores_slow_twists_stalls_whatever_its_wheels_did_before() {
        let base = |[right, left]: [f64; 2]| {
            let keep = |half: f64| if half.abs() < 0.02 { 0.0 } else { half };
            let (turn, forward) = (keep(0.5 * (right - left)), keep(0.5 * (right + left)));
            [forward + turn, forward - turn]
        };
        // The right wheel turns at 1 cm/s in a curve; then the base gets 1.6 cm/s forward and a little turn.
        for slow in [[0.016, 0.016], [0.018, 0.012], [0.012, 0.018]] {
            let command = |tick: usize| if tick < 100 { [0.01, 0.15] } else { slow };
            let fault = fault_after(40.0, 0.1, command, base).map(|(_, fault)| fault);
            assert!(matches!(fault, Some(MotionFault::Stalled(_))), "{slow:?}: {fault:?}");
        }
    }

    #[test]
    fn bases_that_move_have_no_fault() {
        // Pulses that the base executes, a base that turns with wheels of unequal size, and one that slips a lot.
        let pulses = |tick: usize| if tick % 8 == 0 { [0.02, 0.02] } else { [0.0; 2] };
        assert_eq!(fault_after(60.0, 0.1, pulses, |did| did), None);
        let turning = |_| [0.101, -0.1];
        assert_eq!(fault_after(60.0, 0.1, turning, |[right, left]| [right * 0.97, left]), None);
        assert_eq!(fault_after(60.0, 0.1, |_| [0.2, 0.2], |did| did.map(|rim| 0.3 * rim)), None);
        assert_eq!(fault_after(60.0, 0.1, |_| [0.0; 2], |_| [0.0; 2]), None);
    }
}
