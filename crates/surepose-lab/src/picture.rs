//! Pictures of drives, sweeps, maps and the paper's figures.

mod building_map;
mod downsampled;
mod drive;
mod figures;
mod html_player;
mod localization;
mod margin;
mod sweep;
mod walls;

pub use building_map::building_map;
pub use downsampled::downsampled;
pub use drive::{heading_error, lyapunov, overview, trajectory, velocities};
pub use figures::{fig3, fig6, fig7};
pub use html_player::html_player;
pub use localization::{LocalizationRun, fig4, fig5};
pub use margin::{margin, margin_over_distance};
pub use surepose_plot::{Picture, PlotError};
pub use sweep::{quantile_plots, start_map};
pub use walls::{MapBackground, wall_map};
