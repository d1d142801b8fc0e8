//! Simulator: arenas, motors, encoders, compass, and laser, with a simulated clock and seeded noise.
//!
//! All random numbers derive from a [`Seed`]; each noise source has its own named stream. The same seed gives
//! the same bits. Adding or removing a sensor does not change the noise of the others.

mod arena;
mod cancel;
mod compass;
mod errors;
mod fault;
mod laser;
mod motor;
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
