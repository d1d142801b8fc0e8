//! The extended Kalman filter of [Tran2012] Eq. (11)–(18), generic over the scalar and free of branches.

use crate::geometry::{Body, Map, Pose};
use crate::kinematics::{DiffDrive, Integration, WheelPair};
use crate::linalg::{Covariance, Matrix};
use crate::scalar::{Mask, Scalar};

use super::measurement::Innovation;

/// Pose estimate with covariance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Belief<S> {
    /// Estimated pose x̂.
    pub pose: Pose<Map, Body, S>,
    /// Covariance P of (x \[m], y \[m], θ \[rad]), in the map frame.
    pub covariance: Covariance<S, 3>,
}

impl<S: Scalar> Belief<S> {
    /// Belief at `pose` with independent standard deviations of x \[m], y \[m] and θ \[rad].
    #[inline(always)]
    pub fn new(pose: Pose<Map, Body, S>, std: [S; 3]) -> Self {
        Self { pose, covariance: Covariance::from_std(std) }
    }

    /// Estimation error `estimate − truth` (x \[m], y \[m], θ \[rad]), heading wrapped.
    #[inline(always)]
    pub fn error(&self, truth: Pose<Map, Body, S>) -> [S; 3] {
        [self.pose.x - truth.x, self.pose.y - truth.y, (self.pose.heading - truth.heading).radians()]
    }

    /// Normalized estimation error squared, χ² with 3 degrees of freedom for a consistent filter.
    #[inline(always)]
    pub fn nees(&self, truth: Pose<Map, Body, S>) -> S {
        self.covariance.mahalanobis_squared(self.error(truth))
    }
}

/// Wheel travel over an interval, with variances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelOdometry<S> {
    /// Δs_R, Δs_L \[m].
    pub travel: WheelPair<S>,
    /// Their variances \[m²].
    pub variance: WheelPair<S>,
}

impl<S: Scalar> WheelOdometry<S> {
    /// Odometry from the commanded `travel` \[m], with σ equal to its length.
    #[inline]
    pub fn from_command(travel: WheelPair<S>) -> Self {
        Self { travel, variance: WheelPair::new(travel.right.squared(), travel.left.squared()) }
    }

    /// This travel with the further relative standard deviation `relative_std` of wheels that slip; 0 adds nothing.
    #[must_use]
    #[inline]
    pub fn with_slip(self, relative_std: S) -> Self {
        let variance = |travel: S| (travel * relative_std).squared();
        let WheelPair { right, left } = self.variance;
        let slip = WheelPair::new(variance(self.travel.right), variance(self.travel.left));
        Self { variance: WheelPair::new(right + slip.right, left + slip.left), ..self }
    }

    /// Fraction ∈ [0, 1] of this travel, with the same fraction of its variance.
    #[must_use]
    #[inline(always)]
    pub fn fraction(self, fraction: S) -> Self {
        Self { travel: self.travel.scaled(fraction), variance: self.variance.scaled(fraction) }
    }
}

/// Constants of the filter; all state is in the [`Belief`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ekf<S> {
    /// Wheel geometry.
    pub drive: DiffDrive<S>,
    /// δ of [Tran2012] Eq. (15): the *variance* of a wheel speed is δω², its standard deviation √δ·|ω|.
    pub delta: S,
    /// Motion model.
    pub integration: Integration,
}

/// Belief after the test of a measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correction<S: Scalar> {
    /// Corrected belief where accepted, the prior belief elsewhere.
    pub belief: Belief<S>,
    /// Normalized innovation squared, νᵀ (H P Hᵀ + R)⁻¹ ν.
    pub nis: S,
    /// Whether the gate accepted the measurement.
    pub accepted: S::Mask,
}

