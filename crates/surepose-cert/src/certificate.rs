//! Certification of a controller: request, certificate, and reasons for refusal.

use core::f64::consts::PI;
use std::time::Instant;

use surepose::control::Limits;
use surepose::kinematics::DiffDrive;

use crate::annulus::{Annulus, Budget, from_outside};
use crate::controller::SampledController;
use crate::counterexample::Counterexample;
use crate::descent::Descent;
use crate::lyapunov::LyapunovFunction;
use crate::noise::NoiseBounds;
use crate::terminal_phase::{TerminalPhase, heading_bound, local_counterexample, terminal_phase};

/// A certification problem.
#[derive(Clone, Copy, Debug)]
pub struct Request<'a, L> {
    /// Controller under test: the control law with its gains, and the limits.
    pub controller: &'a L,
    /// Wheel separation and wheel radii.
    pub drive: DiffDrive<f64>,
    /// Wheel speed and acceleration limits.
    pub limits: Limits<f64>,
    /// Weight h of the approach angle φ in the control law; W uses the same weight.
    pub h: f64,
    /// Control period ΔT, during which a twist is held \[s].
    pub period: f64,
    /// Bounds of the disturbances.
    pub noise: NoiseBounds,
    /// Workspace radius: largest true start distance from the goal \[m].
    pub workspace: f64,
    /// Largest acceptable capture radius \[m]; a larger one is refused.
    pub max_capture_radius: f64,
    /// Estimated goal distance below which the wheels may stop at the goal \[m]. 0: the wheels never stop.
    pub rests_within: f64,
    /// Upper end of the search for the longest period \[s]. A value not above `period` disables the search.
    pub max_period_searched: f64,
}

/// Reason for a refusal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RefusalReason {
    /// A parameter is NaN, not positive, or not below 10⁶ (SI units).
    Unusable,
    /// With noise and wheel limits, no decrease of W was shown down to `max_capture_radius`.
    NoDescent,
    /// No decrease of W was shown even without noise and without wheel limits.
    ///
    /// The control law is wrong, or the period is too long for its gains, and only saturation prevents
    /// overshoot.
    UnstableByItself,
    /// The wheels may stop at a true distance from the goal above `max_capture_radius`.
    RestsTooFar,
    /// Without noise, no decrease of the heading error and of the along-track distance was shown in local
    /// mode.
    LocalLaw,
}

impl core::fmt::Display for RefusalReason {
    fn fmt(&self, to: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        to.write_str(match self {
            Self::Unusable => {
                "request: a gain, limit, period, or noise bound is not valid (expected positive and finite)"
            }
            Self::NoDescent => {
                "capture: no decrease of W was shown down to the largest acceptable capture radius; \
                 reduce the noise bounds or accept a larger radius"
            }
            Self::RestsTooFar => {
                "goal tolerance: the robot may stop outside of the largest acceptable capture radius; reduce the \
                 tolerance, its release factor, or the position noise"
            }
            Self::LocalLaw => {
                "local mode: no decrease of the heading error was shown near the goal; check the local gains"
            }
            Self::UnstableByItself => {
                "control law: no decrease of W was shown even without noise and wheel limits; check the law, or \
                 reduce its gains or the period"
            }
        })
    }
}

