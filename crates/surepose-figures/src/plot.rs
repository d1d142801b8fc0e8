//! Pictures: maps with equal axes, heat maps among them, and time series and histograms over one axis; SVG and PNG.
//!
//! The same numbers give the same bytes: no clock, no system font, no system library. Values come in the units that
//! the axes show; nothing here knows what they mean.

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
pub use picture::{Picture, PlotError, Subplot, hstack, hstack_column, vstack};
pub use scale::Scale;
pub use style::{Color, Stroke};
