//! Considered parameters: constant errors of the models that no measurement averages away. [Schmidt1966]; [Bierman1977] Ch. VIII.
//!
//! The error of the estimate is x₀ + A p. The independent error x₀ has the covariance P₀ that the filter factors; p holds
//! the parameters with their given variances, and A is their sensitivity. The joint covariance is that of (x₀, p) times
//! \[\[1, A], \[0, 1]], so it is positive semi-definite by construction, in `f32` too. No parameter is estimated.

mod disagreement;
mod update;

use crate::kinematics::Motion;
use crate::linalg::{Covariance, Matrix};
use crate::scalar::Float;

use super::ekf::{Belief, Ekf, MotionJacobian};
use super::measurement::Measurement;

pub use disagreement::DisagreeingSensor;
pub(super) use disagreement::InnovationSums;
pub(super) use update::observed_row;

/// Standard deviations of the considered parameters; 0 leaves one out.
///
/// An error is true minus assumed value. All of them are constant, independent, and 0 in the mean.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ConsideredParameters<S> {
    /// Bias of the compass \[rad].
    pub compass_bias: S,
    /// Delay of the compass beyond its configured latency \[s].
    pub compass_delay: S,
    /// Position of the laser on the body, along each axis \[m].
    pub laser_position: S,
    /// Direction of the laser on the body \[rad].
    pub laser_heading: S,
    /// Relative error of all ranges.
    pub range_scale: S,
    /// Delay of the laser beyond its configured latency \[s].
    pub laser_delay: S,
    /// Relative error of both wheel radii.
    pub radius_scale: S,
    /// Relative error of the ratio of the wheel radii.
    pub radius_difference: S,
    /// Relative error of the wheel separation.
    pub separation_scale: S,
    /// Position of each wall of the map, across the wall \[m].
    pub wall: S,
}

/// Number of walls whose position errors are distinguished. The least recently used one makes room for another.
const WALLS: usize = 6;
/// Number of parameters: the walls come last.
pub(super) const COUNT: usize = FIRST_WALL + WALLS;

const COMPASS_BIAS: usize = 0;
const COMPASS_DELAY: usize = 1;
const LASER_X: usize = 2;
const LASER_Y: usize = 3;
const LASER_HEADING: usize = 4;
const RANGE_SCALE: usize = 5;
const LASER_DELAY: usize = 6;
const RADIUS_SCALE: usize = 7;
const RADIUS_DIFFERENCE: usize = 8;
const SEPARATION_SCALE: usize = 9;
const FIRST_WALL: usize = 10;

/// Variances of the parameters. Those of the walls are 1: each wall has a standard deviation of its own, which scales the
/// sensitivities instead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Variances<S> {
    pub(super) values: [S; COUNT],
    /// Variance of every wall's position, beyond that of its measurement \[m²].
    wall: S,
}

impl<S: Float> Variances<S> {
    /// Variances without any parameters but the walls of measurements that have an uncertain one.
    pub(super) fn walls_only() -> Self {
        let mut values = [S::from_f64(0.0); COUNT];
        values[FIRST_WALL..].fill(S::from_f64(1.0));
        Self { values, wall: S::from_f64(0.0) }
    }

    /// The variances with `variance` \[m²] more of the position of every wall.
    pub(super) fn with_wall_variance(self, variance: S) -> Self {
        Self { wall: self.wall + variance, ..self }
    }
}

/// Error that each parameter adds to a pose measurement: rows x \[m], y \[m] and θ \[rad].
pub(super) type PoseError<S> = [[S; COUNT]; 3];

impl<S: Float> ConsideredParameters<S> {
    /// Variances; `None` where every deviation is 0.
    pub(super) fn variances(&self) -> Option<Variances<S>> {
        let mut result = Variances::walls_only();
        let deviations = [
            self.compass_bias,
            self.compass_delay,
            self.laser_position,
            self.laser_position,
            self.laser_heading,
            self.range_scale,
            self.laser_delay,
            self.radius_scale,
            self.radius_difference,
            self.separation_scale,
        ];
        for (variance, deviation) in result.values.iter_mut().zip(deviations) {
            *variance = deviation.squared();
        }
        result.wall = self.wall.squared();
        let mut variances = result.values[..FIRST_WALL].iter().chain([&result.wall]);
        // A NaN compares false.
        let is_sound =
            variances.clone().all(|variance| *variance >= S::from_f64(0.0) && variance.is_finite());
        (is_sound && variances.any(|variance| *variance > S::from_f64(0.0))).then_some(result)
    }
}

