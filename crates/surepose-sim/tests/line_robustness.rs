//! Line extraction from impaired scans: clutter, legs, sectors without returns, and invalid values.

#![allow(clippy::unwrap_used, reason = "test helpers may panic")]

mod common;

use common::{NEES_BAND, at, error, lines, range_finder, wall};
use surepose::geometry::{Angle, Map, Point, Pose};
use surepose::lidar::{LineExtractor, RangeFinder, Scan, ScanError};
use surepose_sim::{Clutter, LaserModel, Seed, WallSegment};

/// A plain outlier gate biases the wall by several standard errors; the mixture model does not.
#[test]
fn clutter_does_not_bias_wall_distances() {
    let laser = LaserModel { clutter: Clutter { fraction: 0.2, width: 1.0 }, ..LaserModel::half_circle(181) };
    let (segment, wall) = wall((1.0, -3.0), (1.0, 3.0));
    let mut noise = Seed(3).stream("laser");
    let (mut sum, mut variance, mut count) = (0.0, 0.0, 0.0);
    for _ in 0..1000 {
        let scan = laser.scan(&[segment], at(0.0, 0.0, 0.0), &mut noise);
        for line in lines(&laser, &scan).iter().filter(|line| line.beams > 60) {
            sum += error(line, &wall, at(0.0, 0.0, 0.0) * laser.body_from_laser).0[0];
            variance += line.distance_variance;
            count += 1.0;
        }
    }
    assert!(count > 950.0, "{count}");
    let (bias, std) = (sum / count, (variance / count).sqrt());
    assert!(bias.abs() < 0.35 * std, "bias {bias} m, standard deviation of one scan {std} m");
}

/// Legs are cylinders of 6 cm and 10 cm radius; they give no lines and do not bias the wall behind them.
#[test]
fn legs_are_not_extracted_as_walls() {
    let laser = LaserModel::half_circle(361);
    let place = at(0.0, 0.0, 0.0);
    let (back, wall) = wall((3.0, -2.5), (3.0, 2.5));
    let mut noise = Seed(11).stream("laser");
    let (mut on_legs, mut nees, mut count) = (0, 0.0, 0.0);
    for _ in 0..500 {
        let mut world = vec![back];
        for (radius, distance) in [(0.06, 0.8), (0.06, 1.5), (0.1, 1.2), (0.1, 2.2)] {
            let bearing = noise.uniform(-0.7, 0.7);
            world.extend(round(at(0.0, 0.0, bearing.to_degrees()) * Point::new(distance, 0.0), radius));
        }
        let scan = laser.scan(&world, place, &mut noise);
        for line in &lines(&laser, &scan) {
            let squared = error(line, &wall, place * laser.body_from_laser).1;
            if squared < 25.0 {
                nees += squared;
                count += 1.0;
            } else {
                on_legs += 1;
            }
        }
    }
    assert!(on_legs <= 10, "{on_legs} lines on 2000 legs");
    assert!(count > 490.0 && nees / count < 2.5, "NEES {} over {count}", nees / count);
}

/// Polygon with 24 sides, which approximates a circle around `center`.
fn round(center: Point<Map, f64>, radius: f64) -> Vec<WallSegment> {
    let corner = |k: u32| at(center.x, center.y, 15.0 * f64::from(k)) * Point::new(radius, 0.0);
    (0..24).map(|k| WallSegment { start: corner(k), end: corner(k + 1) }).collect()
}

