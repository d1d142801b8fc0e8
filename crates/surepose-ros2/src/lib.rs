//! Surepose as a ROS 2 node: odometry, scans, headings and goals in, the pose and velocity commands out.
//!
//! The node implements DDS and needs no ROS installation. [`NodeDriver`] runs the loop without ROS, for tests and replays;
//! [`node`] connects it to topics, and [`robot`] is a simulated robot with the topics of a real one.
//!
//! | module | contents |
//! |---|---|
//! | [`message`] | ROS 2 messages in their wire format |
//! | [`convert`] | conversion of messages to core types, with errors |
//! | [`NodeDriver`] | the loop without ROS and without a clock |
//! | [`network`] | DDS domain and discovery range |
//! | [`node`] | topics, the action, the service, parameters and diagnostics |
//! | `bag` | replay of MCAP recordings; feature `bag` |
//! | `robot` | simulated robot; feature `simulate` |
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
