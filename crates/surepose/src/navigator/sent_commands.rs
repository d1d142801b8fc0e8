//! Commands of the navigator, and their comparison with the motion of the base.

use crate::control::{ActuatorState, Controller};
use crate::geometry::{Body, Map, Pose};
use crate::kinematics::{Twist, WheelPair};
use crate::localization::Odometry;
use crate::safety::{MotionFault, MotionMonitor};
use crate::scalar::Float;

use super::{Command, NavigatorConfig};

/// The last command, the actuator stage behind it, and the monitor that compares both with odometry.
#[derive(Clone, Debug)]
pub(super) struct SentCommands<S> {
    /// Twist of the last command within the limits; zero while the wheels belong to another controller.
    limited: Twist<S>,
    /// That twist after the actuator stage.
    sent: Twist<S>,
    actuator: ActuatorState<S>,
    motion: MotionMonitor<S>,
}

impl<S: Float> SentCommands<S> {
    /// Wheels at rest.
    pub(super) fn new() -> Self {
        Self {
            limited: Twist::zero(),
            sent: Twist::zero(),
            actuator: ActuatorState::new(),
            motion: MotionMonitor::new(),
        }
    }

    /// Twist of the last command within the limits.
    pub(super) fn limited(&self) -> Twist<S> {
        self.limited
    }

    /// The pose at which the next command takes effect.
    pub(super) fn predict(
        &self,
        config: &NavigatorConfig<S>,
        pose: Pose<Map, Body, S>,
    ) -> Pose<Map, Body, S> {
        self.actuator.predict(&config.actuator, pose)
    }

    /// Rim speeds that the base is expected to have \[m/s].
    pub(super) fn expected_rims(&self, config: &NavigatorConfig<S>) -> WheelPair<S> {
        let expected = self.actuator.expected_speed(&config.actuator, self.sent);
        config.controller.drive.wheel_speeds_from_twist(expected)
    }

    /// Sends a twist that is within the limits.
    pub(super) fn send(&mut self, config: &NavigatorConfig<S>, limited: Twist<S>) -> Command<S> {
        let Controller { drive, limits, period, .. } = config.controller;
        self.limited = limited;
        self.sent = self.actuator.execute(&config.actuator, &drive, &limits, limited, period);
        Command { twist: self.sent, wheels: drive.wheel_rates_from_twist(self.sent) }
    }

    /// Forgets what was commanded, for wheels that rest or belong to another controller.
    pub(super) fn forget(&mut self) {
        self.limited = Twist::zero();
        self.sent = Twist::zero();
        self.actuator.reset();
    }

    /// Compares the commands of the last `elapsed` \[s] with odometry.
    pub(super) fn compare(&mut self, config: &NavigatorConfig<S>, odometry: Odometry<S>, elapsed: S) {
        let travel = match odometry {
            Odometry::WheelTravel(travel) => travel,
            Odometry::WithVariance(odometry) => odometry.travel,
            Odometry::Missing => return,
        };
        self.motion.update(self.expected_rims(config), travel, elapsed);
    }

    /// Starts timing the motion anew, for a new goal.
    pub(super) fn restart_monitor(&mut self) {
        self.motion.restart();
    }

    /// Motion that was commanded and did not happen for the stall time-out.
    pub(super) fn motion_fault(&self, config: &NavigatorConfig<S>) -> Option<MotionFault> {
        self.motion.fault(config.stall_timeout)
    }
}
