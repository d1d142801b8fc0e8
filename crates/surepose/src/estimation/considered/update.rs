//! Measurement update of an estimate with considered parameters, row by row.

use crate::estimation::ekf::Belief;
use crate::estimation::measurement::{Innovation, Measurement};
use crate::linalg::Covariance;
use crate::scalar::Float;
use crate::time::Stamp;

use super::disagreement::{
    COMPASS, FIRST_WALL_CHANNEL, InnovationSums, LENGTHWISE, SIDEWAYS, ScalarInnovation,
};
use super::{COUNT, FIRST_WALL, Sensitivity, Variances};

/// Update by one scalar row.
pub(in crate::estimation) struct ObservedRow<S, const N: usize> {
    /// Column of the gain.
    pub(in crate::estimation) gain: [S; N],
    /// Variance of the innovation, with the part of the parameters.
    pub(in crate::estimation) variance: S,
    /// Variance of the innovation without the parameters.
    pub(in crate::estimation) own_variance: S,
    /// P₀ after the row.
    pub(in crate::estimation) covariance: Covariance<S, N>,
}

/// Updates P₀ (`joint`) and A (`rows`) by a scalar with Jacobian `row` and noise `variance`.
///
/// `by_parameter` is Jₑ, the derivative of the innovation by the parameters: that of the measurement plus H A. With
/// D the variances of the parameters, S = H P₀ Hᵀ + Jₑ D Jₑᵀ + R and the Schmidt gain is K = (P₀ Hᵀ + A D Jₑᵀ)/S. Then
/// A′ = A − K Jₑ. P₀′ is the Joseph form for this gain, which is the optimal downdate plus (K − K₀) S₀ (K − K₀)ᵀ, where K₀ and
/// S₀ belong to P₀ alone: no difference is taken. [Schmidt1966]; [Zanetti2013].
#[inline(always)]
pub(in crate::estimation) fn observed_row<S: Float, const N: usize>(
    joint: &Covariance<S, N>,
    rows: &mut [[S; COUNT]; N],
    variances: &[S; COUNT],
    row: [S; N],
    by_parameter: &[S; COUNT],
    variance: S,
) -> ObservedRow<S, N> {
    let optimal = joint.observed(row, variance);
    let mut weighted = *variances;
    for (weighted, by_parameter) in weighted.iter_mut().zip(by_parameter) {
        *weighted = *weighted * *by_parameter;
    }
    let total = optimal.variance + dot(&weighted, by_parameter);
    let share = S::from_f64(1.0) / total;
    let mut gain = [S::from_f64(0.0); N];
    let mut excess = gain;
    for i in 0..N {
        gain[i] = (optimal.gain[i] * optimal.variance + dot(&rows[i], &weighted)) * share;
        excess[i] = gain[i] - optimal.gain[i];
        for k in 0..COUNT {
            rows[i][k] = rows[i][k] - gain[i] * by_parameter[k];
        }
    }
    let covariance = optimal.covariance.with_rank_one(excess, optimal.variance);
    ObservedRow { gain, variance: total, own_variance: optimal.variance, covariance }
}

/// Scalar product by four partial sums, which the compiler keeps in one vector register.
#[inline(always)]
fn dot<S: Float>(a: &[S; COUNT], b: &[S; COUNT]) -> S {
    const { assert!(COUNT % 4 == 0, "the partial sums have the same number of terms") };
    let mut sums = [S::from_f64(0.0); 4];
    for k in (0..COUNT).step_by(4) {
        for (lane, sum) in sums.iter_mut().enumerate() {
            *sum = *sum + a[k + lane] * b[k + lane];
        }
    }
    (sums[0] + sums[2]) + (sums[1] + sums[3])
}

/// Step of the state and its covariance after a gated measurement; `None` where it was rejected.
pub(in crate::estimation) struct ConsideredUpdate<S, const N: usize> {
    pub(in crate::estimation) accepted: Option<([S; N], Covariance<S, N>)>,
    pub(in crate::estimation) nis: S,
}

