//! Maximum-likelihood lines, with and without things standing before the walls.

use core::f64::consts::PI;

use crate::scalar::Float;

use super::beam::{Beam, BeamNoise};
use super::evidence::Evidence;
use super::join::{Candidates, Piece, Pieces};
use super::list::List;
use super::ray_line::RayLine;
use super::segment::MOST_SEGMENTS;

/// √(2π).
const SQRT_TAU: f64 = 2.506_628_274_631_000_5;

/// Gauss–Newton steps, at most. One or two do, but for walls seen at a grazing angle or among other things.
const STEPS: usize = 5;

/// A step is the last when it moves no line by more than a tenth of its standard deviation: this is its square.
const SETTLED: f64 = 0.01;

/// A beam farther off its wall than this many standard deviations hit something else.
///
/// Of the wall's own beams one in 1000 is lost, and with them 1 % of the information: see [`CUT`].
const GATE: f64 = 3.3;

/// How much greater the variance of a line is than the inverse of the sum of its beams' information.
///
/// A beam that is cut off at the gate g says nothing, and it is cut off because of what it would have said. An estimate
/// from the score x·[|x| < g] has the variance E(score²)/E(score′)² [Huber1964], and both means are P − 2·g·N(g), with N
/// the normal density and P its part inside the gate; the sum counts each beam inside as 1, together P. So P/(P − 2·g·N(g)).
const CUT: f64 = 1.0115;

/// Beams that end between the gate and so many standard deviations before their wall tell how densely things stand
/// there: far enough not to be the wall's own, near enough to say what is hidden under its noise.
const SHORT: f64 = 8.0;

/// The owner of beams that lie on no wall.
pub(super) const NOBODY: u8 = u8::MAX;

/// The misfit of a beam that does not meet the line at all.
const MISSED: f64 = 1e30;

pub(super) type Evidences<S> = List<Evidence<S>, MOST_SEGMENTS>;

/// Moves the walls' lines to the maximum of the likelihood of their beams; what these say at last is the result.
///
/// The score of a range ρ = 1/u(φ) is taken with the *line's* range, not the measured one, in the Jacobian and the
/// weight: a measured range there would be correlated with its own residual, and the line biased towards the laser.
/// The normal matrix is then the Fisher information of (a, b), and its inverse their covariance.
///
/// `owner` is told which wall each beam lies on, or [`NOBODY`].
pub(super) fn fit<S: Float>(
    noise: &BeamNoise<S>,
    beams: &[Beam<S>],
    pieces: &Pieces,
    walls: &mut Candidates<S>,
    owner: &mut [u8],
) -> Evidences<S> {
    owner.fill(NOBODY);
    let mut evidences = Evidences::new();
    let mut density = S::of(0.0);
    for _ in 0..STEPS {
        evidences.clear();
        for _ in 0..walls.len() {
            evidences.push(Evidence::default());
        }
        let mut tally = Tally::default();
        for piece in pieces.iter() {
            let (Some(candidate), Some(evidence)) = (walls.get(piece.wall), evidences.get_mut(piece.wall))
            else {
                continue;
            };
            let view = View { noise, line: &candidate.line, density };
            if density > S::of(0.0) {
                view.look(beams, piece, owner, evidence, &mut tally, View::mixed);
            } else {
                view.look(beams, piece, owner, evidence, &mut tally, View::plain);
            }
        }
        let mut farthest = S::of(0.0);
        for (wall, evidence) in walls.iter_mut().zip(evidences.iter_mut()) {
            let (step, spread) = evidence.solve();
            wall.line = wall.line.plus(step);
            wall.spread = spread.times(S::of(CUT));
            let squared = evidence.gain_of(step);
            evidence.misfit = evidence.misfit - squared;
            farthest = farthest.max(squared);
        }
        let per_beam = f64::from(tally.short) / f64::from(tally.own.max(1));
        let denser = S::of(per_beam / (SHORT - GATE));
        if farthest < S::of(SETTLED) && denser == density {
            break;
        }
        density = denser;
    }
    evidences
}

/// How many beams lie on their walls, and how many end shortly before.
#[derive(Clone, Copy, Default)]
struct Tally {
    own: u16,
    short: u16,
}

/// A line as the beams of its wall are compared with it.
struct View<'a, S> {
    noise: &'a BeamNoise<S>,
    line: &'a RayLine<S>,
    /// How many beams end on other things in each standard deviation before the wall, for each that ends on it.
    density: S,
}

