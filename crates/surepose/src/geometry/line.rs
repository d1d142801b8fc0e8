//! Straight lines in normal form: what a laser sees of a wall.

use core::marker::PhantomData;

use crate::scalar::Scalar;

use super::angle::Angle;
use super::frame::Frame;
use super::pose::{Point, Pose};

/// The line x·cos ψ + y·sin ψ = r in frame `In`.
///
/// (r, ψ) and (−r, ψ + π) are the same line; which of the two a line holds says on which side its normal points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line<In, S> {
    /// Signed distance r from the origin along the normal \[m].
    pub distance: S,
    /// Direction ψ of the normal.
    pub direction: Angle<S>,
    /// cos ψ, sin ψ: kept, because a map's walls are asked for them at every scan.
    normal: (S, S),
    frame: PhantomData<In>,
}

impl<In: Frame, S: Scalar> Line<In, S> {
    /// The line at `distance` \[m] along `direction`.
    #[inline(always)]
    pub fn new(distance: S, direction: Angle<S>) -> Self {
        let (sin, cos) = direction.sin_cos();
        Self { distance, direction, normal: (cos, sin), frame: PhantomData }
    }

    /// The line through two points, its normal to the right of the way from `start` to `end`.
    ///
    /// Where the points coincide the direction is that of a null vector, 0.
    #[inline(always)]
    pub fn through(start: Point<In, S>, end: Point<In, S>) -> Self {
        let direction = Angle::from_vector(end.y - start.y, start.x - end.x);
        let (sin, cos) = direction.sin_cos();
        let distance = (start.x * cos + start.y * sin + end.x * cos + end.y * sin) * S::from_f64(0.5);
        Self { distance, direction, normal: (cos, sin), frame: PhantomData }
    }

    /// The unit normal (cos ψ, sin ψ).
    #[inline(always)]
    pub fn normal(&self) -> (S, S) {
        self.normal
    }

    /// How far `point` lies before the line: r − p·n \[m], positive on the origin's side where r > 0.
    #[inline(always)]
    pub fn distance_from(&self, point: Point<In, S>) -> S {
        let (nx, ny) = self.normal;
        self.distance - (nx * point.x + ny * point.y)
    }
}

impl<To: Frame, From: Frame, S: Scalar> core::ops::Mul<Line<From, S>> for Pose<To, From, S> {
    type Output = Line<To, S>;
    #[inline(always)]
    fn mul(self, line: Line<From, S>) -> Line<To, S> {
        let direction = self.heading + line.direction;
        let (sin, cos) = direction.sin_cos();
        let distance = line.distance + self.x * cos + self.y * sin;
        Line { distance, direction, normal: (cos, sin), frame: PhantomData }
    }
}
