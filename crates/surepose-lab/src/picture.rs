//! Pictures of drives and of the paper's figures.

mod drive;
mod figures;
mod film;
mod hall;
mod localisation;
mod margin;
mod sweep;
mod thinned;
mod walls;

pub use drive::{heading_error, lyapunov, overview, trajectory, velocities};
pub use figures::{fig3, fig6, fig7};
pub use film::film;
pub use hall::hall;
pub use localisation::{Localised, fig4, fig5};
pub use margin::{margin, margin_over_distance};
pub use surepose_plot::{Picture, PlotError};
pub use sweep::{spreads, start_map};
pub use thinned::thinned;
pub use walls::{Ground, wall_map};
