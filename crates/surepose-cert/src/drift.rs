//! Expected decrease of W under Gaussian noise.
//!
//! With probability 1 − p, the noise of a tick lies within k standard deviations. In that case the
//! certificate gives a decrease of W by δ·ΔT. For any noise, the angles raise W by at most a constant. The
//! distance term rises by at most what the robot can drive in a tick. Therefore E\[ΔW] ≤ −(1 − p)·δ·ΔT plus
//! the contribution of the other ticks. The bound is negative already for moderate k, because p falls as
//! exp(−k²/2).

use crate::annulus::from_outside_any_past;
use crate::certificate::{BUDGET, DISTANCE_WEIGHTS, Request, WANTED};
use crate::controller::SampledController;
use crate::lyapunov::LyapunovFunction;
use crate::noise::NoiseBounds;

/// Drift condition: expected decrease of W outside of a disc, under Gaussian noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drift {
    /// Radius of the disc, at least that where the wheels may stop at the goal \[m]: E\[ΔW] < −`rate`·ΔT from here to the edge of the workspace.
    pub radius: f64,
    /// Expected decrease rate of W \[1/s].
    pub rate: f64,
    /// Upper bound of the expected time from any start to the exit from the certified annulus \[s].
    ///
    /// The robot leaves the annulus by entering the disc or by passing the outer edge.
    pub expected_time: f64,
    /// Number of standard deviations k.
    pub deviations: f64,
    /// Bound p of the probability that any noise component exceeds k standard deviations in a tick.
    pub exceeded: f64,
    /// Contribution of the ticks beyond k standard deviations to E\[ΔW], as an upper bound.
    pub rise: f64,
    /// Lyapunov function W.
    pub lyapunov: LyapunovFunction,
}

/// Numbers of standard deviations tried, in this order.
const DEVIATIONS: [f64; 2] = [4.5, 5.0];

/// Computes a drift condition for white Gaussian noise.
///
/// The noise bounds of `request` are *standard deviations*: of each position coordinate, the heading, and
/// each wheel speed. `None`: invalid request, or no drift condition was shown.
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
        // The wheels may stop at the goal. At a larger distance, only noise beyond k deviations hides it, and that counts as such.
        let radius = annulus.inner.max(bounded.rests_truly_within());
        if radius >= request.workspace {
            return None;
        }
        // The position leaves a disc of k deviations with probability exp(−k²/2). Each of the three other
        // components leaves ±k deviations with a smaller probability, for k ≥ 1.
        let exceeded = 4.0 * (-0.5 * k * k).exp() * (1.0 + 1e-9);
        let rise = request.mean_rise(&lyapunov, annulus.inner, exceeded);
        let rate = (1.0 - exceeded) * -annulus.rate - rise / request.period;
        let start = lyapunov.distance_term(request.workspace) + lyapunov.max_angle_terms();
        (rate > 0.0).then(|| Drift {
            radius,
            rate,
            expected_time: (start - lyapunov.distance_term(radius)) / rate + request.period,
            deviations: k,
            exceeded,
            rise,
            lyapunov,
        })
    })
}

impl<L: SampledController> Request<'_, L> {
    /// Bounds E\[ΔW; some disturbance exceeds k], for true distances from `inner` \[m] outward.
    ///
    /// The event has probability `exceeded`. For a path of length X, F(ρ + X) − F(ρ) ≤ c·max(ln(1 + X/ρ),
    /// X/knee). Without wheel noise, X is bounded. With Gaussian wheel noise, E\[X; A] ≤ √(E\[X²]·P(A)) by
    /// Cauchy–Schwarz, and √E\[X²] ≤ ΔT·(V·(1 + σ) + σ') by Minkowski.
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
