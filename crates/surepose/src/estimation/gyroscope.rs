//! Gyroscope: the turn of an odometry interval from a yaw rate, with the bias as a fourth state of the filter.

use crate::geometry::{Body, Map, Pose};
use crate::linalg::{Covariance, Matrix};
use crate::scalar::Float;
use crate::time::Stamp;

use super::considered::{Considered, InnovationSums, Sensitivity, Variances, observed_row};
use super::ekf::{Belief, Ekf, MotionJacobian, WheelOdometry};
use super::measurement::{Innovation, Measurement};

/// Innovation of the turn, in standard deviations, beyond which the wheels slip.
const SLIP_STD_DEVS: f64 = 3.0;
/// Ratio of the turn's variance by the wheels to that by the gyroscope below which the wheels measure the bias.
const REST_RATIO: f64 = 0.01;

/// Noise of a gyroscope.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gyroscope<S> {
    /// Standard deviation of one reading \[rad/s], white.
    pub std: S,
    /// Standard deviation of the bias at the start \[rad/s].
    pub bias_std: S,
    /// Random walk of the bias \[rad/s per √s].
    pub bias_walk: S,
}

/// Turn over an odometry interval as the gyroscope measured it, with the bias in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GyroscopeTurn<S> {
    /// Δθ \[rad].
    pub turn: S,
    /// Variance of the white noise of Δθ \[rad²].
    pub variance: S,
    /// Length of the interval \[s].
    pub duration: S,
}

impl<S: Float> GyroscopeTurn<S> {
    /// Fraction ∈ [0, 1] of the interval.
    #[must_use]
    pub(super) fn fraction(self, fraction: S) -> Self {
        Self {
            turn: self.turn * fraction,
            variance: self.variance * fraction,
            duration: self.duration * fraction,
        }
    }
}

/// Estimated bias of the gyroscope and its correlation with the pose.
///
/// The covariance of (b, x, y, θ) is U D Uᵀ with the bias first: the factors of the pose are those of its own covariance, and
/// a filter without a gyroscope is part of this one unchanged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GyroscopeBias<S> {
    /// b \[rad/s].
    pub value: S,
    /// Row of U: b by the independent errors of x, y and θ.
    coupling: [S; 3],
    /// Entry of D: variance of b for a known pose \[rad²/s²].
    variance: S,
}

impl<S: Float> GyroscopeBias<S> {
    /// Bias 0 with standard deviation `std` \[rad/s].
    pub(super) fn new(std: S) -> Self {
        let zero = S::from_f64(0.0);
        Self { value: zero, coupling: [zero; 3], variance: std.squared() }
    }
}

/// Belief and, once the gyroscope was heard, its bias.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FilterState<S> {
    /// Pose, and the covariance of its error without the considered parameters.
    pub(super) belief: Belief<S>,
    pub(super) bias: Option<GyroscopeBias<S>>,
}

impl<S: Float> FilterState<S> {
    pub(super) fn from_belief(belief: Belief<S>) -> Self {
        Self { belief, bias: None }
    }

    /// The belief with the covariance of the whole error.
    pub(super) fn marginal(&self, considered: Option<(&Sensitivity<S>, &Variances<S>)>) -> Belief<S> {
        match considered {
            None => self.belief,
            Some((sensitivity, variances)) => {
                let covariance = sensitivity.marginal(&self.belief.covariance, variances);
                Belief { covariance, ..self.belief }
            }
        }
    }

    /// The state with a pose that was found without the gyroscope: the bias is kept, its correlation with the pose is not.
    pub(super) fn with_new_belief(
        &self,
        belief: Belief<S>,
        considered: Option<(&Sensitivity<S>, &Variances<S>)>,
    ) -> Self {
        let bias = self.bias.map(|bias| {
            let zero = S::from_f64(0.0);
            let own = joint_covariance(&self.belief.covariance, &bias).entry(0, 0);
            let variance =
                considered.map_or(own, |(sensitivity, variances)| own + sensitivity.bias_variance(variances));
            GyroscopeBias { value: bias.value, coupling: [zero; 3], variance }
        });
        Self { belief, bias }
    }

    fn set_joint(&mut self, pose: Pose<Map, Body, S>, value: S, joint: &Covariance<S, 4>) {
        let (upper, diagonal) = joint.factors();
        let trailing = core::array::from_fn(|i| core::array::from_fn(|j| upper[i + 1][j + 1]));
        let covariance = Covariance::from_factors(trailing, [diagonal[1], diagonal[2], diagonal[3]]);
        let coupling = [upper[0][1], upper[0][2], upper[0][3]];
        self.belief = Belief { pose, covariance };
        self.bias = Some(GyroscopeBias { value, coupling, variance: diagonal[0] });
    }
}

