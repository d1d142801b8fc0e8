//! Measurements of the pose and their innovations: residual, Jacobian, variance.

mod check;

mod innovation;
mod pose_measurement;

pub(super) use check::finite;
pub use innovation::Innovation;
pub use pose_measurement::PoseMeasurement;

use crate::geometry::{Angle, Body, Line, Map, Point};
use crate::scalar::Scalar;

use super::ekf::Belief;

/// Absolute heading, for example from a compass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadingMeasurement<S> {
    /// θ in the map frame, corrected for mounting offset and declination.
    pub heading: Angle<S>,
    /// Standard deviation \[rad].
    pub std: S,
}

/// A wall of the map, measured by the laser.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineMeasurement<S> {
    /// Wall line in the map.
    pub wall: Line<Map, S>,
    /// Measured line in the body frame; the normal may point either way.
    pub seen: Line<Body, S>,
    /// Variance of the measured distance r \[m²].
    pub distance_variance: S,
    /// Variance of the measured direction ψ \[rad²].
    pub direction_variance: S,
    /// Covariance of distance and direction \[m·rad].
    pub covariance: S,
    /// Variance of the wall's position in the map, along its normal \[m²]; 0 for an exact map. It is the error of all
    /// measurements of this wall, so that no number of them averages it away.
    pub wall_variance: S,
}

/// Range and bearing of a known landmark.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RangeBearingMeasurement<S> {
    /// Position of the landmark.
    pub landmark: Point<Map, S>,
    /// Distance from the body origin \[m].
    pub range: S,
    /// Direction from the x axis of the body.
    pub bearing: Angle<S>,
    /// Standard deviation of the range \[m].
    pub range_std: S,
    /// Standard deviation of the bearing \[rad].
    pub bearing_std: S,
}

/// Absolute position, for example from beacons or an overhead camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PositionMeasurement<S> {
    /// Position of the body origin.
    pub position: Point<Map, S>,
    /// Variance of x \[m²].
    pub x_variance: S,
    /// Variance of y \[m²].
    pub y_variance: S,
    /// Covariance of x and y \[m²].
    pub covariance: S,
}

/// A measurement of any type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measurement<S> {
    /// An absolute heading.
    Heading(HeadingMeasurement<S>),
    /// A wall of the map.
    Line(LineMeasurement<S>),
    /// A known landmark.
    RangeBearing(RangeBearingMeasurement<S>),
    /// An absolute position.
    Position(PositionMeasurement<S>),
    /// A whole pose, possibly without information in some directions.
    Pose(PoseMeasurement<S>),
}

impl<S: Scalar> Measurement<S> {
    /// Variance of the position of the measured wall \[m²]; 0 for other measurements.
    pub(super) fn wall_variance(&self) -> S {
        match self {
            Self::Line(line) => line.wall_variance,
            _ => S::from_f64(0.0),
        }
    }
}

impl<S> Measurement<S> {
    /// Number of measured components.
    pub const fn dimension(&self) -> usize {
        match self {
            Self::Heading(_) => 1,
            Self::Line(_) | Self::RangeBearing(_) | Self::Position(_) => 2,
            Self::Pose(_) => 3,
        }
    }
}

impl<S: Scalar> HeadingMeasurement<S> {
    /// ν = z − θ, wrapped.
    #[inline(always)]
    pub fn innovation(&self, belief: &Belief<S>) -> Innovation<S, 1> {
        let (zero, one) = (S::from_f64(0.0), S::from_f64(1.0));
        Innovation {
            residual: [(self.heading - belief.pose.heading).radians()],
            jacobian: [[zero, zero, one]],
            variance: [self.std.squared()],
        }
    }
}

impl<S: Scalar> LineMeasurement<S> {
    /// ν of (r, ψ): the wall lies at r = r_m − p·n_m and ψ = ψ_m − θ in the body frame.
    ///
    /// A wall is visible from both sides, so the measured normal is first turned to the side of the normal in the map.
    #[inline(always)]
    pub fn innovation(&self, belief: &Belief<S>) -> Innovation<S, 2> {
        let (zero, one) = (S::from_f64(0.0), S::from_f64(1.0));
        let pose = &belief.pose;
        let turned = self.seen.direction - (self.wall.direction - pose.heading);
        let behind = turned.radians().abs().gt(S::from_f64(core::f64::consts::FRAC_PI_2));
        let side = S::select(behind, -one, one);
        let opposite = turned + Angle::half_turn();
        let direction = S::select(behind, opposite.radians(), turned.radians());
        let distance = self.seen.distance * side - self.wall.distance_from(pose.origin());
        let (nx, ny) = self.wall.normal();
        Innovation::with_correlated_pair(
            [distance, direction],
            [[-nx, -ny, zero], [zero, zero, -one]],
            [self.distance_variance, self.direction_variance],
            self.covariance * side,
        )
    }
}

impl<S: Scalar> RangeBearingMeasurement<S> {
    /// ν of (range, bearing) of a known point.
    #[inline(always)]
    pub fn innovation(&self, belief: &Belief<S>) -> Innovation<S, 2> {
        let (zero, one) = (S::from_f64(0.0), S::from_f64(1.0));
        let pose = &belief.pose;
        let (dx, dy) = (self.landmark.x - pose.x, self.landmark.y - pose.y);
        let range = (dx.squared() + dy.squared()).sqrt();
        let bearing = Angle::from_vector(dx, dy) - pose.heading;
        // At the landmark itself the bearing is undefined: its Jacobian is then 0, not infinite.
        let per_range = one.div_or_zero(range);
        let (cos, sin) = (dx * per_range, dy * per_range);
        Innovation {
            residual: [self.range - range, (self.bearing - bearing).radians()],
            jacobian: [[-cos, -sin, zero], [sin * per_range, -cos * per_range, -one]],
            variance: [self.range_std.squared(), self.bearing_std.squared()],
        }
    }
}

impl<S: Scalar> PositionMeasurement<S> {
    /// ν = z − (x, y).
    #[inline(always)]
    pub fn innovation(&self, belief: &Belief<S>) -> Innovation<S, 2> {
        let (zero, one) = (S::from_f64(0.0), S::from_f64(1.0));
        Innovation::with_correlated_pair(
            [self.position.x - belief.pose.x, self.position.y - belief.pose.y],
            [[one, zero, zero], [zero, one, zero]],
            [self.x_variance, self.y_variance],
            self.covariance,
        )
    }
}