/// Sensitivity of an estimate, which a step changes, and the variances of the parameters.
pub(super) struct Considered<'a, S> {
    pub(super) sensitivity: &'a mut Sensitivity<S>,
    pub(super) variances: &'a Variances<S>,
}

impl<'a, S> Considered<'a, S> {
    /// Joins the two; `None` where either is absent.
    pub(super) fn join(
        sensitivity: Option<&'a mut Sensitivity<S>>,
        variances: Option<&'a Variances<S>>,
    ) -> Option<Self> {
        sensitivity.zip(variances).map(|(sensitivity, variances)| Self { sensitivity, variances })
    }
}

/// Key of a position error of the map: distance \[m] and direction \[rad] of a wall's line. Whole scans have the
/// distance ∞, and the direction 0 for errors along x, 1 along y. NaN is nothing.
type WallKey<S> = [S; 2];

/// Parameters of the walls: which wall each belongs to, and when it was last used, by the number of uses so far.
#[derive(Clone, Copy, Debug, PartialEq)]
struct WallSlots<S> {
    keys: [WallKey<S>; WALLS],
    used: [u32; WALLS],
    uses: u32,
}

impl<S: Float> WallSlots<S> {
    fn new() -> Self {
        Self { keys: [[S::from_f64(f64::NAN); 2]; WALLS], used: [0; WALLS], uses: 0 }
    }

    /// The parameter of a wall, and whether it was that of another wall, or of none, before.
    fn assign(&mut self, key: WallKey<S>) -> (usize, bool) {
        self.uses = self.uses.saturating_add(1);
        let known = self.keys.iter().position(|other| *other == key);
        let slot = known.or_else(|| (0..WALLS).min_by_key(|slot| self.used[*slot])).unwrap_or(0);
        self.used[slot] = self.uses;
        self.keys[slot] = key;
        (slot, known.is_none())
    }
}

/// Sensitivity A of the estimate to the parameters, and what it needs to go on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sensitivity<S> {
    /// A: rows gyroscope bias \[rad/s], x \[m], y \[m] and θ \[rad].
    pub(super) rows: [[S; COUNT]; 4],
    walls: WallSlots<S>,
    /// Speed \[m/s] and turn rate \[rad/s] of the last odometry interval.
    velocity: Motion<S>,
}

impl<S: Float> Sensitivity<S> {
    /// Sensitivity of an estimate that is independent of all parameters.
    pub(super) fn new() -> Self {
        let zero = S::from_f64(0.0);
        Self {
            rows: [[zero; COUNT]; 4],
            walls: WallSlots::new(),
            velocity: Motion { length: zero, turn: zero },
        }
    }

    /// P₀ + A D Aᵀ, the covariance of the pose.
    pub(super) fn marginal(&self, pose: &Covariance<S, 3>, variances: &Variances<S>) -> Covariance<S, 3> {
        let [_, x, y, heading] = self.rows;
        pose.propagated(
            &Matrix::from_diagonal([S::from_f64(1.0); 3]),
            &Matrix([x, y, heading]),
            variances.values,
        )
    }

    /// Variance that the parameters add to the bias of the gyroscope \[rad²/s²].
    pub(super) fn bias_variance(&self, variances: &Variances<S>) -> S {
        let terms = self.rows[0].iter().zip(&variances.values);
        terms.fold(S::from_f64(0.0), |sum, (a, d)| sum + a.squared() * *d)
    }

    /// Derivative of the turn of `wheels` by the parameters \[rad].
    pub(super) fn turn_error(ekf: &Ekf<S>, wheels: Motion<S>) -> [S; COUNT] {
        let mut turn = [S::from_f64(0.0); COUNT];
        turn[RADIUS_SCALE] = wheels.turn;
        turn[RADIUS_DIFFERENCE] = wheels.length / ekf.drive.wheel_separation;
        turn[SEPARATION_SCALE] = -wheels.turn;
        turn
    }