/// Covariance of (b, x, y, θ).
fn joint_covariance<S: Float>(pose: &Covariance<S, 3>, bias: &GyroscopeBias<S>) -> Covariance<S, 4> {
    let (upper, diagonal) = pose.factors();
    let zero = S::from_f64(0.0);
    let [x, y, heading] = bias.coupling;
    let row = |i: usize| [zero, upper[i][0], upper[i][1], upper[i][2]];
    let joint = [[zero, x, y, heading], row(0), row(1), row(2)];
    Covariance::from_factors(joint, [bias.variance, diagonal[0], diagonal[1], diagonal[2]])
}

impl<S: Float> Ekf<S> {
    /// Advances the state by an odometry interval in which the gyroscope measured `turn`; `None` for one without a reading.
    ///
    /// Wheels and gyroscope are weighted by their variances: Δθ = (1 − K)·Δθ_w + K·(Δθ_g − b·Δt) with
    /// K = Var(Δθ_w)/(Var(Δθ_w) + Var(Δθ_g)). At rest the wheels are exact, so that K = 0 and the reading measures the bias.
    ///
    /// Wheels that disagree with the gyroscope by more than 3 standard deviations slip: their variance grows by the square of the
    /// difference, and the turn is then the gyroscope's.
    ///
    /// # Departure
    /// [Tran2012] has no gyroscope: a heading between two scans hangs on wheels that may slip.
    pub(super) fn predict_with_gyroscope(
        &self,
        gyroscope: &Gyroscope<S>,
        state: &mut FilterState<S>,
        wheels: WheelOdometry<S>,
        turn: Option<GyroscopeTurn<S>>,
        duration: S,
        mut considered: Option<Considered<'_, S>>,
    ) {
        let Some(bias) = state.bias.or_else(|| turn.map(|_| GyroscopeBias::new(gyroscope.bias_std))) else {
            return self.predict_considered(state, wheels, duration, considered);
        };
        let (zero, one) = (S::from_f64(0.0), S::from_f64(1.0));
        let mut joint = joint_covariance(&state.belief.covariance, &bias);
        let (mut pose, mut value, mut wheels) = (state.belief.pose, bias.value, wheels);
        let by_wheels = self.drive.motion_from_travel(wheels.travel);
        let mut motion = by_wheels;
        let (mut weight, mut measured_variance, mut measured_time) = (zero, zero, zero);
        if let Some(turn) = turn {
            let innovation = turn.turn - value * turn.duration - motion.turn;
            let bias_variance = joint.entry(0, 0) * turn.duration.squared();
            let mut expected = self.turn_variance(&wheels) + turn.variance + bias_variance;
            // Jₑ of the difference between gyroscope and wheels.
            let mut by_parameter = Sensitivity::turn_error(self, by_wheels);
            if let Some(Considered { sensitivity, variances }) = &considered {
                for (k, variance) in variances.values.iter().enumerate() {
                    by_parameter[k] = by_parameter[k] + turn.duration * sensitivity.rows[0][k];
                    expected = expected + by_parameter[k].squared() * *variance;
                }
            }
            let limit = S::from_f64(SLIP_STD_DEVS * SLIP_STD_DEVS) * expected;
            if innovation.squared() > limit {
                wheels = self.with_turn_error(wheels, innovation.squared() - expected);
            }
            let wheel_variance = self.turn_variance(&wheels);
            if wheel_variance <= turn.variance * S::from_f64(REST_RATIO) {
                let row = [turn.duration, zero, zero, zero];
                let variance = turn.variance + wheel_variance;
                let (gain, covariance) = match &mut considered {
                    None => {
                        let seen = joint.observed(row, variance);
                        (seen.gain, seen.covariance)
                    }
                    Some(Considered { sensitivity, variances }) => {
                        let rows = &mut sensitivity.rows;
                        let parameters = &variances.values;
                        let seen = observed_row(&joint, rows, parameters, row, &by_parameter, variance);
                        (seen.gain, seen.covariance)
                    }
                };
                let [bias_gain, x, y, heading] = gain.map(|gain| gain * innovation);
                value = value + bias_gain;
                pose = Pose::new(pose.x + x, pose.y + y, pose.heading.rotated_by(heading));
                joint = covariance;
            }
            weight = wheel_variance.div_or_zero(wheel_variance + turn.variance);
            (measured_variance, measured_time) = (turn.variance, turn.duration);
            let corrected = turn.turn - value * turn.duration;
            motion.turn = motion.turn + weight * (corrected - motion.turn);
        }

        let jacobian = self.motion(pose, motion);
        if let Some(Considered { sensitivity, .. }) = considered {
            sensitivity.predict(self, by_wheels, &jacobian, [weight, measured_time]);
            sensitivity.set_velocity(motion, duration);
        }
        let MotionJacobian { pose, by_heading: [dx, dy], by_length, by_turn } = jacobian;
        let by_bias = by_turn.map(|turn| -(turn * weight * measured_time));
        let a = Matrix([
            [one, zero, zero, zero],
            [by_bias[0], one, zero, dx],
            [by_bias[1], zero, one, dy],
            [by_bias[2], zero, zero, one],
        ]);
        let per_separation = (one - weight) / self.drive.wheel_separation;
        let half = S::from_f64(0.5);
        let row = |i: usize| {
            let (along, swing) = (by_length[i] * half, by_turn[i] * per_separation);
            [along + swing, along - swing, by_turn[i] * weight]
        };
        let w = Matrix([[zero; 3], row(0), row(1), row(2)]);
        let noise = [wheels.variance.right, wheels.variance.left, measured_variance];
        let (upper, mut diagonal) = joint.propagated(&a, &w, noise).factors();
        diagonal[0] = diagonal[0] + gyroscope.bias_walk.squared() * duration;
        let joint = Covariance::from_factors(upper, diagonal);
        state.set_joint(pose, value, &joint);
    }

