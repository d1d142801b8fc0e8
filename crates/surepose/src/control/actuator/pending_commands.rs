//! Commands that were sent and have not taken effect.

use crate::geometry::{Frame, Pose};
use crate::kinematics::{Integration, Twist};
use crate::scalar::Float;

/// Number of commands that a prediction covers; a longer dead time counts as this many periods.
pub const MAX_PENDING: usize = 32;

/// The newest commands, each held for a time, and the speed of the base behind them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PendingCommands<S> {
    /// Twist and duration \[s], the newest first.
    commands: [(Twist<S>, S); MAX_PENDING],
    /// Twist of the base after dead time and lag, at the time of the newest command.
    speed: Twist<S>,
}

impl<S: Float> PendingCommands<S> {
    /// Base at rest for long.
    pub(super) fn new() -> Self {
        Self { commands: [(Twist::zero(), S::from_f64(0.0)); MAX_PENDING], speed: Twist::zero() }
    }

    /// Twist of the base at the time at which the next command is sent.
    pub(super) fn speed(&self) -> Twist<S> {
        self.speed
    }

    /// Adds the command of the next `period` \[s], and advances the speed of the base by that period.
    pub(super) fn push(&mut self, delay: S, time_constant: S, command: Twist<S>, period: S) {
        self.commands.copy_within(..MAX_PENDING - 1, 1);
        self.commands[0] = (command, period);
        // The commands that the base follows in this period were sent `delay` ago.
        let follow = |speed: Twist<S>, (command, time): (Twist<S>, S)| {
            let fraction = settled_fraction(time / time_constant);
            Twist::new(
                speed.v + (command.v - speed.v) * fraction,
                speed.omega + (command.omega - speed.omega) * fraction,
            )
        };
        let followed = self.window(delay, period);
        self.speed = followed.filter(|(_, time)| *time > S::from_f64(0.0)).fold(self.speed, follow);
    }

    /// `pose` after all commands of the last `delay` \[s], the oldest first.
    pub(super) fn apply<To: Frame, From: Frame>(
        &self,
        delay: S,
        pose: Pose<To, From, S>,
    ) -> Pose<To, From, S> {
        if delay <= S::from_f64(0.0) {
            return pose;
        }
        self.window(S::from_f64(0.0), delay)
            .filter(|(command, time)| *time > S::from_f64(0.0) && *command != Twist::zero())
            .fold(pose, |pose, (command, time)| pose.integrate(command.integrate_for(time), Integration::Arc))
    }

    /// The commands that were held within `length` \[s] before the moment `age` \[s] before the end of the newest, each with the
    /// time that lies in this window; the oldest first.
    fn window(&self, age: S, length: S) -> impl Iterator<Item = (Twist<S>, S)> {
        let zero = S::from_f64(0.0);
        let (newest, oldest) = (age, age + length);
        let mut end = self.commands.iter().fold(zero, |sum, (_, time)| sum + *time);
        self.commands.iter().rev().map(move |(command, time)| {
            // This command was held from `end` to `end − time` ago.
            let (from, to) = (end, end - *time);
            end = to;
            (*command, (from.min(oldest) - to.max(newest)).max(zero))
        })
    }
}

/// 1 − e^(−x), within 0.3 % for every x ≥ 0: the fraction of a change that a lag has followed after x time constants.
fn settled_fraction<S: Float>(x: S) -> S {
    let one = S::from_f64(1.0);
    // The Taylor series of e^x to the fourth order, by Horner's rule; 1/∞ = 0 for a base without lag.
    let exponential = [4.0, 3.0, 2.0, 1.0].iter().fold(one, |sum, n| one + sum * x / S::from_f64(*n));
    one - one / exponential
}
