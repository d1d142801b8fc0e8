//! The extended Kalman filter of [Tran2012] Eq. (11)–(18), generic over the scalar and free of branches.

use crate::geometry::{Body, Map, Pose};
use crate::kinematics::{DiffDrive, Integration, Motion, WheelPair};
use crate::linalg::{Covariance, Matrix};
use crate::scalar::Scalar;

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

/// A pose after a motion, with its derivatives.
#[derive(Clone, Copy)]
pub(super) struct MotionJacobian<S> {
    pub(super) pose: Pose<Map, Body, S>,
    /// ∂(x, y)/∂θ.
    pub(super) by_heading: [S; 2],
    /// ∂(x, y, θ)/∂Δs and ∂(x, y, θ)/∂Δθ.
    pub(super) by_length: [S; 3],
    pub(super) by_turn: [S; 3],
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
        self.propagate(belief, odometry, &self.motion(belief.pose, motion))
    }

    /// Belief after `odometry` with the motion that follows from it: [Tran2012] Eq. (12).
    #[inline(always)]
    pub(super) fn propagate(
        &self,
        belief: Belief<S>,
        odometry: WheelOdometry<S>,
        motion: &MotionJacobian<S>,
    ) -> Belief<S> {
        let MotionJacobian { pose, by_heading, by_length, by_turn } = *motion;
        let (zero, one, half) = (S::from_f64(0.0), S::from_f64(1.0), S::from_f64(0.5));
        // Eq. (13), and Eq. (14) by the wheels through Eq. (8).
        let a = Matrix([[one, zero, by_heading[0]], [zero, one, by_heading[1]], [zero, zero, one]]);
        let per_separation = one / self.drive.wheel_separation;
        let row = |i: usize| {
            let (along, swing) = (by_length[i] * half, by_turn[i] * per_separation);
            [along + swing, along - swing]
        };
        let w = Matrix([row(0), row(1), row(2)]);
        let noise = [odometry.variance.right, odometry.variance.left];
        Belief { pose, covariance: belief.covariance.propagated(&a, &w, noise) }
    }

    /// Pose after `motion`, and its derivatives: [Tran2012] Eq. (9), (13), (14).
    #[inline(always)]
    pub(super) fn motion(&self, pose: Pose<Map, Body, S>, motion: Motion<S>) -> MotionJacobian<S> {
        let (chord, chord_slope) = motion.chord_and_derivative(self.integration);
        let (sin, cos) = (pose.heading.radians() + motion.turn * S::from_f64(0.5)).sin_cos();
        let length = motion.length * chord;
        let (dx, dy) = (length * cos, length * sin);
        let (zero, one, half) = (S::from_f64(0.0), S::from_f64(1.0), S::from_f64(0.5));
        let stretch = motion.length * chord_slope;
        MotionJacobian {
            pose: Pose::new(pose.x + dx, pose.y + dy, pose.heading.rotated_by(motion.turn)),
            by_heading: [-dy, dx],
            by_length: [chord * cos, chord * sin, zero],
            by_turn: [stretch * cos - dy * half, stretch * sin + dx * half, one],
        }
    }

    /// Corrects the belief by a measurement inside the gate `nis < threshold`: [Tran2012] Eq. (16)–(18), row by row.
    ///
    #[inline(always)]
    pub fn correct<const M: usize>(
        &self,
        belief: Belief<S>,
        innovation: &Innovation<S, M>,
        threshold: S,
    ) -> Correction<S> {
        let update = innovation.update(&belief.covariance, threshold);
        let (pose, [x, y, heading]) = (belief.pose, update.step);
        Correction {
            belief: Belief {
                pose: Pose::new(pose.x + x, pose.y + y, pose.heading.rotated_by(heading)),
                covariance: update.covariance,
            },
            nis: update.nis,
            accepted: update.accepted,
        }
    }
}
