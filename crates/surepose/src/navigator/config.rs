//! Constants of the navigator.

use crate::control::{ActuatorModel, Controller};
use crate::param;
use crate::safety::{CollisionConfig, Footprint, ObstacleConfig};
use crate::scalar::Float;

/// Constants of a [`Navigator`](super::Navigator); those of the estimate are in its
/// [`Localizer`](crate::localization::Localizer).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NavigatorConfig<S> {
    /// Control law, limits and goal tolerance.
    pub controller: Controller<S>,
    /// Minimum speeds, dead time and lag of the base.
    pub actuator: ActuatorModel<S>,
    /// Collision check.
    pub collision: CollisionConfig<S>,
    /// Obstacle monitor.
    pub obstacles: ObstacleConfig<S>,
    /// Turn rate of a lost robot that looks around \[rad/s].
    pub search_turn_rate: S,
    /// Time after which a stopped or blocked robot gives its goal up \[s].
    pub goal_timeout: f64,
    /// Time without motion, despite commands, after which the goal is aborted \[s].
    pub stall_timeout: S,
    /// Time without progress toward the goal after which it is aborted \[s].
    pub progress_timeout: S,
    /// Whether a reached pose is held, and driven to again after a push, until the next goal.
    pub hold_goal: bool,
}

impl<S: Float> NavigatorConfig<S> {
    /// Thresholds of the parameter table for a robot with this controller and outline.
    pub fn new(controller: Controller<S>, footprint: Footprint<S>) -> Self {
        Self {
            controller,
            actuator: ActuatorModel::ideal(),
            collision: CollisionConfig::new(footprint),
            obstacles: ObstacleConfig::default(),
            search_turn_rate: S::from_f64(param::SEARCH_TURN_RATE.default_si()),
            goal_timeout: param::GOAL_TIMEOUT.default_si(),
            stall_timeout: S::from_f64(param::STALL_TIMEOUT.default_si()),
            progress_timeout: S::from_f64(param::PROGRESS_TIMEOUT.default_si()),
            hold_goal: false,
        }
    }
}
