//! Experiments: replays of recordings, wall maps and calibration from them, metrics, sweeps, tuning,
//! the paper's figures.

pub mod calibrate;
pub mod drive;
pub mod lost;
pub mod mapping;
pub mod optimal;
pub mod picture;
pub mod replay;
pub mod reproduce;
pub mod rig;
pub mod survey;
pub mod sweep;
pub mod tune;
mod watch;

pub use watch::Watch;
