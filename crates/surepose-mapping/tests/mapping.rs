//! Wall maps from grids: a synthetic room with known walls, and the shared maps.

#![allow(clippy::expect_used, reason = "tests may panic")]

use surepose_io::grid::{Grid, GridOrigin};
use surepose_io::map_server;
use surepose_mapping::from_grid;
use surepose_testdata::recording;

/// Returns a grid of 5 cm cells that are solid where `solid` returns true for their center \[m].
fn grid(solid: impl Fn(f64, f64) -> bool) -> Grid {
    let (width, height, resolution) = (120, 80, 0.05);
    let middle = |index: usize| (index as f64 + 0.5) * resolution;
    let cells = (0..height).flat_map(|row| (0..width).map(move |column| (middle(column), middle(row))));
    let cells = cells.map(|(x, y)| Some(if solid(x, y) { 1.0 } else { 0.0 })).collect();
    Grid { width, height, resolution, origin: GridOrigin::default(), cells }
}

#[test]
fn a_thick_wall_has_two_faces() {
    let mapped = from_grid::extract_walls(&grid(|x, y| (2.0..2.3).contains(&x) && (1.0..3.0).contains(&y)));
    let upright: Vec<_> = mapped.map.walls.iter().filter(|wall| wall.length() > 1.5).collect();
    assert_eq!(upright.len(), 2, "{:?}", mapped.map);
    for wall in upright {
        // The surface is at the edge of the outermost cells if they are solid, at their center on average if they
        // contain it; the wall is halfway.
        let left = wall.from[0] < 2.15;
        let expected = if left { 2.0125 } else { 2.2875 };
        assert!(wall.from.iter().zip(wall.to).all(|(a, b)| a.is_finite() && b.is_finite()));
        assert!((wall.from[0] - expected).abs() < 0.002 && (wall.to[0] - expected).abs() < 0.002, "{wall:?}");
        assert!((wall.length() - 2.0).abs() < 0.06);
        // Free space is to the right of the direction of a wall, so the left face runs south.
        let northwards = wall.to[1] > wall.from[1];
        assert_eq!(northwards, !left, "{wall:?}");
    }
}

#[test]
fn thin_walls_are_single_and_slanted_walls_have_subcell_accuracy() {
    // The line y = 1 + 0.3 (x − 1), one to two cells thick.
    let off = |x: f64, y: f64| (y - 1.0 - 0.3 * (x - 1.0)) / f64::hypot(1.0, 0.3);
    let mapped = from_grid::extract_walls(&grid(|x, y| (1.0..5.0).contains(&x) && off(x, y).abs() < 0.026));
    let long: Vec<_> = mapped.map.walls.iter().filter(|wall| wall.length() > 3.5).collect();
    assert_eq!(long.len(), 1, "{:?}", mapped.map);
    for [x, y] in [long[0].from, long[0].to] {
        assert!(off(x, y).abs() < 0.01, "{x} {y}: {}", off(x, y));
    }
}

#[test]
fn the_shared_maps_meet_their_measured_figures() {
    // Number of walls, fraction of the surface cells on walls, residual [m]: measured values with a small
    // tolerance.
    for (name, walls, explained, residual) in [
        ("turtlebot3_world", 40..60, 0.95, 0.013),
        ("nav2_tb3_sandbox", 40..60, 0.95, 0.013),
        ("nav2_depot", 150..210, 0.90, 0.015),
        ("aws_small_house_map", 100..140, 0.96, 0.010),
    ] {
        let Some(path) = recording(&format!("maps/{name}.yaml")) else { continue };
        let mapped = from_grid::extract_walls(&map_server::read(&path).expect("a readable map").0);
        println!("{name}: {:?}", mapped.report);
        assert!(walls.contains(&mapped.report.walls), "{name}");
        assert!(mapped.report.explained.is_some_and(|share| share > explained), "{name}");
        assert!(mapped.report.residual_rms_m.is_some_and(|rms| rms < residual), "{name}");
        let text = mapped.map.to_toml(&path).expect("walls that can be written");
        let again = surepose_io::wall_map::parse(&path, text.as_bytes()).expect("walls that can be read");
        assert_eq!(again, mapped.map, "{name}");
    }
}
