//! The certificate: what is asked, what is answered.

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

/// What is to be certified.
#[derive(Clone, Copy, Debug)]
pub struct Request<'a, L> {
    /// The law with its gains, and the limits.
    pub controller: &'a L,
    /// The wheels' geometry.
    pub drive: DiffDrive<f64>,
    /// The wheels' limits.
    pub limits: Limits<f64>,
    /// Weight h of the direction of approach in the law, which W takes over.
    pub h: f64,
    /// Time for which a twist is held \[s].
    pub period: f64,
    /// Bounds of the disturbances.
    pub noise: NoiseBounds,
    /// Largest distance from which the robot starts \[m].
    pub workspace: f64,
    /// A larger capture radius than this is no use: refused \[m].
    pub max_capture_radius: f64,
    /// Seen distance below which the wheels may rest because the robot has arrived \[m]; 0 if they never do.
    pub rests_within: f64,
    /// Longest period that is looked for \[s]; none is looked for if it is not above `period`.
    pub max_period_searched: f64,
}

/// Why there is no certificate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RefusalReason {
    /// A constant is not a number, not positive, or out of every proportion.
    Unusable,
    /// With the noise and the wheels' limits, W was not shown to fall down to the largest useful capture radius.
    NoDescent,
    /// Even without noise, and without the wheels' limits, W was not shown to fall: the law is wrong, or the period so
    /// long for these gains that only saturation keeps a step from overshooting.
    UnstableByItself,
    /// The wheels may rest, the robot having arrived, truly farther away than the largest useful capture radius.
    RestsTooFar,
    /// Without noise the local law does not bring the heading and the distance along the robot down.
    LocalLaw,
}

impl core::fmt::Display for RefusalReason {
    fn fmt(&self, to: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        to.write_str(match self {
            Self::Unusable => "a gain, limit, period or noise bound is not a positive number",
            Self::NoDescent => {
                "with this noise the law was not shown to bring the robot near enough to the goal: W may rise in a tick"
            }
            Self::RestsTooFar => {
                "the tolerance of arrival, with its release and the noise, lets the robot rest too far from the goal"
            }
            Self::LocalLaw => "near the goal the law was not shown to turn the robot to the commanded heading",
            Self::UnstableByItself => {
                "even without noise the law was not shown to descend in every tick: it is wrong, or these gains \
                 overshoot at this period and only the wheels' limits hold them back"
            }
        })
    }
}

/// What was shown, or why not. Every bound holds for every disturbance inside its bounds at every tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Certificate {
    /// Whether all of it was shown.
    pub certified: bool,
    /// The true distance from the goal below which the robot comes \[m].
    pub capture_radius: Option<f64>,
    /// W falls at least this fast outside of the capture radius \[1/s].
    pub decrease_rate: Option<f64>,
    /// Latest time of coming within the capture radius, from every start in the workspace \[s].
    pub time_bound: Option<f64>,
    /// The longest period found at which the same gains were shown to bring the robot within the largest useful capture
    /// radius \[s]: shown at that period, not at those between.
    pub max_period: Option<f64>,
    /// Largest true distance from the goal at any time after the capture \[m].
    pub final_position_bound: Option<f64>,
    /// What holds near the goal.
    pub terminal_phase: Option<TerminalPhase>,
    /// The function that falls.
    pub lyapunov: LyapunovFunction,
    /// Regions looked at.
    pub boxes: usize,
    /// How long it took \[s].
    pub wall: f64,
    /// Why it was refused.
    pub reason: Option<RefusalReason>,
    /// A state that violates the claim, confirmed by simulating one tick of it.
    pub counterexample: Option<Counterexample>,
}

/// Rates of fall that are tried \[1/s], the wish first.
pub(crate) const WANTED: [f64; 2] = [0.2, 0.02];
/// Work for the descent, and for each period that is tried.
pub(crate) const BUDGET: Budget = Budget { slice: 12_000, enough: 24_000, total: 60_000 };
const PERIOD_BUDGET: Budget = Budget { slice: 2_500, enough: 9_000, total: 9_000 };
/// Weights c of the distance in W, in the order of trying.
pub(crate) const DISTANCE_WEIGHTS: [f64; 3] = [4.0, 8.0, 2.0];
/// Weights c for the bound of the distance after the capture: the larger, the less W trades distance for angles.
const FINAL_WEIGHTS: [f64; 4] = [64.0, 32.0, 16.0, 8.0];

/// Certifies, or says why not.
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
        // The law by itself first, without noise and without limits: what fails there is plainest.
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
                // The noise-free heading claim is part of every certificate.
                let mut quiet = Descent { noise: NoiseBounds::default(), ..self.descent(lyapunov) };
                if heading_bound(&mut quiet, floor, &mut refused.boxes).is_none() {
                    refused.reason = Some(RefusalReason::LocalLaw);
                    refused.counterexample = local_counterexample(&mut quiet, floor);
                    return refused;
                }
                // Where the wheels may rest nothing falls.
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

    /// The true distance within which the wheels may rest \[m].
    fn rests_truly_within(&self) -> f64 {
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

    /// The distance that the robot never leaves after the capture.
    ///
    /// From inside the capture radius one tick leads out to `edge` at most. From there a W with a large c falls, so
    /// that c·ln ρ grows by no more than the angles can give up.
    fn final_position(&self, annulus: &Annulus, boxes: &mut usize) -> Option<f64> {
        let edge = self.descent(self.lyapunov(1.0)).one_step_reach(annulus.inner)?;
        FINAL_WEIGHTS.iter().find_map(|&distance| {
            let lyapunov = LyapunovFunction { distance, knee: f64::INFINITY, ..self.lyapunov(distance) };
            let bound = edge * (lyapunov.max_angle_terms() / distance).exp() * (1.0 + 1e-9);
            let mut descent = self.descent(lyapunov);
            let shown = from_outside(&mut descent, bound, (annulus.inner, annulus.inner), &WANTED, BUDGET);
            *boxes += shown.boxes;
            (shown.inner <= annulus.inner).then_some(bound)
        })
    }

    /// The longest period found with which the same gains are still certified, with the largest useful capture radius.
    fn max_period(&self, lyapunov: LyapunovFunction, boxes: &mut usize) -> f64 {
        let (mut shown, mut failed) = (self.period, self.max_period_searched);
        // What is tried: twice the period as long as that works, then halves of what is left, at most twice.
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

    /// W with the weight c of the distance; F turns straight where the wheels' limit begins to matter: F′V ≈ 1 beyond.
    pub(crate) fn lyapunov(&self, distance: f64) -> LyapunovFunction {
        LyapunovFunction { distance, knee: distance * self.limits.wheel_speed, approach: self.h }
    }

    /// The distance that the robot does not leave while W falls, from every start in the workspace.
    pub(crate) fn outer(&self, lyapunov: &LyapunovFunction) -> f64 {
        let most = lyapunov.distance_term(self.workspace) + lyapunov.max_angle_terms();
        lyapunov.distance_from_term(most) * (1.0 + 1e-9)
    }

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

    pub(crate) fn bare(&self, lyapunov: LyapunovFunction) -> Descent<'_, L> {
        Descent { noise: NoiseBounds::default(), limited: false, ..self.descent(lyapunov) }
    }

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
