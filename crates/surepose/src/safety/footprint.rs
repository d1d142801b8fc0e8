//! Outline of the robot, for collision checks.

use crate::geometry::{Body, Point};
use crate::kinematics::DiffDrive;
use crate::scalar::Float;

/// The largest number of vertices of a polygonal footprint.
pub const MAX_VERTICES: usize = 8;

/// Distance from the middle of a wheel to the outline \[m], of a robot whose outline is not configured.
const WHEEL_MARGIN: f64 = 0.02;

/// Outline of the robot in its body frame.
#[derive(Clone, Copy, Debug, PartialEq)]
///
/// ```
/// use surepose::geometry::Point;
/// use surepose::safety::{Footprint, Polygon};
///
/// // 0.5 m long and 0.4 m wide, with the axle 0.1 m ahead of the rear.
/// let corners = [(0.4, 0.2), (-0.1, 0.2), (-0.1, -0.2), (0.4, -0.2)].map(|(x, y)| Point::new(x, y));
/// let footprint = Polygon::new(&corners).map(Footprint::Polygon);
/// assert!(footprint.is_ok_and(|footprint| (footprint.distance_to_point(Point::new(1.4, 0.0)) - 1.0_f64).abs() < 1e-12));
/// ```
pub enum Footprint<S> {
    /// Disc around the origin of the body frame, with its radius \[m]. Radius 0 is a point.
    Circle(S),
    /// Polygon that contains the origin of the body frame.
    Polygon(Polygon<S>),
}

/// Simple polygon with up to [`MAX_VERTICES`] vertices in the body frame \[m].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Polygon<S> {
    vertices: [Point<Body, S>; MAX_VERTICES],
    len: usize,
}

/// Rejected outline: fewer than 3 or more than [`MAX_VERTICES`] vertices, a vertex that is not finite, or an outline that
/// does not contain the origin of the body frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InvalidFootprint;

impl core::fmt::Display for InvalidFootprint {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("invalid footprint: expected 3 to 8 finite vertices around the middle of the axle")
    }
}

impl core::error::Error for InvalidFootprint {}

impl<S: Float> Polygon<S> {
    /// Polygon with the given vertices \[m], in either order of rotation.
    ///
    /// # Errors
    /// [`InvalidFootprint`].
    pub fn new(vertices: &[Point<Body, S>]) -> Result<Self, InvalidFootprint> {
        let finite = vertices.iter().all(|vertex| vertex.x.is_finite() && vertex.y.is_finite());
        if vertices.len() < 3 || vertices.len() > MAX_VERTICES || !finite {
            return Err(InvalidFootprint);
        }
        let mut polygon = Self { vertices: [Point::default(); MAX_VERTICES], len: vertices.len() };
        for (slot, vertex) in polygon.vertices.iter_mut().zip(vertices) {
            *slot = *vertex;
        }
        if polygon.contains(Point::default()) { Ok(polygon) } else { Err(InvalidFootprint) }
    }

    /// Vertices in the order in which they were given.
    pub fn vertices(&self) -> &[Point<Body, S>] {
        self.vertices.get(..self.len).unwrap_or(&[])
    }

    /// Edges as pairs of vertices.
    fn edges(&self) -> impl Iterator<Item = [Point<Body, S>; 2]> + '_ {
        let vertices = self.vertices();
        vertices.iter().zip(vertices.iter().cycle().skip(1)).map(|(a, b)| [*a, *b])
    }

    /// Whether a point lies inside: the ray from it along x crosses an odd number of edges.
    fn contains(&self, point: Point<Body, S>) -> bool {
        let crossings = self.edges().filter(|[a, b]| {
            let straddles = (a.y > point.y) != (b.y > point.y);
            straddles && {
                let fraction = (point.y - a.y) / (b.y - a.y);
                point.x < a.x + fraction * (b.x - a.x)
            }
        });
        crossings.count() % 2 == 1
    }
}

impl<S: Float> Footprint<S> {
    /// Circle around both drive wheels: half the wheel separation and 2 cm for the width of a wheel.
    ///
    /// It is the smallest outline that a robot with this drive can have. A robot with a larger body needs its own outline.
    pub fn from_drive(drive: &DiffDrive<S>) -> Self {
        Self::Circle(drive.wheel_separation * S::from_f64(0.5) + S::from_f64(WHEEL_MARGIN))
    }

    /// Radius of the largest disc around the origin of the body frame within the footprint \[m].
    pub fn inscribed_radius(&self) -> S {
        match self {
            Self::Circle(radius) => *radius,
            Self::Polygon(polygon) => {
                let distances = polygon.edges().map(|edge| point_to_segment(Point::default(), edge));
                distances.fold(S::from_f64(f64::MAX), S::min)
            }
        }
    }

    /// Radius of the smallest disc around the body frame's origin that contains the footprint \[m].
    pub fn circumscribed_radius(&self) -> S {
        match self {
            Self::Circle(radius) => *radius,
            Self::Polygon(polygon) => {
                let origin = Point::default();
                polygon
                    .vertices()
                    .iter()
                    .fold(S::from_f64(0.0), |most, vertex| most.max(vertex.distance(origin)))
            }
        }
    }

    /// Distance from a point to the footprint \[m]; 0 inside.
    pub fn distance_to_point(&self, point: Point<Body, S>) -> S {
        self.distance_to_segment([point, point])
    }

    /// Distance from a segment to the footprint \[m]; 0 where they touch or overlap.
    pub fn distance_to_segment(&self, segment: [Point<Body, S>; 2]) -> S {
        let zero = S::from_f64(0.0);
        match self {
            Self::Circle(radius) => (point_to_segment(Point::default(), segment) - *radius).max(zero),
            Self::Polygon(polygon) if polygon.contains(segment[0]) => zero,
            Self::Polygon(polygon) => {
                let distances = polygon.edges().map(|edge| segment_to_segment(edge, segment));
                distances.fold(S::from_f64(f64::MAX), S::min)
            }
        }
    }
}

/// Distance from a point to a segment \[m].
fn point_to_segment<S: Float>(point: Point<Body, S>, [a, b]: [Point<Body, S>; 2]) -> S {
    let (zero, one) = (S::from_f64(0.0), S::from_f64(1.0));
    let (ex, ey) = (b.x - a.x, b.y - a.y);
    let (px, py) = (point.x - a.x, point.y - a.y);
    let fraction = (px * ex + py * ey).div_or_zero(ex.squared() + ey.squared()).clamp(zero, one);
    ((px - fraction * ex).squared() + (py - fraction * ey).squared()).sqrt()
}

/// Distance between two segments \[m]; 0 where they cross.
fn segment_to_segment<S: Float>(one: [Point<Body, S>; 2], other: [Point<Body, S>; 2]) -> S {
    let zero = S::from_f64(0.0);
    let side = |[a, b]: [Point<Body, S>; 2], p: Point<Body, S>| {
        (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x)
    };
    let separates = |line: [Point<Body, S>; 2], ends: [Point<Body, S>; 2]| {
        side(line, ends[0]) * side(line, ends[1]) < zero
    };
    if separates(one, other) && separates(other, one) {
        return zero;
    }
    let ends = [(one[0], other), (one[1], other), (other[0], one), (other[1], one)];
    let distances = ends.map(|(point, segment)| point_to_segment(point, segment));
    distances.into_iter().fold(S::from_f64(f64::MAX), S::min)
}
