//! Results of a goal.

use crate::estimation::DisagreeingSensor;
use crate::param::{self, Parameter};
use crate::safety::{BlockReason, FaultReason, MotionChannel, MotionFault};

/// Result of a goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum GoalResult {
    /// The robot rests within the tolerance of the goal, according to its estimate.
    Reached,
    /// The goal was canceled.
    Canceled,
    /// Another goal replaced it.
    Preempted,
    /// The robot could not go on.
    Aborted(AbortReason),
}

/// Reason for which a goal was aborted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum AbortReason {
    /// The supervisor stopped the robot for the goal time-out.
    Fault(FaultReason),
    /// This sensor disagreed with the others beyond noise and considered errors, so that the goal could not be known to be reached.
    Disagreement(DisagreeingSensor),
    /// A wall, an obstacle or a missing laser blocked the robot.
    Blocked(BlockReason),
    /// The base does not execute its commands.
    Motion(MotionFault),
    /// The Lyapunov function of the control law has not fallen as it must.
    NoProgress,
    /// The stamps of odometry went back by more than a second.
    ClockSetBack,
}

impl AbortReason {
    /// The name used in reports and JSON.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Fault(reason) => reason.name(),
            Self::Disagreement(_) => FaultReason::Inconsistent.name(),
            Self::Blocked(reason) => reason.name(),
            Self::Motion(MotionFault::Stalled(_)) => "stalled",
            Self::Motion(MotionFault::Blocked(_)) => "blocked",
            Self::NoProgress => "no_progress",
            Self::ClockSetBack => "clock_set_back",
        }
    }

    /// Parameters that probably do not describe the robot: the remedy.
    pub const fn suspects(self) -> &'static [Parameter] {
        match self {
            Self::Motion(MotionFault::Stalled(MotionChannel::Turn)) => {
                &[param::MIN_TURN_RATE, param::MIN_WHEEL_SPEED]
            }
            Self::Motion(MotionFault::Stalled(MotionChannel::Forward)) => {
                &[param::MIN_SPEED, param::MIN_WHEEL_SPEED]
            }
            Self::Motion(MotionFault::Stalled(_)) => {
                &[param::MIN_WHEEL_SPEED, param::MIN_SPEED, param::MIN_TURN_RATE]
            }
            Self::NoProgress => {
                &[param::WHEEL_ACCELERATION_LIMIT, param::COMMAND_DELAY, param::MOTOR_TIME_CONSTANT]
            }
            Self::Disagreement(DisagreeingSensor::Compass) => {
                &[param::COMPASS_OFFSET, param::WHEEL_RADIUS_RATIO, param::WHEEL_SEPARATION]
            }
            Self::Disagreement(DisagreeingSensor::Laser) => {
                &[param::LASER_HEADING, param::LASER_X, param::LASER_Y, param::LASER_LATENCY]
            }
            Self::Disagreement(DisagreeingSensor::Map) => &[param::WALL_STD, param::LASER_RANGE_SCALE_STD],
            Self::Fault(FaultReason::WheelTrackingError) => &[param::WHEEL_ACCELERATION_LIMIT],
            _ => &[],
        }
    }
}

/// A goal that was not accepted: the footprint at the goal is closer to a wall than the required clearance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoRoomAtGoal<S> {
    /// Distance from the footprint to the nearest wall \[m]; 0 in contact.
    pub clearance: S,
    /// Required distance \[m].
    pub required: S,
}
