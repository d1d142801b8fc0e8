//! Fit of straight walls to surface points.

use surepose_io::wall_map::{MapWall, WallCovariance};

use super::point_cloud::{PointCloud, PointMoments, SurfacePoint};

/// Thresholds of the wall fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallFitSettings {
    /// Maximum distance of a point from its wall's line \[m].
    pub tolerance: f64,
    /// Maximum distance while the wall grows from its first points, whose direction is inaccurate \[m]; at least `tolerance`.
    pub growth_tolerance: f64,
    /// Distance from a long wall within which points belong to no other wall \[m]; 0 for the members alone.
    pub claim: f64,
    /// Distance from the line beyond which successive points are a recess or a bump, not the wall \[m]; ∞ for none.
    pub recess: f64,
    /// Length without points that ends a wall \[m].
    pub gap: f64,
    /// Minimum length of a wall \[m].
    pub shortest: f64,
    /// Length of the walls that are fitted before all shorter ones \[m]; at least `shortest`.
    pub long: f64,
    /// Minimum number of points of a wall.
    pub fewest: usize,
    /// Cosine of the maximum angle between the normals of a point and of its wall.
    pub alignment: f64,
}

/// A wall with its points.
#[derive(Clone, Debug)]
pub struct FittedWall {
    /// Centroid of the points.
    pub middle: (f64, f64),
    /// Unit normal, towards free space.
    pub normal: (f64, f64),
    /// Start and end, measured to the left of the normal from the centroid \[m].
    pub extent: (f64, f64),
    /// Indices of the points.
    pub members: Vec<u32>,
    /// Sum of the squared distances of the points from the line \[m²].
    pub residual_sum_of_squares: f64,
}

impl FittedWall {
    /// Returns the coordinate of a point along the wall, to the left of the normal from the centroid \[m].
    pub fn along(&self, x: f64, y: f64) -> f64 {
        (y - self.middle.1) * self.normal.0 - (x - self.middle.0) * self.normal.1
    }

    /// Converts the wall over `extent` to the file format, in the frame into which `place` maps points.
    ///
    /// `line_covariance` is that of the offset o at the centroid and of the slope s, in the file's frame:
    /// variance \[m²], covariance \[m], variance. The file stores that of (r, ψ). The normal turns by −s. The
    /// distance r of the line from the map's origin changes by o + s·b, where b is the coordinate along the
    /// wall of the foot of the origin.
    pub fn to_map_wall(
        &self,
        extent: (f64, f64),
        place: impl Fn([f64; 2]) -> [f64; 2],
        line_covariance: [f64; 3],
    ) -> MapWall {
        let end = |a: f64| place([self.middle.0 - a * self.normal.1, self.middle.1 + a * self.normal.0]);
        let (from, to) = (end(extent.0), end(extent.1));
        let length = libm::hypot(to[0] - from[0], to[1] - from[1]);
        let [x, y] = place([self.middle.0, self.middle.1]);
        let b = -(x * (to[0] - from[0]) + y * (to[1] - from[1])) / length;
        let [oo, os, ss] = line_covariance;
        let covariance =
            WallCovariance { r_r: oo + 2.0 * b * os + b * b * ss, r_psi: -(os + b * ss), psi_psi: ss };
        MapWall { name: None, from, to, covariance: Some(covariance) }
    }
}

/// Maximum number of alternations between selection of points and fit of the line.
const ROUNDS: usize = 10;

/// Maximum number of alternations while a wall grows; its length at least doubles in most of them.
const GROWTH_ROUNDS: usize = 40;

/// Extracts the walls of `cloud`: first the long ones, each time starting with the smoothest points.
///
/// From the smoothest free point, a line is followed in both directions while it has points whose normals
/// agree. The line is refitted and followed again until it no longer changes. Each point belongs to at most
/// one wall.
pub fn fit_walls(cloud: &PointCloud, rules: &WallFitSettings) -> Vec<FittedWall> {
    let mut order: Vec<u32> = (0..cloud.points().len() as u32).collect();
    let roughness =
        |number: &u32| cloud.points().get(*number as usize).map_or(f64::INFINITY, |p| p.roughness);
    order.retain(|number| roughness(number).is_finite());
    order.sort_by(|a, b| roughness(a).total_cmp(&roughness(b)));
    let mut free = vec![true; cloud.points().len()];
    let mut walls = Vec::new();
    if rules.long > rules.shortest {
        let long = WallFitSettings { shortest: rules.long, ..*rules };
        fit_pass(cloud, &long, &order, &mut free, &mut walls);
        free = vec![true; cloud.points().len()];
        for wall in &walls {
            claim(cloud, wall, rules, &mut free);
        }
    }
    fit_pass(cloud, rules, &order, &mut free, &mut walls);
    walls
}

