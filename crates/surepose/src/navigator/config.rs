//! Constants of the navigator.

use crate::control::Controller;
use crate::safety::{CollisionConfig, ObstacleConfig};

/// Constants of a [`Navigator`](super::Navigator); those of the estimate are in its
/// [`Localizer`](crate::localization::Localizer).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NavigatorConfig<S> {
    /// Control law, limits and goal tolerance.
    pub controller: Controller<S>,
    /// Collision check.
    pub collision: CollisionConfig<S>,
    /// Obstacle monitor.
    pub obstacles: ObstacleConfig<S>,
    /// Turn rate of a lost robot that looks around \[rad/s].
    pub search_turn_rate: S,
    /// Time after which a stopped or blocked robot gives its goal up \[s].
    pub goal_timeout: f64,
    /// Whether a reached pose is held, and driven to again after a push, until the next goal.
    pub hold_goal: bool,
}