impl<S: Float> Sensitivity<S> {
    /// Updates a state of `N` ≥ 3 components that ends with the pose, inside the gate `nis < threshold`; `sums` take the innovations.
    ///
    /// Rows follow each other as in [`Innovation::update`]. Their innovations share the parameters, so their normalized squares
    /// have the mean of χ² and a larger spread.
    #[inline(always)]
    pub(in crate::estimation) fn update<const N: usize, const M: usize>(
        &mut self,
        (prior, variances): (&Covariance<S, N>, &Variances<S>),
        belief: &Belief<S>,
        measurement: &Measurement<S>,
        innovation: &Innovation<S, M>,
        threshold: S,
        sums: Option<(Stamp, &mut InnovationSums<S>)>,
    ) -> ConsideredUpdate<S, N> {
        const { assert!(N == 3 || N == 4, "the state is a pose, and the bias of a gyroscope before it") };
        let zero = S::from_f64(0.0);
        let mut covariance = *prior;
        let mut rows = [[zero; COUNT]; N];
        rows.copy_from_slice(&self.rows[4 - N..]);
        let mut walls = self.walls;
        let mut slots = [None; 2];
        let mut new_wall = None;
        let wall_std = Self::wall_std(measurement, variances);
        if wall_std > zero {
            for (slot, key) in slots.iter_mut().zip(Self::wall_keys(measurement)) {
                let Some((number, is_new)) = key.map(|key| walls.assign(key)) else { continue };
                *slot = Some(number);
                if is_new {
                    new_wall = Some(number);
                    // The error of the wall that is forgotten becomes part of the independent one.
                    let column =
                        rows.each_mut().map(|row| core::mem::replace(&mut row[FIRST_WALL + number], zero));
                    covariance = covariance.with_rank_one(column, variances.values[FIRST_WALL + number]);
                }
            }
        }
        let pose_error = self.pose_error(belief, measurement, slots, wall_std);
        let mut step = [zero; N];
        let (mut nis, mut max_variance) = (zero, zero);
        let mut innovations =
            [ScalarInnovation { residual: zero, variance: zero, by_parameter: [zero; COUNT] }; M];
        for m in 0..M {
            let mut row = [zero; N];
            let mut by_parameter = [zero; COUNT];
            let mut predicted = zero;
            for i in 0..3 {
                let entry = innovation.jacobian[m][i];
                row[N - 3 + i] = entry;
                predicted = predicted + entry * step[N - 3 + i];
                for k in 0..COUNT {
                    by_parameter[k] = by_parameter[k] + entry * (rows[N - 3 + i][k] + pose_error[i][k]);
                }
            }
            let residual = innovation.residual[m] - predicted;
            let seen = observed_row(
                &covariance,
                &mut rows,
                &variances.values,
                row,
                &by_parameter,
                innovation.variance[m],
            );
            nis = nis + residual.squared() / seen.variance;
            max_variance = max_variance.max(seen.variance);
            innovations[m] = ScalarInnovation { residual, variance: seen.own_variance, by_parameter };
            for (component, gain) in step.iter_mut().zip(&seen.gain) {
                *component = *component + *gain * residual;
            }
            covariance = seen.covariance;
        }
        // A NaN compares false.
        let is_accepted = nis < threshold && max_variance < S::from_f64(f64::INFINITY);
        if is_accepted {
            if let Some((stamp, sums)) = sums {
                if let Some(slot) = new_wall {
                    sums.forget_wall(slot);
                }
                for (m, innovation) in innovations.iter().enumerate() {
                    self.note(sums, stamp, belief, measurement, [m, slots[0].unwrap_or(COUNT)], innovation);
                }
            }
            self.rows[4 - N..].copy_from_slice(&rows);
            self.walls = walls;
        }
        ConsideredUpdate { accepted: is_accepted.then_some((step, covariance)), nis }
    }

    /// Adds row `m` of a measurement to the sums of its channels; `slot` is that of its wall.
    fn note(
        &self,
        sums: &mut InnovationSums<S>,
        stamp: Stamp,
        belief: &Belief<S>,
        measurement: &Measurement<S>,
        [m, slot]: [usize; 2],
        innovation: &ScalarInnovation<S>,
    ) {
        let along = |sums: &mut InnovationSums<S>, x: S, y: S| {
            let (sin, cos) = belief.pose.heading.radians().sin_cos();
            sums.add(SIDEWAYS, stamp, y * cos - x * sin, innovation);
            // Slip moves a robot lengthwise, too, but in the same direction for either turn.
            let turn_rate = self.velocity.turn;
            sums.add(LENGTHWISE, stamp, (x * cos + y * sin) * turn_rate, innovation);
        };
        match measurement {
            Measurement::Heading(_) => sums.add(COMPASS, stamp, S::from_f64(1.0), innovation),
            // The direction of a wall does not depend on the laser's position.
            Measurement::Line(line) if m == 0 => {
                let (nx, ny) = line.wall.normal();
                along(sums, -nx, -ny);
                sums.add(FIRST_WALL_CHANNEL + slot, stamp, S::from_f64(1.0), innovation);
            }
            Measurement::Pose(_) if m < 2 => {
                let [x, y] = [S::from_f64(1.0 - m as f64), S::from_f64(m as f64)];
                along(sums, x, y);
            }
            _ => {}
        }
    }
}
