//! Surepose as a ROS 2 node: odometry, scans, headings and goals in, the pose and velocity commands out.
//!
//! It speaks DDS by itself and needs no ROS installation. [`NodeDriver`] is what it does, without ROS, and can be tested so;
//! [`node`] gives it ears and a voice, [`robot`] is a simulated robot with the topics of a real one.
//!
//! | module | what it is about |
//! |---|---|
//! | [`message`] | the messages, as they are on the wire |
//! | [`convert`] | what they mean in the core's words, or why they mean nothing |
//! | [`NodeDriver`] | the loop: no ROS, no clock |
//! | [`network`] | which domain, and how far it reaches |
//! | [`node`] | topics, the action, the service, parameters and diagnostics |
//! | `bag` | recordings, heard as the node would have; feature `bag` |
//! | `robot` | a simulated robot to try it on; feature `simulate` |
#![forbid(unsafe_code)]

#[cfg(feature = "bag")]
pub mod bag;
pub mod convert;
mod dds;
mod driver;
mod extrinsics;
pub mod message;
mod names;
pub mod network;
pub mod node;
#[cfg(feature = "simulate")]
pub mod robot;
mod sense;
mod velocity;

pub use dds::NodeError;
pub use driver::{DriverReport, LaserScan, NodeDriver, NodeDriverSettings, Odom, START_STD, SensorMessage};
pub use names::{NameProblem, Names, OWN};