/// Result of a certification. Every bound holds for all disturbances within their bounds at every tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Certificate {
    /// Whether the certificate was issued: the capture and the noise-free heading claim are proved.
    pub certified: bool,
    /// Capture radius R \[m]: the true goal distance falls below R. `None`: refused.
    pub capture_radius: Option<f64>,
    /// Decrease rate κ of W outside of the capture radius \[1/s]. `None`: refused.
    pub decrease_rate: Option<f64>,
    /// Upper bound of the time until capture, from every start in the workspace \[s]. `None`: refused.
    pub time_bound: Option<f64>,
    /// Longest period at which the capture within `max_capture_radius` was shown with the same gains \[s].
    ///
    /// The bounds hold over every initial part of a tick. The claim therefore covers every shorter tick, and ticks of varying length up to
    /// this one. `None`: refused.
    pub max_period: Option<f64>,
    /// Largest true goal distance at any time after capture \[m]. `None`: not shown.
    pub final_position_bound: Option<f64>,
    /// Bounds near the goal. `None`: refused.
    pub terminal_phase: Option<TerminalPhase>,
    /// Lyapunov function W.
    pub lyapunov: LyapunovFunction,
    /// Number of boxes evaluated.
    pub boxes: usize,
    /// Wall-clock time \[s].
    pub wall: f64,
    /// Reason for the refusal. `None`: certified.
    pub reason: Option<RefusalReason>,
    /// State that violates the claim, confirmed by simulating one tick. `None`: none found.
    pub counterexample: Option<Counterexample>,
}

/// Decrease rates tried \[1/s], in this order.
pub(crate) const WANTED: [f64; 2] = [0.2, 0.02];
/// Box budgets of the descent and of each period tried.
pub(crate) const BUDGET: Budget = Budget { slice: 20_000, enough: 60_000, total: 90_000 };
const PERIOD_BUDGET: Budget = Budget { slice: 2_500, enough: 9_000, total: 9_000 };
/// Weights c of the distance in W, in the order tried.
pub(crate) const DISTANCE_WEIGHTS: [f64; 3] = [4.0, 8.0, 2.0];
/// Weights c for the final position bound. A larger c lets W trade less distance for angle.
const FINAL_WEIGHTS: [f64; 4] = [64.0, 32.0, 16.0, 8.0];

/// Certifies the controller of `request`, or returns the reason for the refusal.
pub fn certify<L: SampledController>(request: &Request<'_, L>) -> Certificate {
    let clock = Instant::now();
    let mut certificate = request.judge();
    certificate.wall = clock.elapsed().as_secs_f64();
    certificate
}

