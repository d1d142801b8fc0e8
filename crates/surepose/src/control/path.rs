//! Paths of constant-curvature pieces, such as the rounded rectangle and triangle of [Tran2012] Fig. 6.

use core::f64::consts::{FRAC_PI_2, PI};

use crate::geometry::{Map, Pose, Target};
use crate::kinematics::{Integration, Motion};
use crate::scalar::{Float, Scalar};

/// One piece of a path: straight where its curvature is 0, an arc elsewhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathSegment<S> {
    /// Length \[m].
    pub length: S,
    /// Curvature κ, positive to the left \[1/m].
    pub curvature: S,
}

/// A closed path of `N` segments, each starting where the one before it ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Path<S, const N: usize> {
    segments: [PathSegment<S>; N],
    /// Start of each segment: distance from the start of the path \[m], and pose.
    starts: [(S, Pose<Map, Target, S>); N],
    length: S,
}

/// A point on a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathPoint<S> {
    /// The pose, x along the path.
    pub map_from_target: Pose<Map, Target, S>,
    /// The path's curvature κ there \[1/m].
    pub curvature: S,
}

/// The lengths of a path's segments are not positive, or not finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InvalidPath;

impl core::fmt::Display for InvalidPath {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("not a path: every leg needs a positive, finite length and a finite curvature")
    }
}

impl core::error::Error for InvalidPath {}

impl<S: Scalar, const N: usize> Path<S, N> {
    /// The length of one round \[m].
    pub fn length(&self) -> S {
        self.length
    }

    /// The point `along` \[m] from the start, counted over as many rounds as it takes.
    #[inline]
    pub fn at(&self, along: S) -> PathPoint<S> {
        let rounds = (along / self.length - S::from_f64(0.5)).round();
        let along = along - rounds * self.length;

        let (mut begin, mut pose) = self.starts[0];
        let mut curvature = self.segments[0].curvature;
        for i in 1..N {
            let (start, map_from_start) = self.starts[i];
            let before = along.lt(start);
            begin = S::select(before, begin, start);
            pose = Pose::select(before, pose, map_from_start);
            curvature = S::select(before, curvature, self.segments[i].curvature);
        }
        let length = along - begin;
        let motion = Motion { length, turn: length * curvature };
        PathPoint { map_from_target: pose.integrate(motion, Integration::Arc), curvature }
    }
}

impl<S: Float, const N: usize> Path<S, N> {
    /// The path of `segments` that starts at `start`; that it closes is the caller's to see to.
    ///
    /// # Errors
    /// [`InvalidPath`] for a segment without a positive, finite length, or with a curvature that is not finite.
    pub fn closed(start: Pose<Map, Target, S>, segments: [PathSegment<S>; N]) -> Result<Self, InvalidPath> {
        let is_valid = |segment: &PathSegment<S>| {
            segment.length.is_finite() && segment.length > S::from_f64(0.0) && segment.curvature.is_finite()
        };
        if N == 0 || !segments.iter().all(is_valid) {
            return Err(InvalidPath);
        }
        let mut starts = [(S::from_f64(0.0), start); N];
        let (mut length, mut pose) = (S::from_f64(0.0), start);
        for (begin, segment) in starts.iter_mut().zip(segments) {
            *begin = (length, pose);
            length = length + segment.length;
            let motion = Motion { length: segment.length, turn: segment.length * segment.curvature };
            pose = pose.integrate(motion, Integration::Arc);
        }
        Ok(Self { segments, starts, length })
    }
}

impl<S: Float> Path<S, 8> {
    /// A `width` × `height` rectangle with corners of `radius` \[m], left about, from the start of its lower side.
    ///
    /// # Errors
    /// [`InvalidPath`] where the corners leave no straight between them.
    pub fn rounded_rectangle(
        start: Pose<Map, Target, S>,
        width: S,
        height: S,
        radius: S,
    ) -> Result<Self, InvalidPath> {
        let side = |length: S| PathSegment {
            length: length - S::from_f64(2.0) * radius,
            curvature: S::from_f64(0.0),
        };
        let corner =
            PathSegment { length: radius * S::from_f64(FRAC_PI_2), curvature: S::from_f64(1.0) / radius };
        let (long, short) = (side(width), side(height));
        Self::closed(start, [long, corner, short, corner, long, corner, short, corner])
    }
}

impl<S: Float> Path<S, 6> {
    /// An equilateral triangle of `side` with corners of `radius` \[m], left about, from the start of its lower side.
    ///
    /// # Errors
    /// [`InvalidPath`] where the corners leave no straight between them.
    pub fn rounded_triangle(start: Pose<Map, Target, S>, side: S, radius: S) -> Result<Self, InvalidPath> {
        // A corner of 60° takes radius / tan 30° from each of its sides, and turns by 120°.
        let taken = radius * S::from_f64(3.0).sqrt();
        let straight = PathSegment { length: side - S::from_f64(2.0) * taken, curvature: S::from_f64(0.0) };
        let corner = PathSegment {
            length: radius * S::from_f64(2.0 * PI / 3.0),
            curvature: S::from_f64(1.0) / radius,
        };
        Self::closed(start, [straight, corner, straight, corner, straight, corner])
    }
}

#[cfg(test)]
mod tests {
    use crate::geometry::{Angle, Pose};

    use super::{InvalidPath, Path, PathSegment};

    fn separation(path_end: super::PathPoint<f64>, start: super::PathPoint<f64>) -> f64 {
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
            assert!(
                separation(rectangle.at(along), rectangle.at(along + 1e-9)) < 4e-9,
                "rectangle at {along}"
            );
            assert!(separation(triangle.at(along), triangle.at(along + 1e-9)) < 4e-9, "triangle at {along}");
        }
        assert!(separation(rectangle.at(-0.25), rectangle.at(rectangle.length() - 0.25)) < 1e-12);
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
    fn invalid_paths_are_rejected() {
        let start = Pose::new(0.0, 0.0, Angle::zero());
        assert_eq!(Path::rounded_rectangle(start, 1.0, 2.0, 0.5), Err(InvalidPath));
        assert_eq!(Path::rounded_triangle(start, f64::NAN, 0.5), Err(InvalidPath));
        assert_eq!(
            Path::closed(start, [PathSegment { length: 1.0, curvature: f64::INFINITY }]),
            Err(InvalidPath)
        );
        assert_eq!(Path::<f64, 0>::closed(start, []), Err(InvalidPath));
    }
}
