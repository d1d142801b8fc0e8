//! Experiments: replays of recordings, wall maps, metrics, sweeps, the paper's figures.

pub mod drive;
pub mod lost;
pub mod mapping;
pub mod optimal;
pub mod picture;
pub mod replay;
pub mod reproduce;
pub mod rig;
pub mod sweep;
