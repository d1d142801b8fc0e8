//! Drive a differential robot to a pose, and be sure.
#![no_std]

mod angle;
pub mod closed_loop;
mod covariance;
mod drive;
mod estimate;
mod frame;
mod law;
mod limit;
mod line;
mod matrix;
mod navigation;
mod path;
mod pose;
mod scalar;

pub use angle::Angle;
pub use covariance::{Covariance, NotACovariance, Observation};
pub use drive::{Drive, Integration, Motion, Twist, Wheels};
pub use estimate::*;
pub use frame::{Body, Frame, Goal, Laser, Map, Target};
pub use law::*;
pub use limit::Limits;
pub use line::Line;
pub use matrix::Matrix;
pub use navigation::{Navigation, NavigationNoise};
pub use path::{Leg, NotAPath, Path, Place};
pub use pose::{Point, Pose};
pub use scalar::{Float, Mask, Scalar};
