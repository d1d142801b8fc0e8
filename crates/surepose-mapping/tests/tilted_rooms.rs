//! Walls of rooms at any angle to the raster: one wall each, at its true angle, with a covariance that holds.

#![allow(clippy::expect_used, reason = "tests may panic")]

mod common;

use common::{Raster, Segment, room};
use surepose_io::wall_map::{MapWall, WallMap};
use surepose_mapping::from_grid;
use surepose_sim::Seed;

/// Tilts of the room against the raster \[°]; near 0, 26.57 and 45° the cells repeat one pattern.
const TILTS: [f64; 13] = [0.0, 0.25, 0.5, 1.0, 2.0, 3.0, 5.0, 10.0, 17.0, 26.57, 30.0, 40.0, 45.0];

/// Cell sides \[m].
const RESOLUTIONS: [f64; 3] = [0.02, 0.05, 0.1];

/// Error of a traced wall.
#[derive(Debug)]
struct WallError {
    /// Number of the true wall.
    of: usize,
    length: f64,
    /// Distance of its middle from the true line \[m], and its standard deviation.
    offset: [f64; 2],
    /// Angle to the true line \[rad], and its standard deviation.
    angle: [f64; 2],
}

/// Compares a wall with the nearest true one.
fn error_of(wall: &MapWall, truth: &[Segment]) -> WallError {
    let [(x0, y0), (x1, y1)] = [wall.from, wall.to].map(|[x, y]| (x, y));
    let length = wall.length();
    let (tx, ty) = ((x1 - x0) / length, (y1 - y0) / length);
    let middle = (0.5 * (x0 + x1), 0.5 * (y0 + y1));
    let relative = |segment: &Segment| {
        let [(ax, ay), (bx, by)] = *segment;
        let long = (bx - ax).hypot(by - ay);
        let (ux, uy) = ((bx - ax) / long, (by - ay) / long);
        let (dx, dy) = (middle.0 - ax, middle.1 - ay);
        let along = dx * ux + dy * uy;
        let beyond = (-along).max(along - long).max(0.0);
        (dx * uy - dy * ux, (ux * ty - uy * tx).clamp(-1.0, 1.0).asin(), beyond)
    };
    let cost = |(offset, angle, beyond): (f64, f64, f64)| offset.abs() + beyond + angle.abs();
    let nearest =
        (0..truth.len()).min_by(|&a, &b| cost(relative(&truth[a])).total_cmp(&cost(relative(&truth[b]))));
    let of = nearest.expect("a true wall");
    let (offset, angle, _) = relative(&truth[of]);
    // The coordinate of the middle along the wall, from the foot of the origin; the normal is to the right.
    let b = middle.0 * tx + middle.1 * ty;
    let covariance = wall.covariance.expect("a traced wall has a covariance");
    let variance = covariance.r_r - 2.0 * b * covariance.r_psi + b * b * covariance.psi_psi;
    WallError { of, length, offset: [offset, variance.sqrt()], angle: [angle, covariance.psi_psi.sqrt()] }
}

fn trace(raster: &Raster, truth: &[Segment]) -> (WallMap, Vec<WallError>) {
    let traced = from_grid::extract_walls(&raster.draw(truth));
    assert!(traced.report.explained.is_some_and(|part| part <= 1.0), "{:?}", traced.report);
    let map = traced.map;
    let errors = map.walls.iter().map(|wall| error_of(wall, truth)).collect();
    (map, errors)
}

/// Mean of the squared ratios of errors and standard deviations.
fn mean_chi2<'a>(errors: impl IntoIterator<Item = &'a [f64; 2]>) -> f64 {
    let ratios: Vec<f64> = errors.into_iter().map(|[error, std]| (error / std).powi(2)).collect();
    ratios.iter().sum::<f64>() / ratios.len() as f64
}

