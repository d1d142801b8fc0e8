//! Maximum-likelihood line fits, with and without clutter before the walls.

use core::f64::consts::PI;

use crate::scalar::Float;

use super::beam::{Beam, BeamNoise};
use super::fixed_vec::FixedVec;
use super::inverse_range_line::InverseRangeLine;
use super::line_normal_equations::LineNormalEquations;
use super::merge::{BeamRun, BeamRuns, WallCandidates};
use super::segment::MAX_SEGMENTS;

/// √(2π).
const SQRT_TAU: f64 = 2.506_628_274_631_000_5;

/// Maximum Gauss–Newton iterations. One or two suffice except at grazing incidence or in clutter.
const MAX_ITERATIONS: usize = 5;

/// Convergence threshold of the squared step, in variances of the line: a tenth of a standard deviation.
const CONVERGENCE_THRESHOLD: f64 = 0.01;

/// Gate of a beam of the wall, in standard deviations; beams outside belong to other objects.
///
/// It rejects 1 of 1000 beams of the wall and with them 1 % of the information, see [`GATE_VARIANCE_FACTOR`].
const GATE: f64 = 3.3;

/// Ratio of the variance of a line to the inverse of the summed information of its beams.
///
/// A beam outside the gate g adds no information, and its rejection depends on its residual. An estimate from the
/// score x·[|x| < g] has the variance E(score²)/E(score′)² [Huber1964]. Both means are P − 2·g·N(g), with N the
/// normal density and P its part inside the gate. The sum counts each beam inside as 1, together P. The ratio is
/// therefore P/(P − 2·g·N(g)).
const GATE_VARIANCE_FACTOR: f64 = 1.0115;

/// Limit of short beams, in standard deviations before the wall. Beams between [`GATE`] and this limit measure the
/// density of clutter: they are not returns of the wall, and are near enough to predict the clutter hidden under its
/// noise.
const SHORT_GATE: f64 = 8.0;

/// Wall index of beams that lie on no wall.
pub(super) const UNASSIGNED: u8 = u8::MAX;

/// χ² of a beam that does not meet the line.
const NO_INTERSECTION_CHI2: f64 = 1e30;

pub(super) type EquationsOfWalls<S> = FixedVec<LineNormalEquations<S>, MAX_SEGMENTS>;

/// Moves the lines of the walls to the maximum of the likelihood of their beams; returns the final normal equations.
///
/// The Jacobian and the weight of the score of a range ρ = 1/u(φ) use the range of the *line*, not the measured range.
/// A measured range would be correlated with its own residual and would bias the line toward the laser.
/// The normal matrix is then the Fisher information of (a, b), and its inverse their covariance.
///
/// `wall_of_beam` receives the wall index of each beam, or [`UNASSIGNED`].
pub(super) fn fit<S: Float>(
    noise: &BeamNoise<S>,
    beams: &[Beam<S>],
    runs: &BeamRuns,
    walls: &mut WallCandidates<S>,
    wall_of_beam: &mut [u8],
) -> EquationsOfWalls<S> {
    wall_of_beam.fill(UNASSIGNED);
    let mut equations_of_walls = EquationsOfWalls::new();
    let mut density = S::from_f64(0.0);
    for _ in 0..MAX_ITERATIONS {
        equations_of_walls.clear();
        for _ in 0..walls.len() {
            equations_of_walls.push(LineNormalEquations::default());
        }
        let mut counts = BeamCounts::default();
        for run in runs.iter() {
            let (Some(candidate), Some(equations)) =
                (walls.get(run.wall), equations_of_walls.get_mut(run.wall))
            else {
                continue;
            };
            let model = LineModel { noise, line: &candidate.line, density };
            if density > S::from_f64(0.0) {
                model.accumulate(beams, run, wall_of_beam, equations, &mut counts, LineModel::mixture);
            } else {
                model.accumulate(beams, run, wall_of_beam, equations, &mut counts, LineModel::gated);
            }
        }
        let mut largest_step = S::from_f64(0.0);
        for (wall, equations) in walls.iter_mut().zip(equations_of_walls.iter_mut()) {
            let (step, covariance) = equations.solve();
            wall.line = wall.line.plus(step);
            wall.covariance = covariance.times(S::from_f64(GATE_VARIANCE_FACTOR));
            let squared = equations.cost_reduction(step);
            equations.chi2 = equations.chi2 - squared;
            largest_step = largest_step.max(squared);
        }
        let per_beam = f64::from(counts.short) / f64::from(counts.own.max(1));
        let denser = S::from_f64(per_beam / (SHORT_GATE - GATE));
        if largest_step < S::from_f64(CONVERGENCE_THRESHOLD) && denser == density {
            break;
        }
        density = denser;
    }
    equations_of_walls
}

/// Numbers of beams on their walls and of beams that end shortly before them.
#[derive(Clone, Copy, Default)]
struct BeamCounts {
    own: u16,
    short: u16,
}

