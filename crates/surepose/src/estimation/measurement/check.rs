//! Plausibility checks of measurements.

use crate::estimation::outcome::RejectReason;
use crate::scalar::Float;

use super::{
    HeadingMeasurement, LineMeasurement, Measurement, PoseMeasurement, PositionMeasurement,
    RangeBearingMeasurement,
};

/// Maximum distance \[m]. Larger values indicate a broken sensor, and their squares would cause rounding errors.
const MAX_DISTANCE: f64 = 1e6;

impl<S: Float> Measurement<S> {
    /// Checks the values for plausibility, independent of the belief.
    ///
    /// # Errors
    /// [`RejectReason::NotFinite`] or [`RejectReason::BadVariance`].
    pub fn check(&self) -> Result<(), RejectReason> {
        match self {
            Self::Heading(compass) => compass.check(),
            Self::Line(wall) => wall.check(),
            Self::RangeBearing(landmark) => landmark.check(),
            Self::Position(position) => position.check(),
            Self::Pose(pose) => pose.check(),
        }
    }
}

/// Checks that every value is finite and at most the maximum distance.
pub(crate) fn finite<S: Float>(values: &[S]) -> Result<(), RejectReason> {
    if values.iter().all(|v| v.is_finite() && v.abs() <= S::from_f64(MAX_DISTANCE)) {
        Ok(())
    } else {
        Err(RejectReason::NotFinite)
    }
}

/// Range of plausible variances \[m², rad²]: standard deviations of a picometer and of a million kilometers. Quotients
/// of values outside overflow.
const VARIANCE_RANGE: (f64, f64) = (1e-24, 1e18);

fn positive<S: Float>(variances: &[S]) -> Result<(), RejectReason> {
    let (least, most) = (S::from_f64(VARIANCE_RANGE.0), S::from_f64(VARIANCE_RANGE.1));
    // A NaN compares false.
    if variances.iter().all(|v| *v >= least && *v <= most) { Ok(()) } else { Err(RejectReason::BadVariance) }
}

fn positive_definite<S: Float>(first: S, second: S, covariance: S) -> Result<(), RejectReason> {
    positive(&[first, second])?;
    // The innovation subtracts in the same way: what passes here is positive there.
    positive(&[second - covariance / first * covariance])
}

impl<S: Float> HeadingMeasurement<S> {
    fn check(&self) -> Result<(), RejectReason> {
        finite(&[self.heading.radians()])?;
        positive(&[self.std.squared()])
    }
}

impl<S: Float> LineMeasurement<S> {
    fn check(&self) -> Result<(), RejectReason> {
        finite(&[self.wall.distance, self.wall.direction.radians()])?;
        finite(&[self.seen.distance, self.seen.direction.radians()])?;
        positive_definite(self.distance_variance, self.direction_variance, self.covariance)?;
        // A NaN compares false; 0 is an exact wall.
        let known =
            self.wall_variance >= S::from_f64(0.0) && self.wall_variance <= S::from_f64(VARIANCE_RANGE.1);
        if known { Ok(()) } else { Err(RejectReason::BadVariance) }
    }
}

impl<S: Float> RangeBearingMeasurement<S> {
    fn check(&self) -> Result<(), RejectReason> {
        finite(&[self.landmark.x, self.landmark.y, self.range, self.bearing.radians()])?;
        positive(&[self.range_std.squared(), self.bearing_std.squared()])
    }
}

impl<S: Float> PositionMeasurement<S> {
    fn check(&self) -> Result<(), RejectReason> {
        finite(&[self.position.x, self.position.y])?;
        positive_definite(self.x_variance, self.y_variance, self.covariance)
    }
}

impl<S: Float> PoseMeasurement<S> {
    fn check(&self) -> Result<(), RejectReason> {
        finite(&[self.pose.x, self.pose.y, self.pose.heading.radians()])?;
        // A pose without information in any direction is invalid, as is one more precise than any sensor.
        let diagonal = [0, 1, 2].map(|i| self.information[(i, i)]);
        let any = diagonal.iter().any(|known| *known > S::from_f64(0.0));
        let possible = diagonal.iter().all(|known| *known <= S::from_f64(1.0 / VARIANCE_RANGE.0));
        if any && possible && self.is_valid() { Ok(()) } else { Err(RejectReason::BadVariance) }
    }
}