/// Fits a wall to each seed in `order` that is still `free`. A wall that is too short uses its points up.
fn fit_pass(
    cloud: &PointCloud,
    rules: &WallFitSettings,
    order: &[u32],
    free: &mut [bool],
    walls: &mut Vec<FittedWall>,
) {
    for &seed in order {
        if free.get(seed as usize) != Some(&true) {
            continue;
        }
        let Some(wall) = fit_wall(cloud, rules, seed, free) else {
            release(free, seed);
            continue;
        };
        if wall.extent.1 - wall.extent.0 >= rules.shortest {
            claim(cloud, &wall, rules, free);
            walls.push(wall);
        } else {
            for &member in &wall.members {
                release(free, member);
            }
        }
    }
}

/// Marks a point as used.
fn release(free: &mut [bool], number: u32) {
    if let Some(flag) = free.get_mut(number as usize) {
        *flag = false;
    }
}

/// Marks the members of a wall, and the points close to a long one, as used.
fn claim(cloud: &PointCloud, wall: &FittedWall, rules: &WallFitSettings, free: &mut [bool]) {
    for &member in &wall.members {
        release(free, member);
    }
    if rules.claim <= 0.0 || wall.extent.1 - wall.extent.0 < rules.long {
        return;
    }
    let (low, high) = (wall.extent.0 - rules.claim, wall.extent.1 + rules.claim);
    let steps = ((high - low) / cloud.side()).ceil() as u32;
    for step in 0..=steps {
        let along = (low + f64::from(step) * cloud.side()).min(high);
        let (x, y) = (wall.middle.0 - along * wall.normal.1, wall.middle.1 + along * wall.normal.0);
        for (number, point) in cloud.around(x, y) {
            let off = (point.x - wall.middle.0) * wall.normal.0 + (point.y - wall.middle.1) * wall.normal.1;
            let at = wall.along(point.x, point.y);
            if off.abs() <= rules.claim && at >= low && at <= high {
                release(free, number);
            }
        }
    }
}

fn fit_wall(cloud: &PointCloud, rules: &WallFitSettings, seed: u32, free: &[bool]) -> Option<FittedWall> {
    let start = cloud.points().get(seed as usize)?;
    let line = FittedWall {
        middle: (start.x, start.y),
        normal: start.normal,
        extent: (0.0, 0.0),
        members: Vec::new(),
        residual_sum_of_squares: 0.0,
    };
    let growing = WallFitSettings { tolerance: rules.growth_tolerance, ..*rules };
    let mut wall = line;
    if rules.growth_tolerance > rules.tolerance {
        wall = refit(cloud, &growing, start, free, wall, GROWTH_ROUNDS)?;
    }
    wall = refit(cloud, rules, start, free, wall, ROUNDS)?;
    let mut without = None;
    for _ in 0..ROUNDS {
        let recesses = recesses(cloud, rules, &wall);
        if recesses.is_empty() {
            break;
        }
        let free: &mut Vec<bool> = without.get_or_insert_with(|| free.to_vec());
        for member in recesses {
            release(free, member);
        }
        wall = refit(cloud, rules, start, free, wall, ROUNDS)?;
    }
    Some(wall)
}

/// Minimum number of successive points of a recess, and of the wall beside it.
const RECESS_POINTS: usize = 3;

/// Returns the members in recesses and bumps: several successive points far on one side of the line, between points on
/// the other side.
///
/// The cells of a straight wall alternate between the sides of its line, with a small distance where many are on one side.
fn recesses(cloud: &PointCloud, rules: &WallFitSettings, wall: &FittedWall) -> Vec<u32> {
    if rules.recess.is_infinite() {
        return Vec::new();
    }
    let place = |&member: &u32| {
        let point = cloud.points().get(member as usize)?;
        let off = (point.x - wall.middle.0) * wall.normal.0 + (point.y - wall.middle.1) * wall.normal.1;
        Some((wall.along(point.x, point.y), off, member))
    };
    let mut places: Vec<_> = wall.members.iter().filter_map(place).collect();
    places.sort_by(|a, b| a.0.total_cmp(&b.0));
    let stretches: Vec<_> = places.chunk_by(|a, b| (a.1 > 0.0) == (b.1 > 0.0)).collect();
    let is_wall = |stretch: &[_]| stretch.len() >= RECESS_POINTS;
    let inner = stretches.windows(3).filter(|beside| is_wall(beside[0]) && is_wall(beside[2]));
    let far = |stretch: &[(f64, f64, u32)]| {
        let sum: f64 = stretch.iter().map(|place| place.1.abs()).sum();
        is_wall(stretch) && sum > rules.recess * stretch.len() as f64
    };
    inner.map(|beside| beside[1]).filter(|stretch| far(stretch)).flatten().map(|place| place.2).collect()
}