    /// Advances the state by an odometry interval of `duration` \[s] without a gyroscope.
    pub(super) fn predict_considered(
        &self,
        state: &mut FilterState<S>,
        wheels: WheelOdometry<S>,
        duration: S,
        considered: Option<Considered<'_, S>>,
    ) {
        let Some(Considered { sensitivity, .. }) = considered else {
            state.belief = self.predict(state.belief, wheels);
            return;
        };
        let zero = S::from_f64(0.0);
        let motion = self.drive.motion_from_travel(wheels.travel);
        let jacobian = self.motion(state.belief.pose, motion);
        sensitivity.predict(self, motion, &jacobian, [zero; 2]);
        sensitivity.set_velocity(motion, duration);
        state.belief = self.propagate(state.belief, wheels, &jacobian);
    }

    /// Corrects the state by `measurement`; returns its normalized innovation squared, and whether the gate accepted it.
    ///
    /// A rejected measurement changes nothing.
    pub(super) fn correct_state<const M: usize>(
        &self,
        state: &mut FilterState<S>,
        measurement: &Measurement<S>,
        innovation: &Innovation<S, M>,
        threshold: S,
        considered: Option<Considered<'_, S>>,
        sums: Option<(Stamp, &mut InnovationSums<S>)>,
    ) -> (S, bool) {
        let FilterState { belief, bias } = state;
        let prior = *belief;
        let at = |[x, y, heading]: [S; 3]| {
            Pose::new(prior.pose.x + x, prior.pose.y + y, prior.pose.heading.rotated_by(heading))
        };
        let Some(bias) = bias else {
            let Some(Considered { sensitivity, variances }) = considered else {
                let corrected = self.correct(prior, innovation, threshold);
                *belief = corrected.belief;
                return (corrected.nis, corrected.accepted);
            };
            let covariance = &prior.covariance;
            let update =
                sensitivity.update((covariance, variances), &prior, measurement, innovation, threshold, sums);
            if let Some((step, covariance)) = update.accepted {
                *belief = Belief { pose: at(step), covariance };
            }
            return (update.nis, update.accepted.is_some());
        };
        let (joint, value) = (joint_covariance(&prior.covariance, bias), bias.value);
        let (nis, accepted) = match considered {
            None => {
                let update = innovation.update(&joint, threshold);
                (update.nis, update.accepted.then_some((update.step, update.covariance)))
            }
            Some(Considered { sensitivity, variances }) => {
                let update =
                    sensitivity.update((&joint, variances), &prior, measurement, innovation, threshold, sums);
                (update.nis, update.accepted)
            }
        };
        if let Some(([bias_step, x, y, heading], covariance)) = &accepted {
            state.set_joint(at([*x, *y, *heading]), value + *bias_step, covariance);
        }
        (nis, accepted.is_some())
    }

    /// Variance of the turn by the wheels \[rad²].
    fn turn_variance(&self, wheels: &WheelOdometry<S>) -> S {
        let separation = self.drive.wheel_separation;
        (wheels.variance.right + wheels.variance.left) / separation.squared()
    }

    /// Odometry with `variance` \[rad²] more of its turn, from either wheel alike.
    fn with_turn_error(&self, wheels: WheelOdometry<S>, variance: S) -> WheelOdometry<S> {
        let each = variance * self.drive.wheel_separation.squared() * S::from_f64(0.5);
        let mut wheels = wheels;
        wheels.variance.right = wheels.variance.right + each;
        wheels.variance.left = wheels.variance.left + each;
        wheels
    }
}
