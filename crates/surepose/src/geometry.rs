//! Angles, points, poses and lines of the plane, typed by their frames.
//!
//! A [`Pose`] relates two frames: `map_from_body` is the pose of the body frame in the map frame. The compiler rejects a
//! composition of poses whose inner frames differ. Every [`Angle`] is wrapped to (−π, π].

mod angle;
mod frame;
mod line;
mod pose;

pub use angle::Angle;
pub use frame::{Body, Frame, Goal, Laser, Map, Target};
pub use line::Line;
pub use pose::{Point, Pose};
