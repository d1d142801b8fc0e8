//! Angles, points, poses and lines of the plane, typed by their frames.
//!
//! A [`Pose`] joins two frames: `map_from_body` is where the body frame lies in the map frame. Poses compose only where
//! their frames meet, which the compiler checks. Every [`Angle`] is wrapped to (−π, π].

mod angle;
mod frame;
mod line;
mod pose;

pub use angle::Angle;
pub use frame::{Body, Frame, Goal, Laser, Map, Target};
pub use line::Line;
pub use pose::{Point, Pose};
