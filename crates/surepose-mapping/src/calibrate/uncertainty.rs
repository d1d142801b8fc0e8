//! How far from the truth the fit may be: by the model, and by how stretches of the recording disagree.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::error::CalibrationError;
use super::fit::{Fit, NoiseCurvature};
use super::frontal::Singular;
use super::parameter::{COUNT, CalibrationParameter};

/// How many stretches the recording is cut into.
const STRETCHES: usize = 12;

/// The 97.5 % quantile of Student's t with `STRETCHES` − 1 degrees of freedom over that of the normal distribution: a
/// variance of so few stretches is itself uncertain.
const STUDENT: f64 = 2.201 / 1.960;

/// Walls met at different angles are seen too near or too far by as much \[m].
///
/// Measured on simulated recordings, where it moves the laser ahead by 0.3 mm.
const LINE_BIAS: f64 = 3e-4;

/// What the fit is worth.
pub(super) struct Uncertainty {
    /// Covariance of the geometry.
    pub(super) covariance: DMatrix<f64>,
    /// Standard error of ln δ.
    pub(super) log_delta_std: f64,
}

/// The standard errors of a fit that has converged.
///
/// The model's own covariance is the inverse of the normal matrix. It is right where the noise is white, as the model
/// says; a real floor, tyre or laser errs for seconds on end. So the recording is cut into stretches, each with poses and
/// walls of its own; if the stretches' scores g scatter more than the model's information A lets them, the variances are
/// enlarged by the ratio of the sandwich A⁻¹(Σgg^T)A⁻¹ to A⁻¹ [White1980], clustered by stretch. They are never reduced.
pub(super) fn uncertainty(fit: &Fit<'_>) -> Result<Uncertainty, CalibrationError> {
    let linear = fit.linear(true);
    let (a, ..) = fit.normal(&linear)?;
    let mut covariance = a.cholesky().ok_or(Singular)?.inverse();

    let n = linear.len();
    let ranges: Vec<Range<usize>> = (0..STRETCHES)
        .map(|k| k * n / STRETCHES..(k + 1) * n / STRETCHES)
        .filter(|r| !r.is_empty())
        .collect();
    let inflation = inflation(fit, &ranges)?;
    let factor = |i: usize| inflation[i].max(1.0).sqrt();
    for i in 0..COUNT {
        for j in 0..COUNT {
            covariance[(i, j)] *= factor(i) * factor(j);
        }
    }
    for place in [CalibrationParameter::LaserX, CalibrationParameter::LaserY] {
        covariance[(place as usize, place as usize)] += LINE_BIAS * LINE_BIAS;
    }

    let whole = fit.bend(|noise| fit.likelihood(&linear, noise, 0..n))?;
    let parts = ranges
        .iter()
        .map(|range| fit.bend(|noise| fit.likelihood(&linear, noise, range.clone())))
        .collect::<Result<Vec<_>, _>>()?;
    Ok(Uncertainty { covariance, log_delta_std: log_delta_std(&whole, &parts) })
}

/// By how much the variance of each parameter is larger than the model says.
fn inflation(fit: &Fit<'_>, ranges: &[Range<usize>]) -> Result<[f64; COUNT], Singular> {
    let linear = fit.linear(true);
    let slopes = fit.data.latency_slopes(&linear, &fit.trajectory, &fit.geometry, fit.noise, ranges)?;
    let mut parts = Vec::with_capacity(ranges.len());
    for (range, slopes) in ranges.iter().zip(slopes) {
        let mut part = linear.reduced(range.clone(), fit.noise)?;
        for latency in [CalibrationParameter::LaserLatency, CalibrationParameter::CompassLatency] {
            part.b[latency as usize] = -slopes[latency as usize];
        }
        parts.push((part.a, part.b));
    }
    let (mut a, mut b) = (DMatrix::zeros(COUNT, COUNT), DVector::zeros(COUNT));
    for (part_a, part_b) in &parts {
        a += part_a;
        b += part_b;
    }
    let mut unused = DVector::zeros(COUNT);
    fit.add_prior(&mut a, &mut unused);
    let inverse = a.cholesky().ok_or(Singular)?.inverse();
    let best = &inverse * &b;
    let mut meat = DMatrix::zeros(COUNT, COUNT);
    for (part_a, part_b) in &parts {
        let score = part_b - part_a * &best;
        meat += &score * score.transpose();
    }
    let count = parts.len() as f64;
    let sandwich = &inverse * meat * &inverse * (STUDENT * STUDENT * count / (count - 1.0).max(1.0));
    Ok(core::array::from_fn(|i| {
        // Each stretch begins at the heading that the whole recording gives it, so what the stretches say of the compass'
        // offset is not independent, and the model's own variance stands.
        if i == CalibrationParameter::CompassOffset as usize {
            1.0
        } else {
            sandwich[(i, i)] / inverse[(i, i)]
        }
    }))
}

/// The standard error of ln δ, from the curvature of −2 log likelihood and from the slopes of the stretches.
fn log_delta_std(whole: &NoiseCurvature, parts: &[NoiseCurvature]) -> f64 {
    // A = ½ of the curvature is the information, g = −½ of the slope the score.
    let inverse = |curvature: [[f64; 2]; 2]| {
        let [[dd, dw], [_, ww]] = curvature.map(|row| row.map(|entry| 0.5 * entry));
        let determinant = dd * ww - dw * dw;
        (dd > 0.0 && determinant > 0.0)
            .then(|| [[ww / determinant, -dw / determinant], [-dw / determinant, dd / determinant]])
    };
    let Some(model) = inverse(whole.curvature) else { return f64::INFINITY };
    let mut sum = [[0.0; 2]; 2];
    let mut slope = [0.0; 2];
    for part in parts {
        for i in 0..2 {
            slope[i] += part.slope[i];
            for j in 0..2 {
                sum[i][j] += part.curvature[i][j];
            }
        }
    }
    let Some(all) = inverse(sum) else { return model[0][0].sqrt() };
    // The stretches' common best point, where their slopes sum to 0.
    let best: [f64; 2] = core::array::from_fn(|i| -0.5 * (all[i][0] * slope[0] + all[i][1] * slope[1]));
    let mut variance = 0.0;
    for part in parts {
        let score: [f64; 2] = core::array::from_fn(|i| {
            -0.5 * (part.slope[i] + part.curvature[i][0] * best[0] + part.curvature[i][1] * best[1])
        });
        variance += (all[0][0] * score[0] + all[0][1] * score[1]).powi(2);
    }
    let count = parts.len() as f64;
    let inflation = STUDENT * STUDENT * variance * count / (count - 1.0).max(1.0) / all[0][0];
    (model[0][0] * inflation.max(1.0)).sqrt()
}