    /// A after an odometry interval: F A + G, with G the derivative of the motion by the parameters.
    ///
    /// `weight` ∈ [0, 1] is the weight of the gyroscope in the turn, and `measured_time` the time that it measured \[s].
    pub(super) fn predict(
        &mut self,
        ekf: &Ekf<S>,
        wheels: Motion<S>,
        jacobian: &MotionJacobian<S>,
        [weight, measured_time]: [S; 2],
    ) {
        let one = S::from_f64(1.0);
        let [dx, dy] = jacobian.by_heading;
        let mut turn = Self::turn_error(ekf, wheels).map(|turn| turn * (one - weight));
        let mut length = [S::from_f64(0.0); COUNT];
        length[RADIUS_SCALE] = wheels.length;
        length[RADIUS_DIFFERENCE] = wheels.turn * ekf.drive.wheel_separation * S::from_f64(0.25);
        let [bias, x, y, heading] = &mut self.rows;
        let bias_gain = weight * measured_time;
        for k in 0..COUNT {
            turn[k] = turn[k] - bias_gain * bias[k];
            x[k] = x[k] + dx * heading[k] + jacobian.by_length[0] * length[k] + jacobian.by_turn[0] * turn[k];
            y[k] = y[k] + dy * heading[k] + jacobian.by_length[1] * length[k] + jacobian.by_turn[1] * turn[k];
            heading[k] = heading[k] + turn[k];
        }
    }

    /// Takes the velocity of an odometry interval of `duration` \[s]; one of no duration has none.
    pub(super) fn set_velocity(&mut self, motion: Motion<S>, duration: S) {
        if duration > S::from_f64(MIN_DURATION) {
            let rate = S::from_f64(1.0) / duration;
            self.velocity = Motion { length: motion.length * rate, turn: motion.turn * rate };
        }
    }

    /// Error that each parameter adds to `measurement` at `belief`, as a displacement of the measured pose.
    ///
    /// A measurement of a wall, or of a pose without information in some directions, takes its own part of it.
    ///
    /// # Departure
    /// The direction of the laser turns its position about the middle of the axle along with it. The range scale is left out for
    /// whole scans, where opposite walls cancel it.
    fn pose_error(
        &self,
        belief: &Belief<S>,
        measurement: &Measurement<S>,
        walls: [Option<usize>; 2],
        wall_std: S,
    ) -> PoseError<S> {
        let (zero, one) = (S::from_f64(0.0), S::from_f64(1.0));
        let mut error = [[zero; COUNT]; 3];
        let mut set = |k: usize, column: [S; 3]| {
            for (row, value) in error.iter_mut().zip(column) {
                row[k] = value;
            }
        };
        let (sin, cos) = belief.pose.heading.radians().sin_cos();
        let velocity = [self.velocity.length * cos, self.velocity.length * sin, self.velocity.turn];
        match measurement {
            Measurement::Heading(_) => {
                set(COMPASS_BIAS, [zero, zero, one]);
                set(COMPASS_DELAY, velocity);
            }
            Measurement::Line(line) => {
                let (nx, ny) = line.wall.normal();
                let distance = line.wall.distance_from(belief.pose.origin());
                set(RANGE_SCALE, [-(nx * distance), -(ny * distance), zero]);
                if let Some(slot) = walls[0] {
                    set(FIRST_WALL + slot, [-(nx * wall_std), -(ny * wall_std), zero]);
                }
            }
            Measurement::Pose(_) => {
                for (slot, column) in walls.into_iter().zip([[wall_std, zero, zero], [zero, wall_std, zero]])
                {
                    if let Some(slot) = slot {
                        set(FIRST_WALL + slot, column);
                    }
                }
            }
            Measurement::RangeBearing(_) | Measurement::Position(_) => {}
        }
        if matches!(measurement, Measurement::Line(_) | Measurement::Pose(_)) {
            set(LASER_X, [cos, sin, zero]);
            set(LASER_Y, [-sin, cos, zero]);
            set(LASER_HEADING, [zero, zero, one]);
            set(LASER_DELAY, velocity);
        }
        error
    }

    /// Standard deviation of the position of the walls of `measurement` \[m].
    fn wall_std(measurement: &Measurement<S>, variances: &Variances<S>) -> S {
        (variances.wall + measurement.wall_variance()).sqrt()
    }

    /// Lines of the map whose position error is in `measurement`.
    fn wall_keys(measurement: &Measurement<S>) -> [Option<WallKey<S>>; 2] {
        let whole = |axis: f64| Some([S::from_f64(f64::INFINITY), S::from_f64(axis)]);
        match measurement {
            Measurement::Line(line) => [Some([line.wall.distance, line.wall.direction.radians()]), None],
            Measurement::Pose(_) => [whole(0.0), whole(1.0)],
            _ => [None; 2],
        }
    }
}

/// Shortest odometry interval whose speed is known \[s].
const MIN_DURATION: f64 = 1e-6;