/// A beam beside a line.
struct Residual<S> {
    /// How much greater the inverse range is than the line's \[1/m].
    value: S,
    /// One by its variance.
    weight: S,
    /// Its square in units of the variance.
    misfit: S,
}

impl<S: Float> View<'_, S> {
    #[inline]
    fn residual(&self, beam: &Beam<S>) -> Residual<S> {
        let (u, slope) = self.line.at(beam);
        let weight = S::of(1.0) / self.noise.variance(u, slope);
        // To first order, and without the bias of an inverse: u·(1 − ρ·u) instead of 1/ρ − u. A line that the beam
        // does not meet has u ≤ 0.
        let value = u * (S::of(1.0) - beam.range * u);
        let misfit = S::select(u > S::of(0.0), value.squared() * weight, S::of(MISSED));
        Residual { value, weight, misfit }
    }

    /// Adds what the beams of a piece say, each with the value and the weight that `judge` gives it.
    #[inline]
    fn look(
        &self,
        beams: &[Beam<S>],
        piece: &Piece,
        owner: &mut [u8],
        evidence: &mut Evidence<S>,
        tally: &mut Tally,
        judge: impl Fn(&Self, &Residual<S>) -> (S, S),
    ) {
        // Local sums stay in registers.
        let mut sum = *evidence;
        let (mut own, mut short) = (0, 0);
        let own_beams = beams.iter().zip(owner).take(piece.last + 1).skip(piece.first);
        for (beam, owner) in own_beams {
            let residual = self.residual(beam);
            let (value, belief) = judge(self, &residual);
            if belief > S::of(0.0) {
                sum.add(beam, residual.weight * belief, value);
            }
            if residual.misfit < S::of(GATE * GATE) {
                own += 1;
                sum.misfit = sum.misfit + residual.misfit * belief;
                *owner = piece.wall as u8;
            } else {
                *owner = NOBODY;
                short += u16::from(residual.value > S::of(0.0) && residual.misfit < S::of(SHORT * SHORT));
            }
        }
        sum.count += own;
        tally.own += own;
        tally.short += short;
        *evidence = sum;
    }

    /// Every beam inside the gate is the wall's.
    #[inline]
    fn plain(_: &Self, residual: &Residual<S>) -> (S, S) {
        let inside = residual.misfit < S::of(GATE * GATE);
        (residual.value, S::select(inside, S::of(1.0), S::of(0.0)))
    }

    /// Each beam is the wall's as far as it is believed to be.
    #[inline]
    fn mixed(&self, residual: &Residual<S>) -> (S, S) {
        let std = S::of(1.0) / residual.weight.sqrt();
        let belief = belief_in_wall(self.density, residual.value / std, residual.misfit);
        (residual.value - self.density * std, belief)
    }
}

/// How much a beam counts as one of its wall's, `sigmas` standard deviations short of it: 0 to 1.
///
/// # Clutter
/// Let d beams, for every one of the wall's, end on other things in each σ of range before the wall. At x standard
/// deviations short the density is then N(x) + d·Φ(x), up to a factor. The derivative of its logarithm by the wall's
/// distance is that of the wall's own beams with x replaced by x − d, times 1/(1 + d·Φ(x)/N(x)): a shift, for what is
/// hidden under the wall's own noise, and a weight. Cutting at a gate g instead leaves the lines short by about
/// d·g²/2 standard deviations, in every direction, and no averaging over time removes that.
#[inline]
fn belief_in_wall<S: Float>(density: S, sigmas: S, squared: S) -> S {
    let (zero, one) = (S::of(0.0), S::of(1.0));
    let inside = squared < S::of(GATE * GATE);
    if squared > S::of(SHORT * SHORT) || !inside && sigmas < zero {
        return zero;
    }
    // Φ(x) to 1 %; exp(x²/2) = (1 − x²/128)^(−64) to 1 % for x < 1.8 and too large beyond, where it drowns the 1.
    let half = S::of(0.5);
    let cumulative = half + half * sigmas / (squared + S::of(0.5 * PI)).sqrt();
    let mut root = one - squared * S::of(1.0 / 128.0);
    for _ in 0..6 {
        root = root.squared();
    }
    one / (one + density * cumulative * S::of(SQRT_TAU) / root)
}
