//! Pictures: maps with equal axes and time series stacked over one axis, as SVG and as PNG.
//!
//! The same numbers give the same bytes: no clock, no system font, no system library. Values come in the units that
//! the axes show; nothing here knows what they mean.

mod chart;
mod map;
mod picture;
mod style;

pub use chart::{Chart, Mark, Panel, Series};
pub use map::{Arrow, Cloud, Map, Outline, Trace};
pub use picture::{Cell, Picture, PlotError, beside, beside_column};
pub use style::{Color, Stroke};
