//! Start and goal poses that the walls rule out.

use surepose::geometry::{Map, Point};
use surepose_io::owned_map::GoalProblem;

use crate::WallSegment;

/// Pose of a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ScenarioEnd {
    /// Start.
    Start,
    /// Goal.
    Goal,
}

/// Start or goal that the walls rule out.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("the {} ({}, {}) {reason}", self.end.name(), self.at.x, self.at.y)]
pub struct InvalidEnd {
    /// Start or goal.
    pub end: ScenarioEnd,
    /// Its position.
    pub at: Point<Map, f64>,
    /// Reason.
    pub reason: InvalidEndReason,
}

/// Reason why the walls rule out a start or a goal.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum InvalidEndReason {
    /// Outside the rectangle around the arena.
    #[error("lies outside the arena, {distance:.2} m beyond {}", named(.wall))]
    OutsideArena {
        /// Distance to the nearest wall \[m].
        distance: f64,
        /// The nearest wall.
        wall: WallSegment,
    },
    /// The footprint at the start touches a wall.
    #[error("puts the footprint on {}", named(.wall))]
    InContact {
        /// The wall nearest to the middle of the axle.
        wall: WallSegment,
    },
    /// The map rules the goal out.
    #[error(transparent)]
    Goal(#[from] GoalProblem),
}

fn named(WallSegment { start: a, end: b }: &WallSegment) -> String {
    format!("the wall from ({}, {}) to ({}, {})", a.x, a.y, b.x, b.y)
}

impl ScenarioEnd {
    /// The name in messages and options.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Start => "start",
            Self::Goal => "goal",
        }
    }
}
