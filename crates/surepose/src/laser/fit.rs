//! Maximum-likelihood lines, with and without things standing before the walls.

use core::f64::consts::PI;

use crate::scalar::Float;

use super::beam::{Beam, BeamNoise};
use super::boundary::NOBODY;
use super::evidence::Evidence;
use super::join::Candidates;
use super::list::List;
use super::segment::MOST_SEGMENTS;

/// Gauss–Newton steps. The start is a least-squares line already: the second step moves it by rounding only where the
/// first changed a weight or a gate; the third is for lines seen at a grazing angle.
const STEPS: usize = 3;

/// A beam farther off its wall than this many standard deviations hit something else.
///
/// Of the wall's own beams one in 1000 is lost, and with them 1 % of the residual variance.
const GATE: f64 = 3.3;

/// From this share of beams that end before their walls on, the fit counts with things that stand there.
const CLUTTERED: f64 = 0.02;

pub(super) type Evidences<S> = List<Evidence<S>, MOST_SEGMENTS>;

/// Moves the walls' lines to the maximum of the likelihood of their beams; what these say at last is the result.
///
/// The score of a range ρ = 1/u(φ) is taken with the *line's* range, not the measured one, in the Jacobian and the
/// weight: a measured range there would be correlated with its own residual, and the line biased towards the laser.
/// The normal matrix is then the Fisher information of (a, b), and its inverse their covariance.
///
/// Afterwards `owner` names only beams that really lie on their wall.
pub(super) fn fit<S: Float>(
    noise: &BeamNoise<S>,
    beams: &[Beam<S>],
    owner: &mut [u8],
    walls: &mut Candidates<S>,
) -> Evidences<S> {
    let mut evidences = Evidences::new();
    let mut odds = S::of(0.0);
    for step in 0..STEPS {
        evidences.clear();
        for _ in 0..walls.len() {
            evidences.push(Evidence::default());
        }
        let (mut short, mut all) = (0_u16, 0_u16);
        for (beam, owner) in beams.iter().zip(owner.iter_mut()) {
            let Some(wall) = walls.get(usize::from(*owner)) else { continue };
            let (u, slope) = wall.line.at(beam);
            let weight = S::of(1.0) / noise.variance(u, slope);
            // The residual of the inverse range to first order, without its bias: u·(ρ·u − 1) instead of u − 1/ρ.
            let residual = u * (S::of(1.0) - beam.range * u);
            let misfit = residual.squared() * weight;
            all += 1;
            short += u16::from(misfit > S::of(GATE * GATE) && residual > S::of(0.0));
            let (share, shift) = belief_in_wall(odds, u, residual, misfit, weight);
            let on_wall = u > S::of(0.0) && share > S::of(0.5);
            if let (true, Some(evidence)) =
                (u > S::of(0.0) && share > S::of(0.0), evidences.get_mut(usize::from(*owner)))
            {
                evidence.add(beam, weight * share, residual - shift);
                evidence.count += u16::from(on_wall);
                evidence.misfit = evidence.misfit + misfit * share;
            }
            if step + 1 == STEPS && !on_wall {
                *owner = NOBODY;
            }
        }
        for (wall, evidence) in walls.iter_mut().zip(evidences.iter_mut()) {
            let (step, spread) = evidence.solve();
            wall.line = wall.line.plus(step);
            wall.spread = spread;
            evidence.misfit = evidence.misfit - evidence.gain_of(step);
        }
        odds = odds_of(short, all);
    }
    evidences
}

/// The odds that a beam ends before its wall, 0 while that is so rare that the gate can deal with it.
fn odds_of<S: Float>(short: u16, all: u16) -> S {
    let share = f64::from(short) / f64::from(all.max(1));
    // One in ten of these ends so close to the wall that it is not told apart.
    let share = (1.1 * share).min(0.5);
    if share > CLUTTERED { S::of(share / (1.0 - share)) } else { S::of(0.0) }
}

/// How much a beam counts as one of the wall, and what its residual is to be reduced by.
///
/// # Clutter
/// With odds q/(1−q) a beam ends anywhere between the laser and its wall at distance m, evenly: at the error e of the
/// range, with σ its standard deviation, the density is (1−q)·N(e; σ) + (q/m)·Φ(−e/σ). The derivative of its logarithm
/// by m is w·(e + κσ²)/σ², w = 1/(1 + κ·Φ(−e/σ)/N(e; σ)), κ = q/(1−q)/m: a weight, and a shift for what is hidden
/// under the wall's own noise. Cutting at a gate instead leaves the lines short by half of κ·(gate·σ)², in all
/// directions, which no amount of averaging over time removes.
#[inline]
fn belief_in_wall<S: Float>(odds: S, u: S, residual: S, misfit: S, weight: S) -> (S, S) {
    let (zero, one) = (S::of(0.0), S::of(1.0));
    let inside = misfit < S::of(GATE * GATE);
    if odds <= zero {
        return (S::select(inside, one, zero), zero);
    }
    let variance = one / weight;
    let sigmas = residual * weight.sqrt();
    if !inside && (residual < zero || misfit > S::of(64.0)) {
        return (zero, zero);
    }
    // Φ(x) to 1 %, and exp(q/2) = (1 − q/128)^(−64) to 1 % where it matters, q < 5, and much too large beyond.
    let half = S::of(0.5);
    let cumulative = half + half * sigmas / (sigmas.squared() + S::of(0.5 * PI)).sqrt();
    let mut root = one - misfit * S::of(1.0 / 128.0);
    for _ in 0..6 {
        root = root.squared();
    }
    let ratio = odds * cumulative * (S::of(2.0 * PI) * variance).sqrt() / (u * root);
    (one / (one + ratio), odds * variance / u)
}
