//! Standard errors of the fit: from the model, and from the disagreement between segments of the recording.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::error::CalibrationError;
use super::fit::{Fit, NoiseCurvature};
use super::frontal::Singular;
use super::parameter::{COUNT, CalibrationParameter};

/// Number of segments of the recording.
const STRETCHES: usize = 12;

/// Ratio of the 97.5 % quantiles of Student's t with `STRETCHES` − 1 degrees of freedom and of the normal
/// distribution. It accounts for the small number of segments.
const STUDENT: f64 = 2.201 / 1.960;

/// Standard deviation of the range bias of walls at different angles of incidence \[m].
///
/// Measured on simulated recordings, where it moves the laser ahead by 0.3 mm.
const LINE_BIAS: f64 = 3e-4;

/// Uncertainty of a fit.
pub(super) struct Uncertainty {
    /// Covariance of the geometry.
    pub(super) covariance: DMatrix<f64>,
    /// Standard error of ln δ.
    pub(super) log_delta_std: f64,
}

/// Computes the standard errors of a converged fit.
///
/// The model's covariance is the inverse of the normal matrix, which is valid for white noise. The errors of
/// real floors, tires and lasers are correlated over seconds. The recording is therefore cut into segments,
/// each with its own poses and walls. The scores g of the segments may scatter more than the model's
/// information A allows. Variances are then enlarged by the ratio of the sandwich A⁻¹(Σgg^T)A⁻¹ to A⁻¹
/// [White1980], clustered by segment. They are never reduced.
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

/// Returns the factor of each parameter's variance over that of the model.
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
        // Each segment starts with the heading of the whole recording, so the scores of the compass offset
        // are not independent. The model's variance is kept.
        if i == CalibrationParameter::CompassOffset as usize {
            1.0
        } else {
            sandwich[(i, i)] / inverse[(i, i)]
        }
    }))
}

/// Returns the standard error of ln δ from the curvature of −2 log likelihood and the gradients of the
/// segments.
fn log_delta_std(whole: &NoiseCurvature, parts: &[NoiseCurvature]) -> f64 {
    // A = ½ of the curvature is the information, g = −½ of the slope is the score.
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
    // The common optimum of the segments, where their gradients sum to 0.
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
