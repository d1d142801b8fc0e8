//! Simulator: arenas, motors, encoders, compass, and laser, with a simulated clock and seeded noise.
//!
//! All random numbers derive from a [`Seed`]; each noise source has its own named stream. The same seed gives
//! the same bits. Adding or removing a sensor does not change the noise of the others.

mod arena;
mod cancel;
mod compass;
mod errors;
mod fault;
mod gyroscope;
mod laser;
mod motor;
mod plant;
mod random;
pub mod robot;
pub mod simulation;
mod slip;
mod world;
pub mod world_parameters;
mod world_settings;

pub use arena::{Arena, LOOP_SPEED, WallSegment, loop_course};
pub use cancel::CancelToken;
pub use compass::CompassModel;
pub use errors::{ErrorAccumulator, ErrorSummary};
pub use fault::{Fault, FaultKind, ScanFault, Sensor};
pub use gyroscope::GyroscopeModel;
pub use laser::{Clutter, LaserModel, LaserSweep, PoseTrack, SimulatedScan};
pub use motor::MotorModel;
pub use plant::{Plant, PlantModel, WheelResponse};
pub use random::{Seed, Stream};
pub use slip::{ContactPoints, Slip, Traction};
pub use world::{SensorOutput, Timing, World, WorldModel};
pub use world_settings::WorldSettings;
