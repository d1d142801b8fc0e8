//! The simulated world and the robot in it: arenas, motors, encoders, compass, laser, faults; owns the clock and the seeds.
//!
//! Everything random is drawn from a [`Seed`], each source from its own named stream: the same seed gives the same
//! bits, and a sensor that is added or left out changes nothing about the others.

mod arena;
mod cancel;
mod compass;
pub mod distance_field;
mod errors;
mod fault;
mod laser;
mod motor;
pub mod optimal;
mod random;
pub mod robot;
pub mod simulation;
mod slip;
mod world;

pub use arena::{Arena, LOOP_SPEED, WallSegment, loop_course};
pub use cancel::CancelToken;
pub use compass::CompassModel;
pub use errors::{ErrorAccumulator, ErrorSummary};
pub use fault::{Fault, FaultKind, Sensor};
pub use laser::{Clutter, LaserModel, SimulatedScan};
pub use motor::MotorModel;
pub use random::{Seed, Stream};
pub use slip::Slip;
pub use world::{SensorOutput, Timing, World, WorldModel};
