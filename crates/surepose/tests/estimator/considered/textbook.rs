//! The Schmidt–Kalman filter of the textbooks, dense.

use super::{SEPARATION, STATES, WALLS, parameter_std};

/// The textbook's filter: one dense covariance of pose and parameters, Joseph's form, and derivatives by differences.
pub(super) struct Textbook {
    pub(super) pose: [f64; 3],
    pub(super) covariance: [[f64; STATES]; STATES],
    /// Speed and turn rate.
    pub(super) velocity: [f64; 2],
}

type Row = [f64; STATES];

impl Textbook {
    pub(super) fn new() -> Self {
        let mut covariance = [[0.0; STATES]; STATES];
        let deviations = [0.05, 0.04, 0.03].into_iter().chain(parameter_std());
        for (i, std) in deviations.enumerate() {
            covariance[i][i] = std * std;
        }
        Self { pose: [0.0; 3], covariance, velocity: [0.0; 2] }
    }

    /// Central difference of `value` by each of the states, at the pose and parameters 0.
    fn derivative<const M: usize>(&self, value: impl Fn(&Row) -> [f64; M]) -> [Row; M] {
        let mut result = [[0.0; STATES]; M];
        for i in 0..STATES {
            let moved = |step: f64| {
                let mut state = [0.0; STATES];
                state[..3].copy_from_slice(&self.pose);
                state[i] += step;
                value(&state)
            };
            let (high, low) = (moved(1e-5), moved(-1e-5));
            for m in 0..M {
                result[m][i] = (high[m] - low[m]) / 2e-5;
            }
        }
        result
    }

    pub(super) fn predict(&mut self, travel: [f64; 2], variance: [f64; 2], duration: f64) {
        let step = |state: &Row, extra: [f64; 2]| {
            let (scale, ratio, separation) = (state[3 + 7], state[3 + 8], state[3 + 9]);
            let right = (travel[0] + extra[0]) * (1.0 + scale) * (1.0 + 0.5 * ratio);
            let left = (travel[1] + extra[1]) * (1.0 + scale) * (1.0 - 0.5 * ratio);
            let (length, turn) = (0.5 * (right + left), (right - left) / (SEPARATION * (1.0 + separation)));
            let chord = if turn == 0.0 { 1.0 } else { (0.5 * turn).sin() / (0.5 * turn) };
            let middle = state[2] + 0.5 * turn;
            let (x, y) = (length * chord * middle.cos(), length * chord * middle.sin());
            [state[0] + x, state[1] + y, state[2] + turn]
        };
        let by_state = self.derivative(|state| step(state, [0.0; 2]));
        let mut now = [0.0; STATES];
        now[..3].copy_from_slice(&self.pose);
        let by_wheel = [[1e-5, 0.0], [0.0, 1e-5]].map(|extra| {
            let (high, low) = (step(&now, extra), step(&now, extra.map(|e| -e)));
            [0, 1, 2].map(|i| (high[i] - low[i]) / 2e-5)
        });
        let mut transition = [[0.0; STATES]; STATES];
        for (i, row) in transition.iter_mut().enumerate() {
            row[i] = 1.0;
        }
        transition[..3].copy_from_slice(&by_state);
        self.covariance = congruence(&transition, &self.covariance);
        for (wheel, variance) in by_wheel.iter().zip(variance) {
            for i in 0..3 {
                for j in 0..3 {
                    self.covariance[i][j] += wheel[i] * variance * wheel[j];
                }
            }
        }
        self.pose = step(&now, [0.0; 2]);
        let (length, turn) = (0.5 * (travel[0] + travel[1]), (travel[0] - travel[1]) / SEPARATION);
        self.velocity = [length / duration, turn / duration];
    }

    /// Rows of `measured`, each with its own noise: only the gain of the pose is used.
    pub(super) fn update<const M: usize>(
        &mut self,
        measured: [f64; M],
        std: [f64; M],
        model: impl Fn(&Row) -> [f64; M],
    ) {
        let mut here = [0.0; STATES];
        here[..3].copy_from_slice(&self.pose);
        let expected = model(&here);
        let jacobian = self.derivative(model);
        let start = self.pose;
        for m in 0..M {
            let row = jacobian[m];
            let p = &self.covariance;
            let ph: [f64; STATES] =
                core::array::from_fn(|i| (0..STATES).map(|j| p[i][j] * row[j]).sum::<f64>());
            let noise = std[m] * std[m];
            let total = (0..STATES).map(|i| row[i] * ph[i]).sum::<f64>() + noise;
            let gain: [f64; STATES] = core::array::from_fn(|i| if i < 3 { ph[i] / total } else { 0.0 });
            let moved: f64 = (0..3).map(|i| row[i] * (self.pose[i] - start[i])).sum();
            let residual = measured[m] - expected[m] - moved;
            let mut rest = [[0.0; STATES]; STATES];
            for i in 0..STATES {
                for j in 0..STATES {
                    rest[i][j] = f64::from(u8::from(i == j)) - gain[i] * row[j];
                }
            }
            self.covariance = congruence(&rest, &self.covariance);
            for i in 0..3 {
                self.pose[i] += gain[i] * residual;
                for j in 0..3 {
                    self.covariance[i][j] += gain[i] * noise * gain[j];
                }
            }
        }
    }

    /// The pose `delay` later.
    fn delayed(&self, state: &Row, delay: f64) -> [f64; 3] {
        let [v, omega] = self.velocity;
        let (sin, cos) = state[2].sin_cos();
        [state[0] + delay * v * cos, state[1] + delay * v * sin, state[2] + delay * omega]
    }

    pub(super) fn heading(&self, state: &Row) -> [f64; 1] {
        [self.delayed(state, state[3 + 1])[2] + state[3]]
    }

    /// Distance and direction of a wall, as a laser on the middle of the axle reports them.
    pub(super) fn wall(&self, state: &Row, wall: usize) -> [f64; 2] {
        let pose = self.delayed(state, state[3 + 6]);
        let [x, y, heading] = [state[3 + 2], state[3 + 3], state[3 + 4]];
        let (sin, cos) = pose[2].sin_cos();
        let laser = [pose[0] + x * cos - y * sin, pose[1] + x * sin + y * cos];
        let (distance, direction) = WALLS[wall];
        let distance = distance + state[3 + 10 + wall];
        let range = distance - laser[0] * direction.cos() - laser[1] * direction.sin();
        [range * (1.0 + state[3 + 5]), direction - pose[2] - heading]
    }
}

/// T P Tᵀ.
fn congruence(t: &[Row; STATES], p: &[Row; STATES]) -> [Row; STATES] {
    let product = |a: &[Row; STATES], b: &[Row; STATES], transposed: bool| {
        let mut result = [[0.0; STATES]; STATES];
        for i in 0..STATES {
            for j in 0..STATES {
                let term = |k: usize| a[i][k] * if transposed { b[j][k] } else { b[k][j] };
                result[i][j] = (0..STATES).map(term).sum();
            }
        }
        result
    };
    product(&product(t, p, false), t, true)
}
