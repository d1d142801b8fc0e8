//! Straight lines in normal form, such as a wall in a scan.

use core::marker::PhantomData;

use crate::scalar::Scalar;

use super::angle::Angle;
use super::frame::Frame;
use super::pose::{Point, Pose};

/// Line x·cos ψ + y·sin ψ = r in frame `In`.
///
/// (r, ψ) and (−r, ψ + π) describe the same line with opposite normals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line<In, S> {
    /// Signed distance r from the origin along the normal \[m].
    pub distance: S,
    /// Direction ψ of the normal.
    pub direction: Angle<S>,
    /// (cos ψ, sin ψ), stored because every scan uses the normals of the map's walls.
    normal: (S, S),
    frame: PhantomData<In>,
}

impl<In: Frame, S: Scalar> Line<In, S> {
    /// Creates the line at `distance` \[m] from the origin along the normal `direction`.
    #[inline(always)]
    pub fn new(distance: S, direction: Angle<S>) -> Self {
        let (sin, cos) = direction.sin_cos();
        Self { distance, direction, normal: (cos, sin), frame: PhantomData }
    }

    /// Creates the line through two points; its normal points to the right of the direction from `start` to `end`.
    ///
    /// If the points coincide, the direction of the normal is 0.
    #[inline(always)]
    pub fn through(start: Point<In, S>, end: Point<In, S>) -> Self {
        let direction = Angle::from_vector(end.y - start.y, start.x - end.x);
        let (sin, cos) = direction.sin_cos();
        let distance = (start.x * cos + start.y * sin + end.x * cos + end.y * sin) * S::from_f64(0.5);
        Self { distance, direction, normal: (cos, sin), frame: PhantomData }
    }

    /// Returns the unit normal (cos ψ, sin ψ).
    #[inline(always)]
    pub fn normal(&self) -> (S, S) {
        self.normal
    }

    /// Computes the signed distance of `point`: r − p·n \[m]. For r > 0 it is positive on the side of the origin.
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
