//! Safety: how far the estimate can be trusted, and what stands in the robot's way.
//!
//! The [`Supervisor`] watches odometry, measurements, scans and wheels, and decides whether the robot may proceed, must
//! slow down or must stop, with a named [`FaultReason`]. The collision check predicts the path of the [`Footprint`] and
//! yields a [`SpeedCap`] from which the robot can stop before every wall and every obstacle that the
//! [`ObstacleMonitor`] saw.
//!
//! The [`MotionMonitor`] compares commands with odometry, and the [`ProgressMonitor`] watches the Lyapunov function: both end
//! a goal that cannot be reached.
//!
//! The [`LaserMonitor`] detects a laser whose scans show nothing, before its silence is taken for free space.
//!
//! The laser sees one plane. Nothing here replaces a certified safety scanner.

mod collision;
mod footprint;
mod laser_monitor;
mod motion_monitor;
mod obstacle_monitor;
mod progress_monitor;
mod supervisor;

pub use collision::{BlockReason, CollisionConfig, Intent, SpeedCap};
pub use footprint::{Footprint, InvalidFootprint, MAX_VERTICES, Polygon};
pub use laser_monitor::{LaserMonitor, LaserMonitorConfig};
pub use motion_monitor::{MotionChannel, MotionFault, MotionMonitor};
pub use obstacle_monitor::{ObstacleConfig, ObstacleMonitor};
pub use progress_monitor::{LyapunovValue, ProgressMonitor};
pub use supervisor::{FaultReason, Health, SafetyAction, Supervisor, SupervisorConfig};
