//! Which measurements may touch the belief at all.

use crate::scalar::Float;

use super::{Compass, LandmarkSighting, Measurement, PoseFix, PositionFix, WallSighting};
use crate::estimate::outcome::Refusal;

/// Distances beyond this \[m] are broken sensors, not places: their squares would drown the pose in rounding.
const FARTHEST: f64 = 1e6;

impl<S: Float> Measurement<S> {
    /// Whether the values make sense by themselves, whatever the belief.
    ///
    /// # Errors
    /// [`Refusal::NotFinite`] or [`Refusal::BadVariance`].
    pub fn check(&self) -> Result<(), Refusal> {
        match self {
            Self::Compass(compass) => compass.check(),
            Self::Wall(wall) => wall.check(),
            Self::Landmark(landmark) => landmark.check(),
            Self::Position(position) => position.check(),
            Self::Pose(pose) => pose.check(),
        }
    }
}

/// Every value is finite and no farther than a robot can be.
pub(crate) fn finite<S: Float>(values: &[S]) -> Result<(), Refusal> {
    if values.iter().all(|v| v.is_finite() && v.abs() <= S::of(FARTHEST)) {
        Ok(())
    } else {
        Err(Refusal::NotFinite)
    }
}

/// The variances that a sensor can have \[m², rad²]: standard deviations of a picometre and of a million kilometres. Quotients
/// of what lies beyond overflow.
const VARIANCES: (f64, f64) = (1e-24, 1e18);

fn positive<S: Float>(variances: &[S]) -> Result<(), Refusal> {
    let (least, most) = (S::of(VARIANCES.0), S::of(VARIANCES.1));
    // A NaN compares false.
    if variances.iter().all(|v| *v >= least && *v <= most) { Ok(()) } else { Err(Refusal::BadVariance) }
}

fn positive_definite<S: Float>(first: S, second: S, covariance: S) -> Result<(), Refusal> {
    positive(&[first, second])?;
    // As the innovation takes the one out of the other: what passes here is positive there.
    positive(&[second - covariance / first * covariance])
}

impl<S: Float> Compass<S> {
    fn check(&self) -> Result<(), Refusal> {
        finite(&[self.heading.radians()])?;
        positive(&[self.std.squared()])
    }
}

impl<S: Float> WallSighting<S> {
    fn check(&self) -> Result<(), Refusal> {
        finite(&[self.wall.distance, self.wall.direction.radians()])?;
        finite(&[self.seen.distance, self.seen.direction.radians()])?;
        positive_definite(self.distance_variance, self.direction_variance, self.covariance)
    }
}

impl<S: Float> LandmarkSighting<S> {
    fn check(&self) -> Result<(), Refusal> {
        finite(&[self.landmark.x, self.landmark.y, self.range, self.bearing.radians()])?;
        positive(&[self.range_std.squared(), self.bearing_std.squared()])
    }
}

impl<S: Float> PositionFix<S> {
    fn check(&self) -> Result<(), Refusal> {
        finite(&[self.position.x, self.position.y])?;
        positive_definite(self.x_variance, self.y_variance, self.covariance)
    }
}

impl<S: Float> PoseFix<S> {
    fn check(&self) -> Result<(), Refusal> {
        finite(&[self.pose.x, self.pose.y, self.pose.heading.radians()])?;
        // Nothing known of any direction is no measurement; neither is what no sensor knows.
        let diagonal = [0, 1, 2].map(|i| self.information[(i, i)]);
        let any = diagonal.iter().any(|known| *known > S::of(0.0));
        let possible = diagonal.iter().all(|known| *known <= S::of(1.0 / VARIANCES.0));
        if any && possible && self.is_informed() { Ok(()) } else { Err(Refusal::BadVariance) }
    }
}
