//! A picture that is drawn, and how it becomes a file.

use std::path::Path;

use crate::scene::{Scene, Shape};
use crate::{raster, svg};

/// A picture, ready to be written.
#[derive(Clone, Debug)]
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
        svg::svg(&self.scene)
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

/// One part of a picture, and its size with all labels \[px].
#[derive(Clone, Debug)]
pub struct Cell {
    pub(crate) shapes: Vec<Shape>,
    pub(crate) width: f64,
    pub(crate) height: f64,
}

/// Space between parts, and around all of them \[px].
const GAP: f64 = 8.0;

/// One part on the left, the others below each other on its right.
pub fn beside_column(left: Cell, right: Vec<Cell>) -> Picture {
    let column = below_each_other(right);
    beside(vec![left, column])
}

/// Charts below each other, each over an axis of its own.
pub fn stacked(charts: Vec<Vec<Cell>>) -> Picture {
    below(charts.into_iter().flatten().collect())
}

/// The parts below each other.
pub(crate) fn below(cells: Vec<Cell>) -> Picture {
    finish(below_each_other(cells))
}

/// The parts beside each other.
pub fn beside(cells: Vec<Cell>) -> Picture {
    let height = cells.iter().fold(0.0, |highest: f64, cell| highest.max(cell.height));
    let mut left = 0.0;
    let mut shapes = Vec::new();
    for Cell { shapes: part, width, .. } in cells {
        shapes.push(Shape::Group { at: (left, 0.0), shapes: part });
        left += width + GAP;
    }
    finish(Cell { shapes, width: (left - GAP).max(0.0), height })
}

fn below_each_other(cells: Vec<Cell>) -> Cell {
    let width = cells.iter().fold(0.0, |widest: f64, cell| widest.max(cell.width));
    let mut top = 0.0;
    let mut shapes = Vec::new();
    for Cell { shapes: part, height, .. } in cells {
        shapes.push(Shape::Group { at: (0.0, top), shapes: part });
        top += height + GAP;
    }
    Cell { shapes, width, height: (top - GAP).max(0.0) }
}

fn finish(Cell { shapes, width, height }: Cell) -> Picture {
    let shapes = vec![Shape::Group { at: (GAP, GAP), shapes }];
    Picture { scene: Scene { width: width + 2.0 * GAP, height: height + 2.0 * GAP, shapes } }
}