impl<S: Scalar> Ekf<S> {
    /// Odometry for `travel` \[m] with the variances of [Tran2012] Eq. (15).
    ///
    /// In travel instead of wheel rates the factors Δt·R of Q and of W cancel: Var(Δs) = δΔs².
    #[inline(always)]
    pub fn wheel_odometry(&self, travel: WheelPair<S>) -> WheelOdometry<S> {
        let variance = |travel: S| self.delta * travel.squared();
        WheelOdometry { travel, variance: WheelPair::new(variance(travel.right), variance(travel.left)) }
    }

    /// Belief after `odometry`: [Tran2012] Eq. (11), (12).
    #[must_use]
    #[inline(always)]
    pub fn predict(&self, belief: Belief<S>, odometry: WheelOdometry<S>) -> Belief<S> {
        let motion = self.drive.motion_from_travel(odometry.travel);
        let (chord, chord_slope) = motion.chord_and_derivative(self.integration);
        let (sin, cos) = (belief.pose.heading.radians() + motion.turn * S::from_f64(0.5)).sin_cos();
        let length = motion.length * chord;
        let (dx, dy) = (length * cos, length * sin);
        let (zero, one, half) = (S::from_f64(0.0), S::from_f64(1.0), S::from_f64(0.5));

        // Eq. (13): derivative by the pose.
        let a = Matrix([[one, zero, -dy], [zero, one, dx], [zero, zero, one]]);
        // Eq. (14): derivative by Δs, by Δθ, and by the wheels through Eq. (8).
        let stretch = motion.length * chord_slope;
        let by_turn = [stretch * cos - dy * half, stretch * sin + dx * half, one];
        let by_length = [chord * cos * half, chord * sin * half, zero];
        let per_separation = one / self.drive.wheel_separation;
        let row = |i: usize| {
            let swing = by_turn[i] * per_separation;
            [by_length[i] + swing, by_length[i] - swing]
        };
        let w = Matrix([row(0), row(1), row(2)]);

        let pose =
            Pose::new(belief.pose.x + dx, belief.pose.y + dy, belief.pose.heading.rotated_by(motion.turn));
        let noise = [odometry.variance.right, odometry.variance.left];
        Belief { pose, covariance: belief.covariance.propagated(&a, &w, noise) }
    }

    /// Corrects the belief by a measurement inside the gate `nis < threshold`: [Tran2012] Eq. (16)–(18), row by row.
    ///
    /// The rows of `innovation` carry independent noise, so sequential updates equal the joint update. The sum of their
    /// squared normalized residuals is the joint νᵀS⁻¹ν, and no matrix is inverted.
    #[inline(always)]
    pub fn correct<const M: usize>(
        &self,
        belief: Belief<S>,
        innovation: &Innovation<S, M>,
        threshold: S,
    ) -> Correction<S> {
        let mut step = [S::from_f64(0.0); 3];
        let mut covariance = belief.covariance;
        let mut nis = S::from_f64(0.0);
        let mut max_variance = S::from_f64(0.0);
        for m in 0..M {
            let row = innovation.jacobian[m];
            let seen = covariance.observed(row, innovation.variance[m]);
            let predicted = row[0] * step[0] + row[1] * step[1] + row[2] * step[2];
            let residual = innovation.residual[m] - predicted;
            nis = nis + residual.squared() / seen.variance;
            max_variance = max_variance.max(seen.variance);
            for (component, gain) in step.iter_mut().zip(&seen.gain) {
                *component = *component + *gain * residual;
            }
            covariance = seen.covariance;
        }
        // A NaN compares false and is rejected. A row that overflows is rejected as well: its variance would be
        // infinite.
        let accepted = nis.lt(threshold).and(max_variance.lt(S::from_f64(f64::INFINITY)));
        let pose = belief.pose;
        let keep = |value: S| S::select(accepted, value, S::from_f64(0.0));
        Correction {
            belief: Belief {
                pose: Pose::new(
                    pose.x + keep(step[0]),
                    pose.y + keep(step[1]),
                    pose.heading.rotated_by(keep(step[2])),
                ),
                covariance: Covariance::select(accepted, &covariance, &belief.covariance),
            },
            nis,
            accepted,
        }
    }
}
