//! Paths of constant-curvature pieces, such as the rounded rectangle and triangle of [Tran2012] Fig. 6.

use core::f64::consts::{FRAC_PI_2, PI};

use crate::drive::{Integration, Motion};
use crate::frame::{Map, Target};
use crate::pose::Pose;
use crate::scalar::{Float, Scalar};

/// One piece of a path: straight where its curvature is 0, an arc elsewhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leg<S> {
    /// Length \[m].
    pub length: S,
    /// Curvature κ, positive to the left \[1/m].
    pub curvature: S,
}

/// A closed path of `N` legs, each starting where the one before it ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Path<S, const N: usize> {
    legs: [Leg<S>; N],
    /// Where each leg starts: the distance from the path's start \[m], and the pose.
    starts: [(S, Pose<Map, Target, S>); N],
    length: S,
}

/// A place on a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place<S> {
    /// The pose, x along the path.
    pub map_from_target: Pose<Map, Target, S>,
    /// The path's curvature κ there \[1/m].
    pub curvature: S,
}

/// The lengths of a path's legs are not positive, or not finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotAPath;

impl core::fmt::Display for NotAPath {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("not a path: every leg needs a positive, finite length and a finite curvature")
    }
}

impl core::error::Error for NotAPath {}

impl<S: Scalar, const N: usize> Path<S, N> {
    /// The length of one round \[m].
    pub fn length(&self) -> S {
        self.length
    }

    /// The place `along` \[m] from the start, counted over as many rounds as it takes.
    #[inline]
    pub fn at(&self, along: S) -> Place<S> {
        let rounds = (along / self.length - S::of(0.5)).round();
        let along = along - rounds * self.length;

        let (mut begin, mut pose) = self.starts[0];
        let mut curvature = self.legs[0].curvature;
        for i in 1..N {
            let (start, map_from_start) = self.starts[i];
            let before = along.lt(start);
            begin = S::select(before, begin, start);
            pose = Pose::select(before, pose, map_from_start);
            curvature = S::select(before, curvature, self.legs[i].curvature);
        }
        let length = along - begin;
        let motion = Motion { length, turn: length * curvature };
        Place { map_from_target: pose.moved(motion, Integration::Arc), curvature }
    }
}

impl<S: Float, const N: usize> Path<S, N> {
    /// The path of `legs` that starts at `start`; that it closes is the caller's to see to.
    ///
    /// # Errors
    /// [`NotAPath`] for a leg without a positive, finite length, or with a curvature that is not finite.
    pub fn closed(start: Pose<Map, Target, S>, legs: [Leg<S>; N]) -> Result<Self, NotAPath> {
        let sound =
            |leg: &Leg<S>| leg.length.is_finite() && leg.length > S::of(0.0) && leg.curvature.is_finite();
        if N == 0 || !legs.iter().all(sound) {
            return Err(NotAPath);
        }
        let mut starts = [(S::of(0.0), start); N];
        let (mut length, mut pose) = (S::of(0.0), start);
        for (begin, leg) in starts.iter_mut().zip(legs) {
            *begin = (length, pose);
            length = length + leg.length;
            let motion = Motion { length: leg.length, turn: leg.length * leg.curvature };
            pose = pose.moved(motion, Integration::Arc);
        }
        Ok(Self { legs, starts, length })
    }
}

impl<S: Float> Path<S, 8> {
    /// A `width` × `height` rectangle with corners of `radius` \[m], left about, from the start of its lower side.
    ///
    /// # Errors
    /// [`NotAPath`] where the corners leave no straight between them.
    pub fn rounded_rectangle(
        start: Pose<Map, Target, S>,
        width: S,
        height: S,
        radius: S,
    ) -> Result<Self, NotAPath> {
        let side = |length: S| Leg { length: length - S::of(2.0) * radius, curvature: S::of(0.0) };
        let corner = Leg { length: radius * S::of(FRAC_PI_2), curvature: S::of(1.0) / radius };
        let (long, short) = (side(width), side(height));
        Self::closed(start, [long, corner, short, corner, long, corner, short, corner])
    }
}

