//! Shared fixtures of the certificate tests: the deployed law and requests for it.
#![allow(dead_code, unreachable_pub, reason = "each test file uses a part")]

use std::f64::consts::PI;

use surepose::control::{Direction, Gains, HybridLaw, Law, Limits};
use surepose::kinematics::DiffDrive;
use surepose_cert::{DeployedController, DisturbedState, NoiseBounds, Request, SampledController};

pub const DRIVE: DiffDrive<f64> = DiffDrive::new(0.05, 0.6);
pub const LIMITS: Limits<f64> = Limits::symmetric(0.3, 1e9);

/// Default control law for a period \[s].
pub fn hybrid(period: f64) -> HybridLaw<f64> {
    HybridLaw::fitted(&DRIVE, &LIMITS, period, Direction::Auto)
}

pub fn deployed(law: HybridLaw<f64>) -> DeployedController {
    DeployedController { law: Law::Hybrid(law), drive: DRIVE, braking: None, limits: LIMITS }
}

/// Default control law with the gains of the paper.
pub fn paper_gains(period: f64) -> HybridLaw<f64> {
    HybridLaw { gains: Gains::tran2012(), ..hybrid(period) }
}

/// Noise bounds in the units of the command line: position \[m], heading \[°].
pub fn noise(position: f64, heading_deg: f64) -> NoiseBounds {
    NoiseBounds { position, heading: heading_deg.to_radians(), ..NoiseBounds::default() }
}

pub fn request<L: SampledController>(
    controller: &L,
    h: f64,
    period: f64,
    noise: NoiseBounds,
) -> Request<'_, L> {
    Request {
        controller,
        drive: DRIVE,
        limits: LIMITS,
        h,
        period,
        noise,
        workspace: 5.0,
        max_capture_radius: 0.15,
        rests_within: 0.0,
        max_period_searched: 0.0,
    }
}

/// Deterministic random numbers in [−1, 1): upper half of a 64-bit linear congruential generator.
pub struct Rng(pub u64);

impl Rng {
    pub fn either(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        f64::from((self.0 >> 32) as u32) / f64::from(1_u32 << 31) - 1.0
    }
    pub fn flip(&mut self) -> bool {
        self.either() < 0.0
    }
}

pub fn trials() -> u64 {
    std::env::var("SUREPOSE_CERT_TRIALS").ok().and_then(|n| n.parse().ok()).unwrap_or(400_000)
}

/// Draws noise within its bounds; half of the position and heading samples lie on them.
pub fn disturb(disturbed_state: &mut DisturbedState, bounds: &NoiseBounds, rng: &mut Rng) {
    let (direction, size) = (PI * rng.either(), if rng.flip() { 1.0 } else { rng.either().abs() });
    let reach = bounds.position * size * (1.0 - 1e-12);
    (disturbed_state.noise_x, disturbed_state.noise_y) = (reach * direction.cos(), reach * direction.sin());
    let part = rng.either();
    disturbed_state.noise_heading = bounds.heading * if rng.flip() { part.signum() } else { part };
}
