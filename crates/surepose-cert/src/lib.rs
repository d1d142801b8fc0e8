//! Certificate that the sampled control loop reaches the goal, computed with interval arithmetic.
//!
//! The control law, limits, and kinematics of `surepose` are generic over the scalar type. This crate
//! evaluates them with [`Interval`].
#![forbid(unsafe_code)]

mod actuator_errors;
mod adversary;
mod annulus;
mod branching;
mod certificate;
mod controller;
mod counterexample;
mod descent;
mod discrete_state;
mod disturbed_state;
mod drift;
mod interval;
mod lyapunov;
mod map;
mod noise;
mod one_step_reach;
mod prioritized_box;
mod region;
mod search;
mod switch;
mod terminal_phase;
mod tribool;

pub use actuator_errors::ActuatorErrors;
pub use adversary::{AdversarialDrive, AdversarySearch, DriveSample, WorstDrives};
pub use branching::explore_branches;
pub use certificate::{Certificate, RefusalReason, Request, certify};
pub use controller::{DeployedController, SampledController};
pub use counterexample::Counterexample;
pub use discrete_state::DiscreteState;
pub use disturbed_state::{DisturbedState, Transition};
pub use drift::{Drift, drift};
pub use interval::Interval;
pub use lyapunov::LyapunovFunction;
pub use map::{MarginMap, MarginRequest, Margins, margin_map, margins};
pub use noise::NoiseBounds;
pub use terminal_phase::TerminalPhase;
pub use tribool::Tribool;
