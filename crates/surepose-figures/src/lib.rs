//! Figures of drives, maps, sweeps and certificates as SVG, PNG and HTML pages.
//!
//! [`plot`] draws axes, maps and charts of any data; the other functions draw one subject each with it.

mod building_map;
mod downsampled;
pub mod drive;
mod html_player;
mod margin;
pub mod plot;
mod replay;
mod sweep;
mod walls;

pub use crate::plot::{Picture, PlotError};
pub use building_map::building_map;
pub use downsampled::downsampled;
pub use drive::{heading_error, lyapunov, overview, trajectory, velocities};
pub use html_player::html_player;
pub use margin::{margin, margin_over_distance};
pub use replay::{replay_errors, replay_map};
pub use sweep::{quantile_plots, start_map};
pub use walls::{MapBackground, wall_map};