/// Some lasers report a missing return as the maximum range or as 0; a window removes a whole sector.
#[test]
fn sector_without_returns_does_not_bias_the_wall() {
    let laser = LaserModel::half_circle(361);
    let place = at(0.0, 0.0, 0.0);
    let (segment, wall) = wall((2.0, -3.0), (2.0, 3.0));
    let mut noise = Seed(12).stream("laser");
    for nothing in [f64::INFINITY, f64::NAN, 0.0, -1.0, 8.191, 81.91] {
        let (mut nees, mut count) = (0.0, 0.0);
        for _ in 0..300 {
            let mut scan = laser.scan(&[segment], place, &mut noise);
            for range in scan.ranges.iter_mut().filter(|range| range.is_infinite()) {
                *range = nothing;
            }
            scan.ranges[165..210].fill(nothing);
            let lines = lines(&laser, &scan);
            // In about one of 1000 scans, the two pieces are too far apart to merge.
            if lines.len() != 1 {
                continue;
            }
            assert!(lines[0].extent.0 < -2.5 && lines[0].extent.1 > 2.5, "{nothing}: {lines:?}");
            nees += error(&lines[0], &wall, place * laser.body_from_laser).1;
            count += 1.0;
        }
        assert!(count >= 297.0, "{nothing}: one line in {count} of 300 scans");
        assert!((nees / count - 2.0).abs() < NEES_BAND * 2.6, "{nothing}: {}", nees / count);
    }
}

#[test]
fn invalid_scans_give_errors_or_valid_lines() {
    let laser = range_finder(&LaserModel::half_circle(181));
    let mut extractor = LineExtractor::<f64, 8>::new();
    let scan =
        |first: f64, step: f64, ranges: &'static [f64]| Scan::new(Angle::from_radians(first), step, ranges);
    let mut refusal = |laser: &RangeFinder<f64>, scan: Scan<'_, f64>| extractor.extract(laser, &scan).err();
    for (first, step) in [(f64::NAN, 0.1), (0.0, 0.0), (0.0, f64::INFINITY), (0.0, f64::NAN), (0.0, 2.0)] {
        assert_eq!(refusal(&laser, scan(first, step, &[1.0; 4])), Some(ScanError::InvalidAngles));
    }
    assert_eq!(refusal(&laser, scan(0.0, 0.01, &[1.0; 9])), Some(ScanError::TooManyBeams));
    for bad in [
        RangeFinder { range_std: 0.0, ..laser },
        RangeFinder { bearing_std: f64::NAN, ..laser },
        RangeFinder { range_min: -1.0, ..laser },
        RangeFinder { range_max: 0.0, ..laser },
        RangeFinder { body_from_laser: Pose::new(f64::NAN, 0.0, Angle::zero()), ..laser },
    ] {
        assert_eq!(refusal(&bad, scan(0.0, 0.01, &[1.0; 4])), Some(ScanError::InvalidLaser));
    }
    let nothing: &[f64] = &[f64::NAN, f64::INFINITY, -1.0, 0.0, f64::NEG_INFINITY, 1e300, 1e-300, f64::NAN];
    for ranges in [&[], nothing, &[1.0; 8]] {
        let seen = extractor.extract(&laser, &scan(0.0, 0.01, ranges)).unwrap();
        assert!(seen.lines.iter().all(|line| line.distance_variance > 0.0));
    }
}

/// Arbitrary ranges give finite lines with positive definite covariances, also in `f32`.
#[test]
fn random_ranges_give_valid_lines() {
    let mut noise = Seed(8).stream("laser");
    let mut extractor = Box::<LineExtractor<f32, 361>>::default();
    let laser: RangeFinder<f32> = RangeFinder {
        body_from_laser: Pose::identity(),
        range_std: 0.03,
        bearing_std: 0.0044,
        range_min: 0.0,
        range_max: 1e4,
    };
    for round in 0..300 {
        let scale = 10_f64.powi(round % 9 - 4);
        let ranges: Vec<f32> = (0..361).map(|_| (noise.uniform(-0.1, 1.0) * scale) as f32).collect();
        let scan = Scan::new(Angle::from_radians(-1.5), 0.0087, &ranges);
        for line in extractor.extract(&laser, &scan).unwrap().lines {
            let (v, w, c) = (line.distance_variance, line.direction_variance, line.covariance);
            assert!(v.is_finite() && w.is_finite() && v > 0.0 && w > 0.0 && c * c < v * w, "{line:?}");
            assert!(line.line.distance.is_finite() && line.extent.0 < line.extent.1, "{line:?}");
        }
    }
}
