//! Experiments: replays of recordings, metrics, sweeps, the paper's figures.

pub mod optimal;
pub mod replay;
pub mod sweep;
