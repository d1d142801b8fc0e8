//! Walls of the map: straight, thin, visible from both sides.

use crate::geometry::{Line, Map, Point};
use crate::scalar::{Float, Scalar};

/// Wall segment between two points of the map.
#[derive(Clone, Copy, Debug, PartialEq)]
///
/// ```
/// use surepose::geometry::Point;
/// use surepose::map::Wall;
///
/// let wall = Wall::between(Point::new(3.0, 0.0), Point::new(3.0, 2.0));
/// assert!(wall.is_ok_and(|wall| wall.length() == 2.0 && wall.line().distance == 3.0));
/// assert!(Wall::between(Point::new(1.0, 1.0), Point::new(1.0, 1.0)).is_err());
/// ```
pub struct Wall<S> {
    line: Line<Map, S>,
    /// Positions of both ends on the line, along the left of the normal \[m].
    extent: (S, S),
    /// Covariance of the line, see [`Wall::covariance`].
    covariance: [S; 3],
}

/// Error of a wall whose ends coincide or are not finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InvalidWall;

impl core::fmt::Display for InvalidWall {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("not a wall: its ends must be finite and apart")
    }
}

impl core::error::Error for InvalidWall {}

impl<S: Float> Wall<S> {
    /// Wall between two points.
    ///
    /// # Errors
    /// [`InvalidWall`] where the points coincide or are not finite.
    pub fn between(start: Point<Map, S>, end: Point<Map, S>) -> Result<Self, InvalidWall> {
        let finite = [start.x, start.y, end.x, end.y].iter().all(|v| v.is_finite());
        if !finite || start.distance(end) <= S::from_f64(0.0) {
            return Err(InvalidWall);
        }
        let line = Line::through(start, end);
        let (a, b) = (along(&line, start), along(&line, end));
        Ok(Self { line, extent: (a.min(b), a.max(b)), covariance: [S::from_f64(0.0); 3] })
    }

    /// Line through the wall.
    pub fn line(&self) -> &Line<Map, S> {
        &self.line
    }

    /// Sets the covariance of the line; see [`Wall::covariance`].
    #[must_use]
    pub fn with_covariance(self, covariance: [S; 3]) -> Self {
        Self { covariance, ..self }
    }

    /// Covariance of the line: variance of r \[m²], covariance of r and ψ \[m·rad], variance of ψ \[rad²].
    pub fn covariance(&self) -> [S; 3] {
        self.covariance
    }

    /// Variance of the wall's line at the foot of `point`, along the normal \[m²].
    ///
    /// The line's distance from the map's origin is r, its direction ψ. Its distance from a point at the coordinate a along the
    /// line has the error δr − a·δψ.
    pub fn position_variance(&self, point: Point<Map, S>) -> S {
        let [r_r, r_psi, psi_psi] = self.covariance;
        let (nx, ny) = self.line.normal();
        let along = point.y * nx - point.x * ny;
        (r_r - S::from_f64(2.0) * along * r_psi + along.squared() * psi_psi).max(S::from_f64(0.0))
    }

    /// Distance from `point` to the nearest point of the wall \[m].
    #[inline]
    pub fn distance(&self, point: Point<Map, S>) -> S {
        (self.line.distance_from(point).squared() + self.distance_beyond_ends(point).squared()).sqrt()
    }

    /// Distance of the foot of `point` beyond the ends of the wall \[m]; 0 beside the wall.
    #[inline]
    pub(crate) fn distance_beyond_ends(&self, point: Point<Map, S>) -> S {
        let a = along(&self.line, point);
        (self.extent.0 - a).max(a - self.extent.1).max(S::from_f64(0.0))
    }

    /// End points.
    pub fn ends(&self) -> [Point<Map, S>; 2] {
        let (nx, ny) = self.line.normal();
        let r = self.line.distance;
        [self.extent.0, self.extent.1].map(|t| Point::new(r * nx - t * ny, r * ny + t * nx))
    }

    /// Standard deviation of the positions of `walls` along their normals, in the middle of each \[m]: the root mean square.
    pub fn position_std_of(walls: &[Self]) -> S {
        let half = S::from_f64(0.5);
        let middle =
            |[from, to]: [Point<Map, S>; 2]| Point::new((from.x + to.x) * half, (from.y + to.y) * half);
        let variances = walls.iter().map(|wall| wall.position_variance(middle(wall.ends())));
        let sum = variances.fold(S::from_f64(0.0), |sum, variance| sum + variance);
        (sum / S::from_f64(walls.len().max(1) as f64)).sqrt()
    }

    /// Whether the segment between two points crosses or touches the wall. A segment along the wall does not cross it;
    /// its ends are at distance 0 from the wall.
    pub fn crosses(&self, [from, to]: [Point<Map, S>; 2]) -> bool {
        let side = |a: Point<Map, S>, b: Point<Map, S>, p: Point<Map, S>| {
            (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x)
        };
        let zero = S::from_f64(0.0);
        let is_opposite = |one: S, other: S| one * other <= zero;
        let [start, end] = self.ends();
        let (s, e) = (side(from, to, start), side(from, to, end));
        let (f, t) = (side(start, end, from), side(start, end, to));
        (s != zero || e != zero) && is_opposite(s, e) && is_opposite(f, t)
    }

    /// Length \[m].
    pub fn length(&self) -> S {
        self.extent.1 - self.extent.0
    }

    /// Fraction of the segment between two points that lies beside the wall, extended by `margin` \[m]: 0 to 1.
    pub(crate) fn overlap(&self, ends: [Point<Map, S>; 2], margin: S) -> S {
        let [a, b] = ends.map(|end| along(&self.line, end));
        let (low, high) = (a.min(b), a.max(b));
        let common = high.min(self.extent.1 + margin) - low.max(self.extent.0 - margin);
        common.max(S::from_f64(0.0)).div_or_zero(high - low)
    }
}

/// Position of the foot of `point` on the line: distance from the foot of the origin, positive left \[m].
#[inline]
pub(crate) fn along<S: Scalar>(line: &Line<Map, S>, point: Point<Map, S>) -> S {
    let (nx, ny) = line.normal();
    nx * point.y - ny * point.x
}