impl<S: Float> Path<S, 6> {
    /// An equilateral triangle of `side` with corners of `radius` \[m], left about, from the start of its lower side.
    ///
    /// # Errors
    /// [`NotAPath`] where the corners leave no straight between them.
    pub fn rounded_triangle(start: Pose<Map, Target, S>, side: S, radius: S) -> Result<Self, NotAPath> {
        // A corner of 60° takes radius / tan 30° from each of its sides, and turns by 120°.
        let taken = radius * S::of(3.0).sqrt();
        let straight = Leg { length: side - S::of(2.0) * taken, curvature: S::of(0.0) };
        let corner = Leg { length: radius * S::of(2.0 * PI / 3.0), curvature: S::of(1.0) / radius };
        Self::closed(start, [straight, corner, straight, corner, straight, corner])
    }
}

#[cfg(test)]
mod tests {
    use super::{Leg, NotAPath, Path};
    use crate::angle::Angle;
    use crate::pose::Pose;

    fn apart(path_end: super::Place<f64>, start: super::Place<f64>) -> f64 {
        let (a, b) = (path_end.map_from_target, start.map_from_target);
        a.origin().distance(b.origin()) + (a.heading - b.heading).radians().abs()
    }

    #[test]
    fn rounded_shapes_close_and_are_smooth() {
        let start = Pose::new(2.0, 1.0, Angle::from_degrees(20.0));
        let rectangle = Path::rounded_rectangle(start, 3.0, 2.0, 0.5).unwrap();
        let triangle = Path::rounded_triangle(start, 3.0, 0.4).unwrap();
        assert!((rectangle.length() - (6.0 + core::f64::consts::PI)).abs() < 1e-12);
        for k in 0..2000 {
            let along = f64::from(k) * 0.01;
            assert!(apart(rectangle.at(along), rectangle.at(along + 1e-9)) < 4e-9, "rectangle at {along}");
            assert!(apart(triangle.at(along), triangle.at(along + 1e-9)) < 4e-9, "triangle at {along}");
        }
        assert!(apart(rectangle.at(-0.25), rectangle.at(rectangle.length() - 0.25)) < 1e-12);
    }

    #[test]
    fn rectangle_of_the_loop_world_passes_its_corners() {
        let path = Path::rounded_rectangle(Pose::new(2.0, 1.0, Angle::zero()), 3.0, 2.0, 0.5).unwrap();
        let quarter = core::f64::consts::FRAC_PI_2 * 0.5;
        for (along, x, y, degrees) in [
            (1.0, 3.0, 1.0, 0.0),
            (2.0 + quarter, 4.5, 1.5, 90.0),
            (3.0 + 2.0 * quarter, 4.0, 3.0, 180.0),
            (5.0 + 3.0 * quarter, 1.5, 2.5, -90.0),
        ] {
            let pose = path.at(along).map_from_target;
            assert!((pose.x - x).abs() < 1e-12 && (pose.y - y).abs() < 1e-12, "{pose:?}");
            assert!((pose.heading - Angle::from_degrees(degrees)).radians().abs() < 1e-12, "{pose:?}");
        }
    }

    #[test]
    fn impossible_paths_are_refused() {
        let start = Pose::new(0.0, 0.0, Angle::zero());
        assert_eq!(Path::rounded_rectangle(start, 1.0, 2.0, 0.5), Err(NotAPath));
        assert_eq!(Path::rounded_triangle(start, f64::NAN, 0.5), Err(NotAPath));
        assert_eq!(Path::closed(start, [Leg { length: 1.0, curvature: f64::INFINITY }]), Err(NotAPath));
        assert_eq!(Path::<f64, 0>::closed(start, []), Err(NotAPath));
    }
}
