use surepose::geometry::{Angle, Body, Map, Pose};

use crate::arena::{Arena, WallSegment};
use crate::random::Seed;

use super::{Clutter, LaserModel};

fn exact(beams: usize) -> LaserModel {
    LaserModel { range_std: 0.0, bearing_std: 0.0, ..LaserModel::half_circle(beams) }
}

fn at(x: f64, y: f64, degrees: f64) -> Pose<Map, Body, f64> {
    Pose::new(x, y, Angle::from_degrees(degrees))
}

#[test]
fn beams_end_at_the_first_wall() {
    let mut noise = Seed(0).stream("laser");
    let scan = exact(181).scan(Arena::loop_world().walls(), at(3.0, 1.0, 90.0), &mut noise);
    // Right: the plate at x = 5.2. Ahead: the plate at y = 2. At ±45°: the far corners.
    let corner = 3.0 * 2f64.sqrt();
    for (beam, range) in [(0, 2.2), (45, corner), (90, 1.0), (135, corner), (180, 3.0)] {
        assert!((scan.ranges[beam] - range).abs() < 1e-9, "beam {beam}: {}", scan.ranges[beam]);
    }
}

#[test]
fn extrinsics_transform_the_scan() {
    let mut noise = Seed(0).stream("laser");
    let laser = LaserModel { body_from_laser: Pose::new(0.2, 0.1, Angle::from_degrees(180.0)), ..exact(181) };
    let scan = laser.scan(Arena::loop_world().walls(), at(1.0, 1.0, 0.0), &mut noise);
    assert!((scan.ranges[90] - 1.2).abs() < 1e-9, "behind the robot: {}", scan.ranges[90]);
    assert!((scan.ranges[180] - 1.1).abs() < 1e-9, "left of the laser, right of the robot");
}

#[test]
fn missing_returns_are_infinite_and_parallel_walls_are_ignored() {
    let mut noise = Seed(0).stream("laser");
    let walls = [WallSegment::between((1.0, 0.0), (2.0, 0.0)), WallSegment::between((9.0, -1.0), (9.0, 1.0))];
    let scan = exact(3).scan(&walls, at(0.0, 0.0, 0.0), &mut noise);
    assert!(scan.ranges.iter().all(|range| *range == f64::INFINITY), "{:?}", scan.ranges);
}

/// A wall at distance d has the range d/cos φ at angle φ from its normal. Range noise and *direction* noise
/// give the variance σ_r² + (d·sin φ/cos²φ)²·σ_φ².
#[test]
fn range_noise_and_direction_noise_add_up() {
    let wall = [WallSegment::between((2.0, -50.0), (2.0, 50.0))];
    let laser = LaserModel { max_range: 1e3, ..LaserModel::half_circle(181) };
    let mut noise = Seed(11).stream("laser");
    let n = 4000;
    let (mut ahead, mut aslant) = (0.0, 0.0);
    let bearing = 60f64.to_radians();
    for _ in 0..n {
        let scan = laser.scan(&wall, at(0.0, 0.0, 0.0), &mut noise);
        ahead += (scan.ranges[90] - 2.0).powi(2);
        aslant += (scan.ranges[150] - 2.0 / bearing.cos()).powi(2);
    }
    let n = f64::from(n);
    let slope = 2.0 * bearing.sin() / bearing.cos().powi(2);
    let four_errors = 4.0 * (2.0 / n).sqrt();
    let expected = 0.03_f64.powi(2) + (slope * 0.25_f64.to_radians()).powi(2);
    assert!((ahead / n / 0.03_f64.powi(2) - 1.0).abs() < four_errors, "{}", (ahead / n).sqrt());
    assert!((aslant / n / expected - 1.0).abs() < four_errors, "{}", (aslant / n).sqrt());
    assert!(expected > 2.0 * 0.03_f64.powi(2), "direction noise must be significant");
}

#[test]
fn clutter_has_the_requested_fraction_and_run_length() {
    let clutter = Clutter { fraction: 0.2, width: 6.0 };
    let laser = LaserModel { clutter, ..exact(361) };
    let walls = Arena::loop_world();
    let mut noise = Seed(5).stream("laser");
    let clean = exact(361).scan(walls.walls(), at(2.0, 1.0, 30.0), &mut noise).ranges;
    let (mut hidden, mut runs, mut beams) = (0, 0, 0);
    for _ in 0..400 {
        let scan = laser.scan(walls.walls(), at(2.0, 1.0, 30.0), &mut noise).ranges;
        let nearer: Vec<bool> = scan.iter().zip(&clean).map(|(seen, wall)| *seen < wall * 0.95).collect();
        beams += nearer.len();
        hidden += nearer.iter().filter(|h| **h).count();
        runs += nearer.windows(2).filter(|pair| !pair[0] && pair[1]).count() + usize::from(nearer[0]);
    }
    let share = hidden as f64 / beams as f64;
    let width = hidden as f64 / runs as f64;
    assert!((share - 0.2).abs() < 0.01, "{share}");
    assert!((width - 6.0).abs() < 0.5, "{width}");
}
