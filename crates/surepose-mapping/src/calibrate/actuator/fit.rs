//! Search for the base that explains the response.

use nalgebra::{DMatrix, DVector};
use surepose::param::{self, Parameter};
use surepose_sim::PlantModel;

use super::response::Response;

/// Alternations over all parameters.
const ROUNDS: usize = 3;
/// Largest delay that is tried \[s], and the distance between the first trials.
const MAX_DELAY: f64 = 1.0;
const DELAY_STEP: f64 = 0.02;
/// Lags \[s] and limits of the acceleration \[m/s²] at which the fit starts.
const STARTS: [(f64, f64); 7] = [
    (0.0, f64::INFINITY),
    (0.05, f64::INFINITY),
    (0.3, f64::INFINITY),
    (0.0, 0.2),
    (0.0, 0.6),
    (0.0, 2.0),
    (0.1, 0.6),
];
/// Largest minimum speed that is tried, as a fraction of the largest speed, and the number of trials.
const MAX_DEADBAND: f64 = 0.5;
const TRIED_DEADBANDS: f64 = 100.0;
/// Most steps that improve all continuous parameters together.
const POLISHING_STEPS: usize = 20;

/// Value of a parameter in a model of the base.
pub(super) type Access = fn(&mut PlantModel) -> &mut f64;

/// A parameter in which the response is continuous.
pub(super) struct Smooth {
    pub(super) parameter: &'static Parameter,
    pub(super) access: Access,
    /// Value of a base without it; `None` where every value is one.
    pub(super) neutral: Option<f64>,
    /// Motion that excites it.
    pub(super) motion: &'static str,
}

/// All of them, the delay first.
pub(super) const SMOOTH: [Smooth; 4] = [
    Smooth {
        parameter: &param::COMMAND_DELAY,
        access: |model| &mut model.command_delay,
        neutral: None,
        motion: "changes of the commanded speed",
    },
    Smooth {
        parameter: &param::MOTOR_TIME_CONSTANT,
        access: |model| &mut model.lag,
        neutral: Some(0.0),
        motion: "steps of the commanded speed",
    },
    Smooth {
        parameter: &param::WHEEL_ACCELERATION_LIMIT,
        access: |model| &mut model.wheel_acceleration,
        neutral: Some(f64::INFINITY),
        motion: "commands that accelerate more than the wheels can",
    },
    Smooth {
        parameter: &param::WHEEL_DECELERATION_LIMIT,
        access: |model| &mut model.wheel_deceleration,
        neutral: Some(f64::INFINITY),
        motion: "commands that brake more than the wheels can",
    },
];

/// A minimum speed: its parameter, and the values that are tried.
pub(super) struct Minimum {
    pub(super) parameter: &'static Parameter,
    pub(super) access: Access,
    pub(super) values: fn(&Response) -> Vec<f64>,
}

/// Speeds that the base ignores: of the base, or of each wheel.
const OF_BASE: &[Minimum] = &[
    Minimum { parameter: &param::MIN_SPEED, access: |model| &mut model.min_speed, values: speeds },
    Minimum {
        parameter: &param::MIN_TURN_RATE,
        access: |model| &mut model.min_turn_rate,
        values: turn_rates,
    },
];
const OF_WHEELS: &[Minimum] = &[Minimum {
    parameter: &param::MIN_WHEEL_SPEED,
    access: |model| &mut model.min_wheel_speed,
    values: rim_speeds,
}];

/// The base of best fit, with its sum of squares.
#[derive(Clone, Copy)]
pub(super) struct Fitted {
    pub(super) model: PlantModel,
    pub(super) cost: f64,
}

/// The best fit, and the minimum speeds that it may have.
pub(super) fn fit(response: &Response) -> (Fitted, &'static [Minimum]) {
    let [base, wheels] = [OF_BASE, OF_WHEELS].map(|minima| fitted(response, minima));
    if wheels.cost < base.cost { (wheels, OF_WHEELS) } else { (base, OF_BASE) }
}

/// The best fit with minimum speeds of one kind.
///
/// A lag, a limit and a delay replace each other, so that one of them is not found at values of the others for which it
/// is absent. The fit therefore starts at several of them.
fn fitted(response: &Response, minima: &[Minimum]) -> Fitted {
    let [delay, ..] = &SMOOTH;
    let starts = STARTS.map(|(lag, limit)| {
        let model = PlantModel {
            lag,
            wheel_acceleration: limit,
            wheel_deceleration: limit,
            // A wheel at its limit does not follow, whatever its command.
            wheel_speed: response.max_speed,
            ..PlantModel::default()
        };
        let mut fit = Fitted { model, cost: response.cost(&model) };
        fit.search(response, delay.access, &delays());
        fit.polish(response);
        fit
    });
    let best = |fits: &[Fitted]| fits.iter().copied().min_by(|a, b| a.cost.total_cmp(&b.cost));
    let Some(mut fit) = best(&starts) else { return starts[0] };
    for _ in 0..ROUNDS {
        for Minimum { access, values, .. } in minima {
            let values = values(response);
            let spacing = values.last().map_or(0.0, |largest| largest / TRIED_DEADBANDS);
            fit.search(response, *access, &downsampled(&values, spacing));
            // Then the values between.
            let found = *access(&mut fit.model);
            let near = values.iter().copied().filter(|value| (value - found).abs() <= 2.0 * spacing);
            fit.search(response, *access, &downsampled(&near.collect::<Vec<_>>(), 0.05 * spacing));
        }
        fit.polish(response);
    }
    fit
}