impl<L: SampledController> Request<'_, L> {
    fn judge(&self) -> Certificate {
        let mut refused = Certificate::refused(RefusalReason::Unusable, self.lyapunov(DISTANCE_WEIGHTS[0]));
        if !self.usable() {
            return refused;
        }
        let floor = self.max_capture_radius;
        // The control law without noise and limits comes first, because its failures are the easiest to
        // explain.
        let mut alone: Option<(LyapunovFunction, Annulus)> = None;
        for distance in DISTANCE_WEIGHTS {
            let lyapunov = self.lyapunov(distance);
            let shown = from_outside(
                &mut self.bare(lyapunov),
                self.outer(&lyapunov),
                (floor, floor),
                &WANTED,
                BUDGET,
            );
            refused.boxes += shown.boxes;
            if alone.as_ref().is_none_or(|(_, old)| shown.inner < old.inner) {
                alone = Some((lyapunov, shown));
            }
            if shown.inner > floor {
                continue;
            }
            let mut descent = self.descent(lyapunov);
            let annulus = from_outside(&mut descent, self.outer(&lyapunov), (0.0, floor), &WANTED, BUDGET);
            refused.boxes += annulus.boxes;
            if annulus.inner <= floor {
                // Every certificate includes the noise-free heading claim.
                let mut quiet = Descent { noise: NoiseBounds::default(), ..self.descent(lyapunov) };
                if heading_bound(&mut quiet, floor, &mut refused.boxes).is_none() {
                    refused.reason = Some(RefusalReason::LocalLaw);
                    refused.counterexample = local_counterexample(&mut quiet, floor);
                    return refused;
                }
                // W does not decrease where the wheels may stop.
                if self.rests_truly_within() > floor {
                    refused.reason = Some(RefusalReason::RestsTooFar);
                    refused.counterexample = None;
                    return refused;
                }
                let inner = annulus.inner.max(self.rests_truly_within());
                return self.certificate(lyapunov, &Annulus { inner, ..annulus }, refused.boxes);
            }
            refused.reason = Some(RefusalReason::NoDescent);
            refused.lyapunov = lyapunov;
            let found = annulus.counterexample(&mut descent, floor);
            refused.counterexample = refused.counterexample.or(found);
        }
        if let (Some((lyapunov, shown)), Some(RefusalReason::Unusable)) = (alone, refused.reason) {
            refused.reason = Some(RefusalReason::UnstableByItself);
            refused.lyapunov = lyapunov;
            refused.counterexample = shown.counterexample(&mut self.bare(lyapunov), floor);
        }
        refused
    }

    /// True goal distance within which the wheels may stop \[m].
    pub(crate) fn rests_truly_within(&self) -> f64 {
        if self.rests_within > 0.0 { (self.rests_within + self.noise.position).next_up() } else { 0.0 }
    }

    fn certificate(&self, lyapunov: LyapunovFunction, annulus: &Annulus, boxes: usize) -> Certificate {
        let mut descent = self.descent(lyapunov);
        let rate = -annulus.rate;
        let start = lyapunov.distance_term(self.workspace) + lyapunov.max_angle_terms();
        let time = (start - lyapunov.distance_term(annulus.inner)) / rate + self.period;
        let mut boxes = boxes;
        let final_position = self.final_position(annulus, &mut boxes);
        let terminal_phase = terminal_phase(&mut descent, annulus.inner, &mut boxes);
        let max_period = self.max_period(lyapunov, &mut boxes);
        Certificate {
            certified: true,
            capture_radius: Some(annulus.inner),
            decrease_rate: Some(rate),
            time_bound: Some(time),
            max_period: Some(max_period),
            final_position_bound: final_position,
            terminal_phase: Some(terminal_phase),
            lyapunov,
            boxes,
            wall: 0.0,
            reason: None,
            counterexample: None,
        }
    }

    /// Returns a distance that the robot does not exceed after capture \[m].
    ///
    /// From inside a radius r ≥ R, one tick leads to at most `edge`. From there, a W with a large c decreases down to r, so c·ln ρ
    /// grows by at most the largest contribution of the angles. r is R, or the radius at which the search for a decrease stopped.
    fn final_position(&self, annulus: &Annulus, boxes: &mut usize) -> Option<f64> {
        let edge = self.descent(self.lyapunov(1.0)).one_step_reach(annulus.inner)?;
        let mut stopped = Vec::new();
        let within_capture = FINAL_WEIGHTS.iter().find_map(|&distance| {
            let (bound, inner) = self.decrease_beyond(distance, annulus.inner, edge, boxes);
            if inner > annulus.inner && inner.is_finite() {
                stopped.push((distance, inner));
            }
            (inner <= annulus.inner).then_some(bound)
        });
        let wider = || {
            let bounds = stopped.into_iter().filter_map(|(distance, inner)| {
                let edge = self.descent(self.lyapunov(1.0)).one_step_reach(inner)?;
                let (bound, shown) = self.decrease_beyond(distance, inner, edge, boxes);
                (shown <= inner).then_some(bound)
            });
            bounds.reduce(f64::min)
        };
        within_capture.or_else(wider)
    }

    /// Searches a decrease of W with weight c = `distance` from the resulting bound down to `radius`.
    ///
    /// Returns the distance \[m] that the robot does not exceed after a tick that ends within `edge`, if W decreases down to `radius`, and
    /// the radius to which it does.
    fn decrease_beyond(&self, distance: f64, radius: f64, edge: f64, boxes: &mut usize) -> (f64, f64) {
        let lyapunov = LyapunovFunction { distance, knee: f64::INFINITY, ..self.lyapunov(distance) };
        let bound = edge * (lyapunov.max_angle_terms() / distance).exp() * (1.0 + 1e-9);
        let mut descent = self.descent(lyapunov);
        let shown = from_outside(&mut descent, bound, (radius, radius), &WANTED, BUDGET);
        *boxes += shown.boxes;
        (bound, shown.inner)
    }

    /// Searches for the longest period at which the capture within `max_capture_radius` is shown \[s].
    fn max_period(&self, lyapunov: LyapunovFunction, boxes: &mut usize) -> f64 {
        let (mut shown, mut failed) = (self.period, self.max_period_searched);
        // The period is doubled while that succeeds; then the remaining interval is bisected at most twice.
        let mut halves = 0;
        loop {
            let doubled = 2.0 * shown < failed;
            let period = if doubled { 2.0 * shown } else { 0.5 * (shown + failed) };
            halves += u32::from(!doubled);
            if halves > 2 || period <= shown * 1.05 {
                break;
            }
            let slower = Self { period, ..*self };
            let works = [slower.bare(lyapunov), slower.descent(lyapunov)].iter_mut().all(|descent| {
                let floor = self.max_capture_radius;
                let annulus =
                    from_outside(descent, self.outer(&lyapunov), (floor, floor), &WANTED[1..], PERIOD_BUDGET);
                *boxes += annulus.boxes;
                annulus.inner <= floor
            });
            if works { shown = period } else { failed = period }
        }
        shown
    }

    /// Lyapunov function W with distance weight c; F is linear beyond the knee, where F′V ≈ 1.
    pub(crate) fn lyapunov(&self, distance: f64) -> LyapunovFunction {
        LyapunovFunction { distance, knee: distance * self.limits.wheel_speed, approach: self.h }
    }

    /// Distance that the robot does not exceed while W decreases, from every start in the workspace \[m].
    pub(crate) fn outer(&self, lyapunov: &LyapunovFunction) -> f64 {
        let most = lyapunov.distance_term(self.workspace) + lyapunov.max_angle_terms();
        lyapunov.distance_from_term(most) * (1.0 + 1e-9)
    }

    /// Decrease problem with the noise and the limits of the request.
    pub(crate) fn descent(&self, lyapunov: LyapunovFunction) -> Descent<'_, L> {
        Descent {
            controller: self.controller,
            drive: self.drive,
            noise: self.noise,
            period: self.period,
            lyapunov,
            limited: true,
            discrete_states: Vec::new(),
            rim_limit: self.limits.wheel_speed,
            reachable: Vec::new(),
        }
        .with_reachable_states()
    }

    /// Decrease problem without noise and without wheel limits.
    pub(crate) fn bare(&self, lyapunov: LyapunovFunction) -> Descent<'_, L> {
        Descent { noise: NoiseBounds::default(), limited: false, ..self.descent(lyapunov) }
    }

    /// Whether all parameters are finite and in range.
    pub(crate) fn usable(&self) -> bool {
        let positive = [
            self.drive.wheel_separation,
            self.drive.radius.right,
            self.drive.radius.left,
            self.limits.wheel_speed,
            self.period,
            self.workspace,
            self.max_capture_radius,
        ];
        let bounds = [
            self.h,
            self.noise.position,
            self.noise.heading,
            self.noise.rim_speed,
            self.noise.rim_speed_part,
            self.rests_within,
            self.max_period_searched,
        ];
        positive.iter().all(|x| *x > 0.0 && *x < 1e6)
            && bounds.iter().all(|x| *x >= 0.0 && *x < 1e6)
            && self.noise.heading < PI
    }
}

impl Certificate {
    fn refused(reason: RefusalReason, lyapunov: LyapunovFunction) -> Self {
        Self {
            certified: false,
            capture_radius: None,
            decrease_rate: None,
            time_bound: None,
            max_period: None,
            final_position_bound: None,
            terminal_phase: None,
            lyapunov,
            boxes: 0,
            wall: 0.0,
            reason: Some(reason),
            counterexample: None,
        }
    }
}
