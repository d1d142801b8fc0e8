//! Control: from the estimated pose and the goal to a twist that the wheels can follow.
//!
//! [`NavigationVariables`] are the goal as the robot sees it, [Tran2012] Eq. (3). A [`Law`] turns them into a twist:
//! it selects the direction of travel, then the mode (the global law (23) far away, the local law (28) near the goal), then
//! computes the twist from the scheduled gains. [`Limits`] scale that twist to what the wheels can do, and the
//! [`GoalChecker`] decides when the goal is reached. [`Controller`] joins them for one period.

mod actuator;
mod braking;
mod controller;
mod deadband;
mod directed_error;
mod gains;
mod global;
mod goal_checker;
mod hybrid;
mod hysteresis;
mod law;
mod limits;
mod local;
mod navigation_variables;
mod output;
mod path;
mod path_controller;
mod path_following;
mod pid;
mod sidestep;
mod stall_onset;
mod tran2012;
mod tuning;

pub use actuator::{ActuatorModel, ActuatorState, MAX_PENDING, MinSpeeds, PulseTicks};
pub use braking::BrakingProfile;
pub use controller::{ControlDecision, ControlStep, Controller, ControllerState};
pub use deadband::Deadband;
pub use directed_error::DirectedError;
pub use gains::{ActuatorLimits, Gains};
pub use global::GlobalLaw;
pub use goal_checker::{GoalChecker, GoalStatus, Tolerance};
pub use hybrid::HybridLaw;
pub use hysteresis::{Direction, HybridState};
pub use law::Law;
pub use limits::Limits;
pub use local::LocalLaw;
pub use navigation_variables::{NavigationNoise, NavigationVariables};
pub use output::{ActiveMode, ControlOutput};
pub use path::{InvalidPath, Path, PathPoint, PathSegment};
pub use path_controller::{PathController, PathProgress};
pub use path_following::{PathCommand, PathError, PathFollowingLaw};
pub use pid::{Pid, PidState};
pub use stall_onset::StallOnset;
pub use tran2012::Tran2012Law;
