//! Experiments on the core: replays, mapping, calibration, sweeps, tuning and the paper's figures.

pub mod calibrate;
mod cancel;
pub mod distance_field;
pub mod kidnapping;
pub mod mapping;
pub mod optimal;
pub mod picture;
pub mod replay;
pub mod reproduce;
pub mod robot;
pub mod simulation;
pub mod sweep;
pub mod tune;

pub use cancel::CancelToken;
