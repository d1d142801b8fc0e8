//! Plots as SVG and PNG: maps with equal axes, heat maps, time series, and histograms.
//!
//! The output is deterministic: equal input gives equal bytes, without a clock, system fonts, or system
//! libraries. Values are in the units shown on the axes; this crate does not interpret them.

mod axes;
mod chart;
mod font;
mod heatmap;
mod items;
mod legend;
mod map;
mod picture;
mod raster;
mod scale;
mod scene;
mod style;
mod svg;
mod ticks;

pub use chart::{Mark, Panel, Series, XyPlot};
pub use heatmap::{Heatmap, HeatmapCell};
pub use items::{Arrow, DotPaint, Dots, Outline, Trace};
pub use map::MapPlot;
pub use picture::{Picture, PlotError, Subplot, column, hstack, hstack_column, vstack};
pub use scale::Scale;
pub use style::{Color, Stroke};
