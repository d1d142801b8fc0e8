//! A finished picture and its output formats.

use std::path::Path;

use crate::plot::scene::{Scene, Shape};
use crate::plot::{raster, svg};

/// A picture, ready for output.
#[derive(Clone, Debug)]
pub struct Picture {
    scene: Scene,
}

/// Error of the output of a picture.
#[derive(Debug, thiserror::Error)]
pub enum PlotError {
    /// The file cannot be written.
    #[error(transparent)]
    Write(#[from] std::io::Error),
    /// The image does not fit into memory or into a PNG.
    #[error("picture: rendering as PNG failed: {0}")]
    Raster(String),
}

impl Picture {
    /// Renders the picture as SVG.
    pub fn svg(&self) -> String {
        svg::svg(&self.scene)
    }

    /// Renders the picture as PNG.
    ///
    /// # Errors
    /// [`PlotError::Raster`] if the image is too large.
    pub fn png(&self) -> Result<Vec<u8>, PlotError> {
        raster::png(&self.scene).map_err(PlotError::Raster)
    }

    /// Writes `folder/name.svg` and `folder/name.png`.
    ///
    /// # Errors
    /// [`PlotError`] if a file cannot be written or the image is too large.
    pub fn save(&self, folder: &Path, name: &str) -> Result<(), PlotError> {
        std::fs::write(folder.join(format!("{name}.svg")), self.svg())?;
        std::fs::write(folder.join(format!("{name}.png")), self.png()?)?;
        Ok(())
    }
}

/// One part of a picture and its size including labels \[px].
#[derive(Clone, Debug)]
pub struct Subplot {
    pub(crate) shapes: Vec<Shape>,
    pub(crate) width: f64,
    pub(crate) height: f64,
}

/// Gap between subplots and around the picture \[px].
const GAP: f64 = 8.0;

/// Arranges one subplot on the left and a column of subplots on the right.
pub fn hstack_column(left: Subplot, right: Vec<Subplot>) -> Picture {
    let column = column(right);
    hstack(vec![left, column])
}

/// Arranges charts in a column, each with its own axis.
pub fn vstack(charts: Vec<Vec<Subplot>>) -> Picture {
    vstack_cells(charts.into_iter().flatten().collect())
}

/// Arranges subplots in a column.
pub(crate) fn vstack_cells(cells: Vec<Subplot>) -> Picture {
    finish(column(cells))
}

/// Arranges subplots in a row.
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

/// Arranges subplots in a column, as one subplot.
pub fn column(cells: Vec<Subplot>) -> Subplot {
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
