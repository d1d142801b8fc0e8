//! Noise without bounds: Gaussian noise makes W fall on average.
//!
//! With probability 1 − p a tick's noise lies within k standard deviations, and there the certificate has W fall by
//! δ·ΔT. Whatever the noise, the angles cannot raise W by more than a constant, and the distance by no more than the
//! robot drives. So E[ΔW] ≤ −(1 − p)·δ·ΔT + what the other ticks add: negative for a moderate k already, because p
//! falls as exp(−k²/2).

use crate::annulus::from_outside_any_past;
use crate::certificate::{BUDGET, DISTANCE_WEIGHTS, Request, WANTED};
use crate::controller::SampledController;
use crate::lyapunov::LyapunovFunction;
use crate::noise::NoiseBounds;

/// What Gaussian noise does to W, on average, outside of a disc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drift {
    /// E\[ΔW] is below −`rate`·ΔT at every true distance from here \[m] to the edge of the workspace.
    pub radius: f64,
    /// \[1/s].
    pub rate: f64,
    /// Bound of the expected time until the robot comes within the radius, or farther out than the certificate goes,
    /// from every start in the workspace \[s].
    pub expected_time: f64,
    /// k.
    pub deviations: f64,
    /// p: the chance that a tick's noise exceeds k standard deviations somewhere.
    pub exceeded: f64,
    /// What the ticks beyond k standard deviations can add to E\[ΔW].
    pub rise: f64,
    /// The function that falls.
    pub lyapunov: LyapunovFunction,
}

/// Numbers of standard deviations that are tried.
const DEVIATIONS: [f64; 2] = [4.5, 5.0];

/// A drift certificate where the bounds of the request's noise are *standard deviations* of white Gaussian noise: of
/// each coordinate of the position, of the heading and of each rim.
pub fn drift<L: SampledController>(request: &Request<'_, L>) -> Option<Drift> {
    if !request.usable() {
        return None;
    }
    DEVIATIONS.into_iter().find_map(|k| {
        let noise = NoiseBounds {
            position: k * request.noise.position,
            heading: k * request.noise.heading,
            rim_speed: k * request.noise.rim_speed,
            rim_speed_part: k * request.noise.rim_speed_part,
        };
        let bounded = Request { noise, ..*request };
        let lyapunov = bounded.lyapunov(DISTANCE_WEIGHTS[0]);
        let near_enough = bounded.max_capture_radius;
        let mut descent = bounded.descent(lyapunov);
        let annulus =
            from_outside_any_past(&mut descent, bounded.outer(&lyapunov), near_enough, &WANTED, BUDGET);
        if !annulus.inner.is_finite() {
            return None;
        }
        // The position leaves a disc of k deviations with probability exp(−k²/2); each of the three others leaves
        // ±k deviations with less than that, for k ≥ 1.
        let exceeded = 4.0 * (-0.5 * k * k).exp() * (1.0 + 1e-9);
        let rise = request.mean_rise(&lyapunov, annulus.inner, exceeded);
        let rate = (1.0 - exceeded) * -annulus.rate - rise / request.period;
        let start = lyapunov.distance_term(request.workspace) + lyapunov.max_angle_terms();
        (rate > 0.0).then(|| Drift {
            radius: annulus.inner,
            rate,
            expected_time: (start - lyapunov.distance_term(annulus.inner)) / rate + request.period,
            deviations: k,
            exceeded,
            rise,
            lyapunov,
        })
    })
}

impl<L: SampledController> Request<'_, L> {
    /// Bound of E\[ΔW; a disturbance beyond k], which happens with probability `exceeded`, from `inner` \[m] outwards.
    ///
    /// F rises by F(ρ + X) − F(ρ) ≤ c·max(ln(1 + X/ρ), X/knee) for a way of length X. Undisturbed rims bound X. Gaussian ones do
    /// not: there E\[X; A] ≤ √(E\[X²]·P(A)), by Cauchy and Schwarz, and √E\[X²] ≤ ΔT·(V·(1 + σ) + σ'), by Minkowski.
    fn mean_rise(&self, lyapunov: &LyapunovFunction, inner: f64, exceeded: f64) -> f64 {
        let way = self.period * self.limits.wheel_speed;
        let distance = if self.noise.rim_speed > 0.0 || self.noise.rim_speed_part > 0.0 {
            let mean_square = way * (1.0 + self.noise.rim_speed_part) + self.period * self.noise.rim_speed;
            lyapunov.distance * mean_square / inner.min(lyapunov.knee) * exceeded.sqrt()
        } else {
            lyapunov.distance * (way / inner).ln_1p().max(way / lyapunov.knee) * exceeded
        };
        (distance + exceeded * lyapunov.max_angle_terms()) * (1.0 + 1e-9)
    }
}
