//! A picture that is drawn, and how it becomes a file.

use std::path::Path;

use crate::plot::scene::{Scene, Shape};
use crate::plot::{raster, svg};

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
pub struct Subplot {
    pub(crate) shapes: Vec<Shape>,
    pub(crate) width: f64,
    pub(crate) height: f64,
}

/// Space between parts, and around all of them \[px].
const GAP: f64 = 8.0;

/// One part on the left, the others below each other on its right.
pub fn hstack_column(left: Subplot, right: Vec<Subplot>) -> Picture {
    let column = below_each_other(right);
    hstack(vec![left, column])
}

/// Charts below each other, each over an axis of its own.
pub fn vstack(charts: Vec<Vec<Subplot>>) -> Picture {
    vstack_cells(charts.into_iter().flatten().collect())
}

/// The parts below each other.
pub(crate) fn vstack_cells(cells: Vec<Subplot>) -> Picture {
    finish(below_each_other(cells))
}

/// The parts beside each other.
pub fn hstack(cells: Vec<Subplot>) -> Picture {
    let height = cells.iter().fold(0.0, |highest: f64, cell| highest.max(cell.height));
    let mut left = 0.0;
    let mut shapes = Vec::new();
    for Subplot { shapes: part, width, .. } in cells {
        shapes.push(Shape::Group { at: (left, 0.0), shapes: part });
        left += width + GAP;
    }
    finish(Subplot { shapes, width: (left - GAP).max(0.0), height })
}

fn below_each_other(cells: Vec<Subplot>) -> Subplot {
    let width = cells.iter().fold(0.0, |widest: f64, cell| widest.max(cell.width));
    let mut top = 0.0;
    let mut shapes = Vec::new();
    for Subplot { shapes: part, height, .. } in cells {
        shapes.push(Shape::Group { at: (0.0, top), shapes: part });
        top += height + GAP;
    }
    Subplot { shapes, width, height: (top - GAP).max(0.0) }
}

fn finish(Subplot { shapes, width, height }: Subplot) -> Picture {
    let shapes = vec![Shape::Group { at: (GAP, GAP), shapes }];
    Picture { scene: Scene { width: width + 2.0 * GAP, height: height + 2.0 * GAP, shapes } }
}
