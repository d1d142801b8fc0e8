//! Pictures: maps with equal axes, heat maps among them, and time series and histograms over one axis; SVG and PNG.
//!
//! The same numbers give the same bytes: no clock, no system font, no system library. Values come in the units that
//! the axes show; nothing here knows what they mean.

mod axes;
mod chart;
mod font;
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
mod tiles;

pub use chart::{Chart, Mark, Panel, Series};
pub use items::{Arrow, DotPaint, Dots, Outline, Trace};
pub use map::Map;
pub use picture::{Cell, Picture, PlotError, beside, beside_column, stacked};
pub use scale::Scale;
pub use style::{Color, Stroke};
pub use tiles::{Tile, Tiles};
