//! Pictures of the paper's figures.

mod figures;
mod localization;

pub use figures::{fig3, fig6, fig7};
pub use localization::{LocalizationRun, fig4, fig5};