impl Fitted {
    /// The best fit without `held`, which the other continuous parameters replace as far as they can.
    pub(super) fn without(&self, response: &Response, held: &Smooth) -> Self {
        let mut model = self.model;
        *(held.access)(&mut model) = held.neutral.unwrap_or(0.0);
        let mut reduced = Self { model, cost: response.cost(&model) };
        let [delay, ..] = &SMOOTH;
        reduced.search(response, delay.access, &delays());
        reduced.polish(response);
        reduced
    }

    /// Continuous parameters that the model has.
    pub(super) fn present(&self) -> impl Iterator<Item = &'static Smooth> + '_ {
        SMOOTH.iter().filter(|smooth| {
            let value = *(smooth.access)(&mut { self.model });
            smooth.neutral.is_none_or(|neutral| value.total_cmp(&neutral).is_ne())
        })
    }

    /// Takes the best of `values`, if it is better than the present one.
    fn search(&mut self, response: &Response, access: Access, values: &[f64]) {
        for value in values {
            let mut model = self.model;
            *access(&mut model) = *value;
            self.take(response, model);
        }
    }

    /// Improves the present continuous parameters together, by damped Gauss–Newton steps [Levenberg1944].
    fn polish(&mut self, response: &Response) {
        let free: Vec<Access> = self.present().map(|smooth| smooth.access).collect();
        let mut damping = 1e-3;
        for _ in 0..POLISHING_STEPS {
            let (residuals, jacobian) = linearized(response, &self.model, &free);
            let mut normal = jacobian.transpose() * &jacobian;
            for i in 0..free.len() {
                normal[(i, i)] *= 1.0 + damping;
            }
            let Some(step) =
                normal.cholesky().map(|normal| normal.solve(&(jacobian.transpose() * residuals)))
            else {
                return;
            };
            let mut model = self.model;
            for (access, step) in free.iter().zip(step.iter()) {
                let value = access(&mut model);
                // Neither a delay nor a limit is negative; a limit of 0 would hold the base.
                *value = (*value - step).clamp(0.1 * *value, 10.0 * *value + 0.01);
            }
            let before = self.cost;
            if self.take(response, model) {
                damping *= 0.2;
                if before - self.cost < 1e-6 * before {
                    return;
                }
            } else {
                damping *= 10.0;
            }
        }
    }

    /// Keeps `model` if it is better.
    fn take(&mut self, response: &Response, model: PlantModel) -> bool {
        let cost = response.cost(&model);
        let is_better = cost < self.cost;
        if is_better {
            *self = Self { model, cost };
        }
        is_better
    }
}

/// Residuals, and their derivatives by the parameters of `free`: central differences.
pub(super) fn linearized(
    response: &Response,
    model: &PlantModel,
    free: &[Access],
) -> (DVector<f64>, DMatrix<f64>) {
    let residuals = DVector::from_vec(response.residuals(model));
    let mut jacobian = DMatrix::zeros(residuals.len(), free.len());
    for (column, access) in free.iter().enumerate() {
        let value = *access(&mut { *model });
        let step = (0.02 * value.abs()).max(2e-3);
        let low = (value - step).max(0.0);
        let at = |value: f64| {
            let mut model = *model;
            *access(&mut model) = value;
            DVector::from_vec(response.residuals(&model))
        };
        jacobian.set_column(column, &((at(value + step) - at(low)) / (value + step - low)));
    }
    (residuals, jacobian)
}

fn delays() -> Vec<f64> {
    (0..=(MAX_DELAY / DELAY_STEP) as usize).map(|k| k as f64 * DELAY_STEP).collect()
}

/// Minimum speeds of the base that are tried \[m/s].
fn speeds(response: &Response) -> Vec<f64> {
    deadbands(response.twists().map(|twist| twist.v.abs()))
}

/// Minimum turn rates of the base that are tried \[rad/s].
fn turn_rates(response: &Response) -> Vec<f64> {
    deadbands(response.twists().map(|twist| twist.omega.abs()))
}

/// Minimum rim speeds that are tried \[m/s].
fn rim_speeds(response: &Response) -> Vec<f64> {
    deadbands(response.rims().flat_map(|rims| [rims.right.abs(), rims.left.abs()]))
}

/// Edges of a dead band that the recording distinguishes, in order: 0, and the commanded values.
fn deadbands(commanded: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = commanded.filter(|value| *value > 1e-6).collect();
    values.sort_by(f64::total_cmp);
    let largest = values.last().copied().unwrap_or(0.0);
    values.retain(|value| *value <= MAX_DEADBAND * largest);
    values.insert(0, 0.0);
    values.dedup_by(|later, earlier| *later - *earlier < 1e-6);
    values
}

/// Those of the ordered `values` that are at least `spacing` apart.
pub(super) fn downsampled(values: &[f64], spacing: f64) -> Vec<f64> {
    let mut last = f64::NEG_INFINITY;
    let mut kept = Vec::new();
    for &value in values {
        if value - last >= spacing {
            kept.push(value);
            last = value;
        }
    }
    kept
}