/// A wall line and the density of clutter before it.
struct LineModel<'a, S> {
    noise: &'a BeamNoise<S>,
    line: &'a InverseRangeLine<S>,
    /// Clutter returns per standard deviation before the wall, for each return of the wall.
    density: S,
}

/// Residual of a beam with respect to a line.
struct Residual<S> {
    /// Inverse range of the beam minus that of the line \[1/m].
    value: S,
    /// Inverse of the variance.
    weight: S,
    /// Squared residual divided by its variance.
    chi2: S,
}

impl<S: Float> LineModel<'_, S> {
    #[inline]
    fn residual(&self, beam: &Beam<S>) -> Residual<S> {
        let (u, slope) = self.line.at(beam);
        let weight = S::from_f64(1.0) / self.noise.variance(u, slope);
        // First order, and without the bias of an inverse: u·(1 − ρ·u) instead of 1/ρ − u. A beam that does not meet
        // the line has u ≤ 0.
        let value = u * (S::from_f64(1.0) - beam.range * u);
        let chi2 =
            S::select(u > S::from_f64(0.0), value.squared() * weight, S::from_f64(NO_INTERSECTION_CHI2));
        Residual { value, weight, chi2 }
    }

    /// Adds the beams of a run, each with the value and the weight from `weighting`.
    #[inline]
    fn accumulate(
        &self,
        beams: &[Beam<S>],
        run: &BeamRun,
        wall_of_beam: &mut [u8],
        equations: &mut LineNormalEquations<S>,
        counts: &mut BeamCounts,
        weighting: impl Fn(&Self, &Residual<S>) -> (S, S),
    ) {
        // Local sums stay in registers.
        let mut sum = *equations;
        let (mut own, mut short) = (0, 0);
        let own_beams = beams.iter().zip(wall_of_beam).take(run.last + 1).skip(run.first);
        for (beam, wall_of_beam) in own_beams {
            let residual = self.residual(beam);
            let (value, probability) = weighting(self, &residual);
            if probability > S::from_f64(0.0) {
                sum.add(beam, residual.weight * probability, value);
            }
            if residual.chi2 < S::from_f64(GATE * GATE) {
                own += 1;
                sum.chi2 = sum.chi2 + residual.chi2 * probability;
                *wall_of_beam = run.wall as u8;
            } else {
                *wall_of_beam = UNASSIGNED;
                short += u16::from(
                    residual.value > S::from_f64(0.0) && residual.chi2 < S::from_f64(SHORT_GATE * SHORT_GATE),
                );
            }
        }
        sum.count += own;
        counts.own += own;
        counts.short += short;
        *equations = sum;
    }

    /// Gives weight 1 to every beam inside the gate.
    #[inline]
    fn gated(_: &Self, residual: &Residual<S>) -> (S, S) {
        let inside = residual.chi2 < S::from_f64(GATE * GATE);
        (residual.value, S::select(inside, S::from_f64(1.0), S::from_f64(0.0)))
    }

    /// Weights each beam by its probability to belong to the wall.
    #[inline]
    fn mixture(&self, residual: &Residual<S>) -> (S, S) {
        let std = S::from_f64(1.0) / residual.weight.sqrt();
        let probability = wall_probability(self.density, residual.value / std, residual.chi2);
        (residual.value - self.density * std, probability)
    }
}

/// Weight of a beam that ends `sigmas` standard deviations before its wall, 0 to 1.
///
/// # Clutter
/// Let d beams, for each beam of the wall, end on clutter in each σ of range before the wall. At x standard deviations
/// before the wall the density is then N(x) + d·Φ(x), up to a factor. The derivative of its logarithm by the distance
/// of the wall is that of the beams of the wall with x replaced by x − d, times 1/(1 + d·Φ(x)/N(x)). The shift
/// accounts for clutter hidden under the noise of the wall; the factor is the weight. A hard gate g instead makes the
/// lines too short by about d·g²/2 standard deviations in every direction, which averaging over time does not remove.
#[inline]
fn wall_probability<S: Float>(density: S, sigmas: S, squared: S) -> S {
    let (zero, one) = (S::from_f64(0.0), S::from_f64(1.0));
    let inside = squared < S::from_f64(GATE * GATE);
    if squared > S::from_f64(SHORT_GATE * SHORT_GATE) || !inside && sigmas < zero {
        return zero;
    }
    // Φ(x) to 1 %. exp(x²/2) = (1 − x²/128)^(−64) to 1 % for x < 1.8; beyond, it is too large and dominates the 1.
    let half = S::from_f64(0.5);
    let cumulative = half + half * sigmas / (squared + S::from_f64(0.5 * PI)).sqrt();
    let mut root = one - squared * S::from_f64(1.0 / 128.0);
    for _ in 0..6 {
        root = root.squared();
    }
    one / (one + density * cumulative * S::from_f64(SQRT_TAU) / root)
}