#[test]
fn walls_at_any_angle_are_single_with_a_covariance_that_holds() {
    println!("cell   tilt  walls  angle max  offset rms   max  χ² offset  angle   max");
    for resolution in RESOLUTIONS {
        for tilt in TILTS {
            let mut errors = Vec::new();
            for seed in 0..6 {
                let mut random = Seed(seed).stream("raster");
                let truth = room(tilt.to_radians());
                let raster = Raster::random(&mut random, tilt.to_radians(), resolution);
                let (map, found) = trace(&raster, &truth);
                // One wall for each: twice the same true wall, or a wall of a corner's cells, is too many.
                let mut of: Vec<usize> = found.iter().map(|error| error.of).collect();
                of.sort_unstable();
                assert_eq!(of, [0, 1, 2, 3, 4, 5], "{resolution} {tilt} {seed}: {map:?}");
                errors.extend(found);
            }
            let offsets = || errors.iter().map(|error| &error.offset);
            let angles = || errors.iter().map(|error| &error.angle);
            let long = errors.iter().filter(|error| error.length > 3.0);
            let worst_angle = long.map(|error| error.angle[0].abs().to_degrees()).fold(0.0, f64::max);
            let rms = (offsets().map(|[error, _]| error * error).sum::<f64>() / errors.len() as f64).sqrt();
            let largest = offsets().map(|[error, _]| error.abs()).fold(0.0, f64::max);
            let each = || offsets().chain(angles()).map(|[error, std]| (error / std).powi(2));
            let worst = each().fold(0.0, f64::max);
            let (offset, angle) = (mean_chi2(offsets()), mean_chi2(angles()));
            println!(
                "{resolution:4.2} {tilt:6.2}      6 {worst_angle:9.3}° {:9.2} {:6.2} mm {offset:8.2} {angle:6.2} {worst:5.1}",
                1e3 * rms,
                1e3 * largest
            );
            // A line through n cells turns by up to 1.5 cells over its length.
            assert!(
                worst_angle < (1.5 * resolution / 4.0).to_degrees(),
                "{resolution} {tilt}: {worst_angle}°"
            );
            assert!(largest < 0.5 * resolution, "{resolution} {tilt}: {largest} m");
            assert!(offset < 2.5 && angle < 1.5, "{resolution} {tilt}: χ² {offset} {angle}");
            assert!(worst < 12.0, "{resolution} {tilt}: χ² {worst}");
        }
    }
}

/// A mapper's laser marks cells next to the right one, leaves some out, and sees through the wall here and there.
#[test]
fn noisy_cells_leave_walls_whole() {
    for (seed, tilt) in (0..6).flat_map(|seed| [0.0, 1.0, 4.0, 20.0, 45.0].map(|tilt| (seed, tilt))) {
        let mut random = Seed(seed).stream("raster");
        let truth = room(f64::to_radians(tilt));
        let noise = 0.015;
        let raster = Raster { noise, dropout: 0.05, ..Raster::random(&mut random, tilt.to_radians(), 0.05) };
        let (map, errors) = trace(&raster, &truth);
        assert!(errors.len() <= 9, "{tilt} {seed}: {} walls: {map:?}", errors.len());
        for wall in 0..6 {
            let longest =
                errors.iter().filter(|error| error.of == wall).max_by(|a, b| a.length.total_cmp(&b.length));
            let error = longest.expect("every wall is found");
            assert!(error.offset[0].abs() < 3.0 * error.offset[1], "{tilt} {seed}: {error:?}");
            assert!(error.angle[0].abs() < 3.5 * error.angle[1], "{tilt} {seed}: {error:?}");
        }
    }
}

/// A partition of 12 cm has two faces in a map of 5 cm cells, a plate has one that is visible from both sides.
#[test]
fn thick_partitions_have_two_faces() {
    for tilt in [0.0, 2.0, 15.0, 35.0, 45.0_f64] {
        let mut random = Seed(3).stream("raster");
        let hidden = [(-1.0, 0.0), (1.0, 0.12)];
        let raster = Raster { hidden, ..Raster::random(&mut random, tilt.to_radians(), 0.05) };
        let mut truth = room(tilt.to_radians());
        let (sin, cos) = tilt.to_radians().sin_cos();
        let turned = |(x, y): (f64, f64)| (cos * x - sin * y, sin * x + cos * y);
        let face = |y: f64| [turned((-1.0, y)), turned((1.0, y))];
        truth.truncate(4);
        let end = |x: f64| [turned((x, 0.0)), turned((x, 0.12))];
        truth.extend([face(0.0), face(0.12), end(-1.0), end(1.0)]);
        let (map, errors) = trace(&raster, &truth);
        for wall in [4, 5] {
            let of = errors.iter().filter(|error| error.of == wall && error.length > 1.5).count();
            assert_eq!(of, 1, "{tilt}: {map:?}");
        }
        for error in &errors {
            assert!(error.offset[0].abs() < 3.0 * error.offset[1], "{tilt}: {error:?}");
        }
    }
}
