//! A picture that is drawn, and how it becomes a file.

use std::path::Path;

use kuva::backend::svg::SvgBackend;
use kuva::render::figure::Figure;
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;
use kuva::render::render::{Primitive, Scene};

use crate::raster;
use crate::scale::Scale;
use crate::tiles::Tiles;

/// A picture, ready to be written.
pub struct Picture {
    scene: Scene,
}

/// Why a picture could not be made.
#[derive(Debug, thiserror::Error)]
pub enum PlotError {
    /// The file cannot be written.
    #[error(transparent)]
    Write(#[from] std::io::Error),
    /// The raster does not fit into memory or a PNG.
    #[error("cannot be drawn as PNG: {0}")]
    Raster(String),
}

impl Picture {
    /// The picture as SVG.
    pub fn svg(&self) -> String {
        renumbered(&SvgBackend::new().with_pretty(true).render_scene(&self.scene))
    }

    /// The picture as PNG.
    ///
    /// # Errors
    /// [`PlotError::Raster`].
    pub fn png(&self) -> Result<Vec<u8>, PlotError> {
        raster::png(&self.scene).map_err(PlotError::Raster)
    }

    /// Writes `folder/name.svg` and `folder/name.png`.
    ///
    /// # Errors
    /// [`PlotError`].
    pub fn save(&self, folder: &Path, name: &str) -> Result<(), PlotError> {
        std::fs::write(folder.join(format!("{name}.svg")), self.svg())?;
        std::fs::write(folder.join(format!("{name}.png")), self.png()?)?;
        Ok(())
    }
}

/// One part of a picture: what is drawn, its axes, and its size with all labels \[px].
pub struct Cell {
    pub(crate) plots: Vec<Plot>,
    pub(crate) layout: Layout,
    pub(crate) width: f64,
    pub(crate) height: f64,
    pub(crate) underlay: Option<Underlay>,
}

/// Cells below a part, in the place that their stand-in keeps, and the bar of their shades beside it.
pub(crate) struct Underlay {
    pub(crate) tiles: Tiles,
    pub(crate) scale: Option<Scale>,
    /// Left, upper end, width and height of the axes in the part \[px].
    pub(crate) axes: [f64; 4],
    /// What the legend takes of the bar's place \[px].
    pub(crate) legend_height: f64,
}

/// Space between parts \[px].
const GAP: f64 = 8.0;

/// One part on the left, as high as the others on its right are together.
pub fn beside_column(left: Cell, right: Vec<Cell>) -> Picture {
    let rows = right.len().max(1);
    let width = right.iter().fold(0.0, |widest: f64, cell| widest.max(cell.width));
    let mut figure = Figure::new(rows, 2).with_spacing(GAP).with_padding(GAP);
    // Cells are numbered row by row; the left part covers every other one.
    let mut structure = vec![(0..rows).map(|row| 2 * row).collect()];
    structure.extend((0..right.len()).map(|row| vec![2 * row + 1]));
    figure = figure.with_structure(structure).with_col_width(0, left.width).with_col_width(1, width);
    for (row, cell) in right.iter().enumerate() {
        figure = figure.with_row_height(row, cell.height);
    }
    finish(figure, std::iter::once(left).chain(right).collect())
}

/// Charts below each other, each over an axis of its own.
pub fn stacked(charts: Vec<Vec<Cell>>) -> Picture {
    below(charts.into_iter().flatten().collect())
}

/// The parts below each other.
pub(crate) fn below(cells: Vec<Cell>) -> Picture {
    let heights: Vec<f64> = cells.iter().map(|cell| cell.height).collect();
    let width = cells.iter().fold(0.0, |widest: f64, cell| widest.max(cell.width));
    let mut figure = Figure::new(cells.len(), 1);
    figure = figure.with_structure((0..cells.len()).map(|i| vec![i]).collect());
    figure = figure.with_spacing(GAP).with_padding(GAP).with_col_width(0, width);
    for (row, height) in heights.iter().enumerate() {
        figure = figure.with_row_height(row, *height);
    }
    finish(figure, cells)
}

/// The parts beside each other, as high as the highest.
pub fn beside(cells: Vec<Cell>) -> Picture {
    let height = cells.iter().fold(0.0, |highest: f64, cell| highest.max(cell.height));
    let mut figure = Figure::new(1, cells.len());
    figure = figure.with_structure((0..cells.len()).map(|i| vec![i]).collect());
    figure = figure.with_spacing(GAP).with_padding(GAP).with_row_height(0, height);
    for (column, cell) in cells.iter().enumerate() {
        figure = figure.with_col_width(column, cell.width);
    }
    finish(figure, cells)
}

fn finish(figure: Figure, cells: Vec<Cell>) -> Picture {
    let (mut plots, mut layouts, mut underlays) = (Vec::new(), Vec::new(), Vec::new());
    for cell in cells {
        plots.push(cell.plots);
        layouts.push(cell.layout);
        underlays.extend(cell.underlay);
    }
    let mut scene = figure.with_plots(plots).with_layouts(layouts).render();
    scene.elements = underlaid(scene.elements, underlays);
    Picture { scene }
}

/// The same drawing with the cells in the places of their stand-ins, in order, and each one's bar beside its axes.
fn underlaid(elements: Vec<Primitive>, underlays: Vec<Underlay>) -> Vec<Primitive> {
    let mut waiting = underlays.into_iter();
    let mut bar = Vec::new();
    let mut drawn = Vec::with_capacity(elements.len());
    for element in elements {
        match element {
            // Nothing but a stand-in is drawn as a batch of rectangles.
            Primitive::RectBatch { x, y, w, h, .. } => {
                let Some(underlay) = waiting.next() else { continue };
                let Underlay { tiles, scale, axes: [left, top, width, height], legend_height } = underlay;
                let first = |list: Vec<f64>| list.first().copied().unwrap_or(0.0);
                // The library makes what fills its place half a pixel larger.
                let place = [first(x), first(y), first(w) - 0.5, first(h) - 0.5];
                drawn.extend(tiles.drawn(scale.as_ref(), place));
                let (right, bottom) = (left + width, top + height);
                bar = scale.map_or(Vec::new(), |scale| scale.bar(right, top + legend_height, bottom));
            }
            // What lies outside of the axes is drawn once nothing is cut off any more.
            Primitive::ClipEnd => {
                drawn.push(Primitive::ClipEnd);
                drawn.append(&mut bar);
            }
            other => drawn.push(other),
        }
    }
    drawn
}

/// How the drawing library names its clip paths, before their number.
const CLIP: &str = "kuva-clip-";

/// The same SVG with its clip paths numbered from 0.
///
/// The library counts them through the whole process, so that the second picture would differ from the first.
fn renumbered(svg: &str) -> String {
    let (mut seen, mut result): (Vec<&str>, _) = (Vec::new(), String::with_capacity(svg.len()));
    let mut parts = svg.split(CLIP);
    result.push_str(parts.next().unwrap_or_default());
    for part in parts {
        let end = part.find(|c: char| !c.is_ascii_digit()).unwrap_or(part.len());
        let (number, rest) = part.split_at(end);
        let index = seen.iter().position(|known| *known == number).unwrap_or_else(|| {
            seen.push(number);
            seen.len() - 1
        });
        result.push_str(CLIP);
        result.push_str(&index.to_string());
        result.push_str(rest);
    }
    result
}
