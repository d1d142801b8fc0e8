//! Estimates of the parameters of the base, with standard errors; absent where the recording does not show one.

use nalgebra::DMatrix;
use surepose::param::Parameter;

use super::fit::{Access, Fitted, Minimum, SMOOTH, Smooth, downsampled, linearized};
use super::response::Response;
use crate::calibrate::outcome::{ActuatorEstimates, ParameterEstimate};

/// Number of residuals that count as one: those of a maneuver have the same cause.
const CORRELATED: f64 = 10.0;
/// Decrease of the sum of squares, in variances of a residual, that a parameter requires: χ² of one degree of freedom at 5·10⁻⁴.
const THRESHOLD: f64 = 12.0;
/// Largest standard error of a value that is reported, relative to the value or to this size: 0.2 s, 0.2 m/s².
const MAX_RELATIVE_ERROR: f64 = 0.3;
const ABSOLUTE_SIZE: f64 = 0.2;
/// Segments of the recording whose disagreement enlarges the standard errors [White1980].
const SEGMENTS: usize = 20;

/// A parameter that is not excited, and the motion that would excite it.
pub(super) fn not_excited(parameter: &Parameter, motion: &'static str) -> ParameterEstimate {
    let unit = parameter.unit.symbol();
    ParameterEstimate { value: None, std_error: None, unit, not_excited: Some(motion) }
}

/// Judges each parameter of the best fit, after those that explain nothing have left it.
pub(super) fn judged(response: &Response, best: Fitted, minima: &[Minimum]) -> ActuatorEstimates {
    let mut best = best;
    let limit = THRESHOLD * CORRELATED * best.cost / (2 * response.len()) as f64;
    loop {
        // A delay of 0 is a value; a lag of 0 and a limit of ∞ are the absence of one.
        let removable = best.present().filter(|smooth| smooth.neutral.is_some());
        let reduced = removable.map(|smooth| best.without(response, smooth));
        let Some(least) = reduced.min_by(|a, b| a.cost.total_cmp(&b.cost)) else { break };
        if least.cost - best.cost > limit {
            break;
        }
        best = least;
    }
    let present: Vec<&Smooth> = best.present().collect();
    let free: Vec<Access> = present.iter().map(|smooth| smooth.access).collect();
    let errors = standard_errors(response, &best, &free);
    let mut estimates = ActuatorEstimates::new();
    for smooth in &SMOOTH {
        let error = present.iter().position(|other| other.parameter.key == smooth.parameter.key);
        let value = *(smooth.access)(&mut { best.model });
        let std_error = error.and_then(|index| errors.get(index).copied());
        let found = match std_error.filter(|error| *error < MAX_RELATIVE_ERROR * value.max(ABSOLUTE_SIZE)) {
            Some(std_error) => estimate(smooth.parameter, value, std_error),
            None => not_excited(smooth.parameter, smooth.motion),
        };
        estimates.push((smooth.parameter, found));
    }
    estimates.extend(minima.iter().map(|of| (of.parameter, minimum(response, &best, of, limit))));
    estimates
}

/// The smallest speed that was seen to move the robot, and the distance to the largest that was not.
fn minimum(response: &Response, best: &Fitted, of: &Minimum, limit: f64) -> ParameterEstimate {
    let Minimum { parameter, access, values } = *of;
    let values = values(response);
    let motion = "commands below and above the least speed that moves the robot, each held for a second";
    let cost = |value: f64| {
        let mut model = best.model;
        *access(&mut model) = value;
        response.cost(&model)
    };
    let found = *access(&mut { best.model });
    if found <= 0.0 || cost(0.0) - best.cost <= limit {
        return not_excited(parameter, motion);
    }
    // Of the commands near the edge, those whose execution the recording does not decide.
    let is_undecided = |value: &&f64| cost(**value) - best.cost <= limit;
    let values = downsampled(&values, 0.01 * found);
    let slower = values.iter().rev().filter(|value| **value < found);
    let faster = values.iter().filter(|value| **value > found);
    let high = faster.take_while(is_undecided).last().copied().unwrap_or(found);
    let undecided = slower.clone().take_while(is_undecided).count();
    // The largest command that was ignored.
    let low = slower.copied().nth(undecided).unwrap_or(0.0);
    estimate(parameter, high, (high - low) / 12.0_f64.sqrt())
}

/// Standard errors of the parameters of `free`; NaN where the recording does not determine one.
fn standard_errors(response: &Response, best: &Fitted, free: &[Access]) -> Vec<f64> {
    let (residuals, jacobian) = linearized(response, &best.model, free);
    let Some(inverse) = (jacobian.transpose() * &jacobian).try_inverse() else {
        return vec![f64::NAN; free.len()];
    };
    let mut scatter = DMatrix::zeros(free.len(), free.len());
    let length = residuals.len().div_ceil(SEGMENTS).max(1);
    for begin in (0..residuals.len()).step_by(length) {
        let count = length.min(residuals.len() - begin);
        let gradient = jacobian.rows(begin, count).transpose() * residuals.rows(begin, count);
        scatter += &gradient * gradient.transpose();
    }
    let covariance = &inverse * scatter * &inverse;
    (0..free.len()).map(|i| covariance[(i, i)].max(0.0).sqrt()).collect()
}

fn estimate(parameter: &Parameter, value: f64, std_error: f64) -> ParameterEstimate {
    let unit = parameter.unit;
    let per = 1.0 / unit.to_si();
    ParameterEstimate {
        value: Some(value * per),
        std_error: Some(std_error * per),
        unit: unit.symbol(),
        not_excited: None,
    }
}
