//! Poses and points of the plane, typed by their frames.

use core::marker::PhantomData;
use core::ops::Mul;

use crate::scalar::Scalar;

use super::angle::Angle;
use super::frame::Frame;

/// Pose of frame `From` in frame `To`. Values are named `to_from_from`, for example `map_from_body`.
///
/// Two poses compose if the inner frames are the same:
///
/// ```
/// use surepose::geometry::{Angle, Body, Goal, Map, Pose};
/// let map_from_body: Pose<Map, Body, f64> = Pose::new(1.0, 2.0, Angle::from_degrees(90.0));
/// let map_from_goal: Pose<Map, Goal, f64> = Pose::new(1.0, 3.0, Angle::from_degrees(90.0));
/// let body_from_goal: Pose<Body, Goal, f64> = map_from_body.inverse() * map_from_goal;
/// assert!((body_from_goal.x - 1.0).abs() < 1e-12 && body_from_goal.y.abs() < 1e-12);
/// ```
///
/// ```compile_fail
/// use surepose::geometry::{Angle, Body, Goal, Map, Pose};
/// let map_from_body: Pose<Map, Body, f64> = Pose::new(1.0, 2.0, Angle::zero());
/// let map_from_goal: Pose<Map, Goal, f64> = Pose::new(1.0, 3.0, Angle::zero());
/// let _ = map_from_body * map_from_goal; // Body is not Map
/// ```
///
/// The types do not detect a mix of two different maps, or millimeters in place of meters.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pose<To, From, S> {
    /// x of the origin of `From` in `To` \[m].
    pub x: S,
    /// y of the origin of `From` in `To` \[m].
    pub y: S,
    /// Direction of the x axis of `From` in `To`.
    pub heading: Angle<S>,
    frames: PhantomData<(To, From)>,
}

impl<To: Frame, From: Frame, S: Scalar> Pose<To, From, S> {
    /// Creates the pose at (`x`, `y`) \[m] with `heading`.
    #[inline(always)]
    pub fn new(x: S, y: S, heading: Angle<S>) -> Self {
        Self { x, y, heading, frames: PhantomData }
    }

    /// Returns the pose of a frame that coincides with `To`.
    #[inline(always)]
    pub fn identity() -> Self {
        Self::new(S::from_f64(0.0), S::from_f64(0.0), Angle::zero())
    }

    /// Returns `yes` where `mask` is true, else `no`.
    #[must_use]
    #[inline(always)]
    pub fn select(mask: S::Mask, yes: Self, no: Self) -> Self {
        let heading = S::select(mask, yes.heading.radians(), no.heading.radians());
        Self::new(S::select(mask, yes.x, no.x), S::select(mask, yes.y, no.y), Angle::from_radians(heading))
    }

    /// Returns the inverse pose, `from_from_to`.
    #[must_use]
    #[inline(always)]
    pub fn inverse(self) -> Pose<From, To, S> {
        let (sin, cos) = self.heading.sin_cos();
        Pose::new(-(cos * self.x + sin * self.y), sin * self.x - cos * self.y, -self.heading)
    }

    /// Returns the origin of `From` as a point in `To`.
    #[inline(always)]
    pub fn origin(self) -> Point<To, S> {
        Point::new(self.x, self.y)
    }
}

impl<A: Frame, B: Frame, C: Frame, S: Scalar> Mul<Pose<B, C, S>> for Pose<A, B, S> {
    type Output = Pose<A, C, S>;
    #[inline(always)]
    fn mul(self, other: Pose<B, C, S>) -> Pose<A, C, S> {
        let at = self * other.origin();
        Pose::new(at.x, at.y, self.heading + other.heading)
    }
}

/// Point in frame `In` \[m].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point<In, S> {
    /// First coordinate \[m].
    pub x: S,
    /// Second coordinate \[m].
    pub y: S,
    frame: PhantomData<In>,
}

impl<In: Frame, S: Scalar> Point<In, S> {
    /// Creates the point (`x`, `y`) \[m].
    #[inline(always)]
    pub fn new(x: S, y: S) -> Self {
        Self { x, y, frame: PhantomData }
    }

    /// Computes the distance to `other` \[m].
    #[inline(always)]
    pub fn distance(self, other: Self) -> S {
        ((self.x - other.x).squared() + (self.y - other.y).squared()).sqrt()
    }

    /// Computes distance \[m] and direction to `other`; the direction is 0 if the points coincide.
    #[inline(always)]
    pub fn polar_to(self, other: Self) -> (S, Angle<S>) {
        let (distance, direction) = (other.y - self.y).polar(other.x - self.x);
        (distance, Angle::from_radians_unchecked(direction))
    }

    /// Computes the direction to `other`; 0 if the points coincide.
    #[inline(always)]
    pub fn direction_to(self, other: Self) -> Angle<S> {
        Angle::from_vector(other.x - self.x, other.y - self.y)
    }
}

impl<To: Frame, From: Frame, S: Scalar> Mul<Point<From, S>> for Pose<To, From, S> {
    type Output = Point<To, S>;
    #[inline(always)]
    fn mul(self, point: Point<From, S>) -> Point<To, S> {
        let (sin, cos) = self.heading.sin_cos();
        Point::new(self.x + cos * point.x - sin * point.y, self.y + sin * point.x + cos * point.y)
    }
}
