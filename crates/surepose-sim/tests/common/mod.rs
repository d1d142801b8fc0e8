//! Shared helpers of the line tests: core types from simulated scans, and true errors.

use surepose::geometry::{Angle, Body, Map, Point, Pose};
use surepose::lidar::{ExtractedLine, LineExtractor, RangeFinder, Scan};
use surepose::map::Wall;
use surepose_sim::{LaserModel, WallSegment};

pub(crate) type MapPose = Pose<Map, Body, f64>;

pub(crate) fn at(x: f64, y: f64, degrees: f64) -> MapPose {
    Pose::new(x, y, Angle::from_degrees(degrees))
}

pub(crate) fn range_finder(laser: &LaserModel) -> RangeFinder<f64> {
    RangeFinder {
        body_from_laser: laser.body_from_laser,
        range_std: laser.range_std,
        bearing_std: laser.bearing_std,
        range_min: 0.0,
        range_max: laser.max_range,
    }
}

fn view(scan: &surepose_sim::SimulatedScan) -> Scan<'_, f64> {
    Scan::new(Angle::from_radians(scan.angle_min), scan.angle_increment, &scan.ranges)
}

pub(crate) fn lines(laser: &LaserModel, scan: &surepose_sim::SimulatedScan) -> Vec<ExtractedLine<f64>> {
    let mut extractor = Box::<LineExtractor<f64, 1024>>::default();
    extractor.extract(&range_finder(laser), &view(scan)).unwrap().lines.to_vec()
}

/// Error (r, ψ) of a line, and its normalized square.
pub(crate) fn error(
    line: &ExtractedLine<f64>,
    wall: &Wall<f64>,
    map_from_laser: Pose<Map, surepose::geometry::Laser, f64>,
) -> ([f64; 2], f64) {
    let right = map_from_laser.inverse() * *wall.line();
    let behind = right.distance < 0.0;
    let turned = line.line.direction - right.direction;
    let direction = if behind { turned + Angle::half_turn() } else { turned }.radians();
    let distance = line.line.distance - right.distance.abs();
    let (v, w, c) = (line.distance_variance, line.direction_variance, line.covariance);
    let squared = w * distance * distance - 2.0 * c * distance * direction + v * direction * direction;
    ([distance, direction], squared / (v * w - c * c))
}

pub(crate) fn wall(a: (f64, f64), b: (f64, f64)) -> (WallSegment, Wall<f64>) {
    (WallSegment::between(a, b), Wall::between(Point::new(a.0, a.1), Point::new(b.0, b.1)).unwrap())
}

/// Four standard errors of the mean of 2000 numbers with variance 4.
pub(crate) const NEES_BAND: f64 = 4.0 * 2.0 / 44.7;
