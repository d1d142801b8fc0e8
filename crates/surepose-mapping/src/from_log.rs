//! Extraction of walls from laser scans at known poses.

use std::collections::BTreeMap;

use surepose::geometry::{Body, Frame, Map, Point, Pose};
use surepose_io::recording::{ScanRecord, laser_extrinsics};
use surepose_io::wall_map::WallMap;

use super::fit_walls::{FittedWall, WallFitSettings, fit_walls};
use super::point_cloud::{PointCloud, SurfacePoint};
use super::{MapReport, MappingResult};

/// Settings of the extraction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LogMappingSettings {
    /// Thresholds of the wall fit.
    pub rules: WallFitSettings,
    /// Maximum range of a return \[m]; points beyond are too far apart for a line.
    pub range_max: f64,
    /// Radius of the normal estimation \[m].
    pub normal_reach: f64,
    /// Standard deviation of a point across its wall \[m].
    pub point_std: f64,
    /// Standard deviation of a scan's position, along each axis \[m].
    pub position_std: f64,
    /// Standard deviation of a scan's heading \[rad].
    pub heading_std: f64,
}

impl Default for LogMappingSettings {
    fn default() -> Self {
        Self {
            rules: WallFitSettings {
                tolerance: 0.06,
                growth_tolerance: 0.06,
                claim: 0.0,
                recess: f64::INFINITY,
                gap: 0.35,
                shortest: 0.2,
                long: 0.2,
                fewest: 8,
                alignment: 0.7,
            },
            range_max: 20.0,
            normal_reach: 0.15,
            point_std: 0.02,
            position_std: 0.02,
            heading_std: 0.25_f64.to_radians(),
        }
    }
}

/// Side of the search cells \[m]; the maximum of `normal_reach`.
const CELL: f64 = 0.25;

/// Extracts the walls from scans at their poses.
pub fn extract_walls<'a>(
    views: impl IntoIterator<Item = (&'a ScanRecord, Pose<Map, Body, f64>)>,
    settings: &LogMappingSettings,
) -> MappingResult {
    let mut points = Vec::new();
    let mut seen_from = Vec::new();
    for (view, (scan, map_from_body)) in (0_u32..).zip(views) {
        let map_from_laser = map_from_body * laser_extrinsics(scan.mount);
        seen_from.push((map_from_laser.x, map_from_laser.y));
        for end in ends(scan, map_from_laser, settings) {
            let normal = (0.0, 0.0);
            let roughness = f64::INFINITY;
            points.push(SurfacePoint { x: end.x, y: end.y, normal, both_sides: false, roughness, view });
        }
    }
    let mut cloud = PointCloud::new(points, CELL);
    cloud.estimate_normals(&seen_from, settings.normal_reach.min(CELL), 4);
    let grown = fit_walls(&cloud, &settings.rules);
    let to_map_wall = grown.iter().map(|wall| {
        let line_covariance = line_covariance(wall, &cloud, &seen_from, settings);
        wall.to_map_wall(wall.extent, |at| at, line_covariance)
    });
    let map = WallMap { name: None, walls: to_map_wall.collect() };
    let report = MapReport::from_fit(&map, &grown, cloud.points().len());
    MappingResult { map, report }
}

/// Returns the end points of the beams that are used for walls \[m].
pub fn beam_endpoints<'a>(
    views: impl IntoIterator<Item = (&'a ScanRecord, Pose<Map, Body, f64>)>,
    settings: &LogMappingSettings,
) -> Vec<(f64, f64)> {
    let mut found = Vec::new();
    for (scan, map_from_body) in views {
        found.extend(
            ends(scan, map_from_body * laser_extrinsics(scan.mount), settings).map(|end| (end.x, end.y)),
        );
    }
    found
}

/// Returns the end points of a scan's beams within the maximum range.
fn ends<F: Frame>(
    scan: &ScanRecord,
    map_from_laser: Pose<Map, F, f64>,
    settings: &LogMappingSettings,
) -> impl Iterator<Item = Point<Map, f64>> {
    let near = scan.ranges.iter().enumerate().filter(|(_, range)| **range <= settings.range_max);
    near.map(move |(beam, &range)| {
        let bearing = scan.angle(beam);
        map_from_laser * Point::new(range * libm::cos(bearing), range * libm::sin(bearing))
    })
}

/// Returns the variance of a wall's offset o \[m²], its covariance with the slope s \[m], and the variance of
/// s, at the centroid.
///
/// The fit is (o, s)ᵀ = B·Σ(1, aᵢ)ᵀeᵢ with B = (Σ(1, aᵢ)ᵀ(1, aᵢ))⁻¹, where aᵢ is the coordinate along the
/// wall from its centroid. The error eᵢ has the noise of the point and the pose error of the scan, which all
/// its points share. The pose error is a shift δ across the wall and a turn ϑ about the laser, whose foot on
/// the line is at a₀: e = δ + (aᵢ − a₀)ϑ. So Cov(o, s) = B·M·B with M = σ²B⁻¹ + Σ_scans (σ_δ²ddᵀ + σ_ϑ²ttᵀ),
/// d = Σ(1, aᵢ)ᵀ, t = Σ(1, aᵢ)ᵀ(aᵢ − a₀).
fn line_covariance(
    wall: &FittedWall,
    cloud: &PointCloud,
    seen_from: &[(f64, f64)],
    settings: &LogMappingSettings,
) -> [f64; 3] {
    // For each view: number of points, Σa, Σa².
    let mut views: BTreeMap<u32, [f64; 3]> = BTreeMap::new();
    for point in wall.members.iter().filter_map(|&number| cloud.points().get(number as usize)) {
        let a = wall.along(point.x, point.y);
        let sums = views.entry(point.view).or_default();
        *sums = [sums[0] + 1.0, sums[1] + a, sums[2] + a * a];
    }
    let total = views.values().fold([0.0; 3], |t, s| [t[0] + s[0], t[1] + s[1], t[2] + s[2]]);
    // M, and below B, as (first diagonal entry, off-diagonal entry, second diagonal entry).
    let mut m = total.map(|sum| sum * settings.point_std * settings.point_std);
    let mut add = |[u, v]: [f64; 2], std: f64| {
        m = [m[0] + std * std * u * u, m[1] + std * std * u * v, m[2] + std * std * v * v];
    };
    for (view, [n, a, aa]) in &views {
        let foot = seen_from.get(*view as usize).map_or(0.0, |&(x, y)| wall.along(x, y));
        add([*n, *a], settings.position_std);
        add([a - foot * n, aa - foot * a], settings.heading_std);
    }
    let [n, a, aa] = total;
    let scale = 1.0 / (n * aa - a * a);
    let b = [aa * scale, -a * scale, n * scale];
    let sandwiched = |u: [f64; 2], v: [f64; 2]| {
        m[0] * u[0] * v[0] + m[1] * (u[0] * v[1] + u[1] * v[0]) + m[2] * u[1] * v[1]
    };
    let (first, second) = ([b[0], b[1]], [b[1], b[2]]);
    [sandwiched(first, first), sandwiched(first, second), sandwiched(second, second)]
}
