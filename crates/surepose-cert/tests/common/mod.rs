//! What the certificate's tests share: the shipped law and requests for it.
#![allow(dead_code, unreachable_pub, reason = "each test file uses a part")]

use surepose::{Direction, Drive, Gains, HybridLaw, Law, Limits};
use surepose_cert::{Noise, Request, Shipped, Subject};

pub const DRIVE: Drive<f64> = Drive::new(0.05, 0.6);
pub const LIMITS: Limits<f64> = Limits { wheel_speed: 0.3, wheel_acceleration: 1e9 };

/// The default law for a period \[s].
pub fn hybrid(period: f64) -> HybridLaw<f64> {
    HybridLaw::fitted(&DRIVE, &LIMITS, period, Direction::Auto)
}

pub fn shipped(law: HybridLaw<f64>) -> Shipped {
    Shipped { law: Law::Hybrid(law), drive: DRIVE, limits: LIMITS }
}

/// The default law with the gains that the paper prints.
pub fn paper_gains(period: f64) -> HybridLaw<f64> {
    HybridLaw { gains: Gains::paper(), ..hybrid(period) }
}

/// Bounds as on the command line: \[m], \[°].
pub fn noise(position: f64, heading_deg: f64) -> Noise {
    Noise { position, heading: heading_deg.to_radians(), ..Noise::default() }
}

pub fn request<L: Subject>(subject: &L, h: f64, period: f64, noise: Noise) -> Request<'_, L> {
    Request {
        subject,
        drive: DRIVE,
        limits: LIMITS,
        h,
        period,
        noise,
        workspace: 5.0,
        largest_capture_radius: 0.15,
        longest_period: 0.0,
    }
}
