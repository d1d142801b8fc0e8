use std::f64::consts::FRAC_PI_2;

use super::{Grid, GridOrigin, SparseGrid};

fn turned() -> Grid {
    Grid {
        width: 2,
        height: 3,
        resolution: 0.5,
        origin: GridOrigin { x: 10.0, y: 20.0, heading: FRAC_PI_2 },
        cells: vec![None, Some(0.0), Some(0.25), Some(0.5), Some(0.75), Some(1.0)],
    }
}

#[test]
fn cells_are_stored_row_by_row_from_the_origin() {
    let grid = turned();
    assert_eq!(grid.occupancy(0, 0), None);
    assert_eq!(grid.occupancy(1, 0), Some(0.0));
    assert_eq!(grid.occupancy(1, 2), Some(1.0));
    assert_eq!((grid.occupancy(2, 0), grid.occupancy(0, 3)), (None, None));
    assert_eq!(grid.occupancy(1, usize::MAX), None);
}

#[test]
fn origin_heading_rotates_the_grid() {
    let (x, y) = turned().center(1, 2);
    assert!((x - 8.75).abs() + (y - 20.75).abs() < 1e-12, "{x}, {y}");
}

#[test]
fn cell_at_inverts_center() {
    let grid = turned();
    for (column, row) in (0..2).flat_map(|column| (0..3).map(move |row| (column, row))) {
        let (x, y) = grid.center(column, row);
        assert_eq!(grid.cell_at(x, y), Some((column, row)));
    }
}

#[test]
fn points_outside_have_no_cell() {
    let grid = turned();
    for (x, y) in
        [(10.1, 20.1), (9.9, 19.9), (9.9, 21.1), (8.4, 20.1), (f64::NAN, 20.5), (f64::INFINITY, 20.0)]
    {
        assert_eq!(grid.cell_at(x, y), None, "{x}, {y}");
    }
}

#[test]
fn grids_without_walls_or_room_are_sparse() {
    let grid = |cells: Vec<Option<f32>>| Grid {
        width: 10,
        height: cells.len() / 10,
        resolution: 0.05,
        origin: GridOrigin::default(),
        cells,
    };
    let mixed = |solid: usize, free: usize| {
        let mut cells = vec![Some(1.0); solid];
        cells.extend(vec![Some(0.0); free]);
        cells.resize(100, None);
        grid(cells).sparseness()
    };
    assert_eq!(mixed(20, 60), None);
    assert_eq!(mixed(0, 60), Some(SparseGrid::NothingSolid { free: 60, unknown: 40 }));
    assert_eq!(mixed(30, 0), Some(SparseGrid::NothingFree { solid: 30, unknown: 70 }));
    assert_eq!(mixed(70, 30), Some(SparseGrid::MostlySolid { solid: 70 }));
    // Unknown cells around the known ones do not count.
    assert_eq!(mixed(2, 5), None);
    let mut cells = vec![None; 400];
    (cells[0], cells[399]) = (Some(1.0), Some(0.0));
    assert_eq!(grid(cells).sparseness(), Some(SparseGrid::MostlyUnknown { unknown: 99 }));
    let message = SparseGrid::NothingSolid { free: 60, unknown: 40 }.to_string();
    assert_eq!(message, "no cell is occupied (60 % are free, 40 % unknown)");
    assert_eq!(grid(vec![]).sparseness(), Some(SparseGrid::NothingSolid { free: 0, unknown: 0 }));
}