/// Alternates between selection of points and fit of the line, until the points stay the same.
fn refit(
    cloud: &PointCloud,
    rules: &WallFitSettings,
    start: &SurfacePoint,
    free: &[bool],
    mut line: FittedWall,
    rounds: usize,
) -> Option<FittedWall> {
    for _ in 0..rounds {
        // The foot of the seed on the line, so that the fit stays on the wall that it started with.
        let off = (start.x - line.middle.0) * line.normal.0 + (start.y - line.middle.1) * line.normal.1;
        let foot = (start.x - off * line.normal.0, start.y - off * line.normal.1);
        let mut members = Vec::new();
        follow(cloud, rules, foot, line.normal, 1.0, free, &mut members);
        follow(cloud, rules, foot, line.normal, -1.0, free, &mut members);
        if members.len() < rules.fewest {
            return None;
        }
        let settled = members == line.members;
        line = fitted(cloud, members, line.normal);
        if settled {
            break;
        }
    }
    Some(line)
}

/// Collects the points on the line from `foot`, to the left of its normal if `way` is 1, to the right if −1.
fn follow(
    cloud: &PointCloud,
    rules: &WallFitSettings,
    foot: (f64, f64),
    normal: (f64, f64),
    way: f64,
    free: &[bool],
    members: &mut Vec<u32>,
) {
    let tangent = (-normal.1 * way, normal.0 * way);
    let step = cloud.side();
    let mut last = 0.0;
    let mut from = 0.0;
    let mut batch: Vec<(f64, u32)> = Vec::new();
    while from - last <= rules.gap {
        let (x, y) = (foot.0 + (from + 0.5 * step) * tangent.0, foot.1 + (from + 0.5 * step) * tangent.1);
        batch.clear();
        for (number, point) in cloud.around(x, y) {
            let (dx, dy) = (point.x - foot.0, point.y - foot.1);
            let along = dx * tangent.0 + dy * tangent.1;
            let near = (dx * normal.0 + dy * normal.1).abs() < rules.tolerance;
            // A point at the foot is collected on both ways: it counts twice in the fit.
            let here = along >= from && along < from + step;
            if near && here && free.get(number as usize) == Some(&true) && agrees(point, normal, rules) {
                batch.push((along, number));
            }
        }
        batch.sort_by(|a, b| a.0.total_cmp(&b.0));
        for &(along, number) in &batch {
            if along - last > rules.gap {
                return;
            }
            last = along;
            members.push(number);
        }
        from += step;
    }
}

fn agrees(point: &SurfacePoint, normal: (f64, f64), rules: &WallFitSettings) -> bool {
    let cosine = point.normal.0 * normal.0 + point.normal.1 * normal.1;
    cosine > rules.alignment || (point.both_sides && -cosine > rules.alignment)
}

/// Fits a least-squares line to the members; its normal is on the side of `facing`.
pub fn fitted(cloud: &PointCloud, members: Vec<u32>, facing: (f64, f64)) -> FittedWall {
    let points = || members.iter().filter_map(|&number| cloud.points().get(number as usize));
    let mut scatter = PointMoments::default();
    // Relative to the first member, for numerical accuracy.
    let (x0, y0) = points().next().map_or((0.0, 0.0), |p| (p.x, p.y));
    for point in points() {
        scatter.add(point.x - x0, point.y - y0);
    }
    let line = scatter.line();
    let side = if line.normal.0 * facing.0 + line.normal.1 * facing.1 < 0.0 { -1.0 } else { 1.0 };
    let normal = (side * line.normal.0, side * line.normal.1);
    let middle = (line.middle.0 + x0, line.middle.1 + y0);
    let mut extent = (f64::INFINITY, f64::NEG_INFINITY);
    for point in points() {
        let along = (point.y - middle.1) * normal.0 - (point.x - middle.0) * normal.1;
        extent = (extent.0.min(along), extent.1.max(along));
    }
    FittedWall { middle, normal, extent, residual_sum_of_squares: line.across * scatter.count, members }
}
