//! Extraction of wall lines from a scan: the pipeline.

use crate::geometry::{Angle, Laser, Line};
use crate::scalar::Float;

use super::beam::{Beam, BeamNoise, read_returns};
use super::boundary::trim_ambiguous;
use super::fit::{UNASSIGNED, fit};
use super::line_normal_equations::{LineNormalEquations, chi2_limit};
use super::merge::{WallCandidate, merge, reclaim_orphans};
use super::scan::{RangeFinder, Scan, ScanError};
use super::segment::{MAX_REDUCED_CHI2, MAX_SEGMENTS, find};

/// Maximum number of lines of one scan.
pub const MAX_LINES: usize = MAX_SEGMENTS;

/// Minimum number of beams of a line.
const MIN_BEAMS: f64 = 6.0;

/// Maximum standard deviation of a direction \[rad]. Beyond it (r, ψ) is not linear in the beams.
const MAX_DIRECTION_STD: f64 = 0.08;

/// Minimum length of a line \[m]. Shorter lines are as likely legs as walls; two legs on one line are no longer.
const MIN_LENGTH: f64 = 0.25;

/// A wall line in one scan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExtractedLine<S> {
    /// The line. Its distance is positive: the normal points away from the laser.
    pub line: Line<Laser, S>,
    /// Variance of the distance r \[m²].
    pub distance_variance: S,
    /// Variance of the direction ψ \[rad²].
    pub direction_variance: S,
    /// Covariance of distance and direction \[m·rad].
    pub covariance: S,
    /// Visible extent: positions of both ends from the foot of the perpendicular, positive left \[m].
    pub extent: (S, S),
    /// Number of beams on the line.
    pub beams: u16,
    /// χ² of the beams per degree of freedom: 1 where wall and laser agree with their noise models.
    pub reduced_chi2: S,
}

/// Counts of rejected lines, by reason.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RejectedLines {
    /// Too few unambiguous beams for the angle of incidence.
    pub too_few_beams: u16,
    /// The beams do not lie on a straight line.
    pub not_straight: u16,
    /// The line is too short, or its direction too uncertain.
    pub too_uncertain: u16,
}

/// Lines of one scan.
#[derive(Clone, Copy, Debug)]
pub struct LineExtraction<'a, S> {
    /// Lines, in the order of the beams.
    pub lines: &'a [ExtractedLine<S>],
    /// Counts of the rejected lines.
    pub rejected: RejectedLines,
    /// The beams with a return, in order.
    beams: &'a [Beam<S>],
    wall_of_beam: &'a [u8],
}

impl<S: Float> LineExtraction<'_, S> {
    /// Index in the scan and index of the line, for each beam on a line.
    pub fn beams(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let owned =
            self.beams.iter().zip(self.wall_of_beam).filter(|(_, wall_of_beam)| **wall_of_beam != UNASSIGNED);
        owned.map(|(beam, wall_of_beam)| (usize::from(beam.number), usize::from(*wall_of_beam)))
    }
}

/// Extracts lines from scans of up to `BEAMS` beams.
///
/// The struct is workspace only, about 40 bytes a beam in `f64`; no state passes from one scan to the next.
/// The work is bounded by a constant times the number of beams times [`MAX_LINES`]. In rooms it is a few passes over
/// the beams.
#[derive(Clone, Debug)]
pub struct LineExtractor<S, const BEAMS: usize> {
    beams: [Beam<S>; BEAMS],
    wall_of_beam: [u8; BEAMS],
    lines: [ExtractedLine<S>; MAX_LINES],
}

impl<S: Float, const BEAMS: usize> Default for LineExtractor<S, BEAMS> {
    fn default() -> Self {
        Self::new()
    }
}

impl<S: Float, const BEAMS: usize> LineExtractor<S, BEAMS> {
    /// Extractor with an empty workspace.
    pub fn new() -> Self {
        let zero = S::from_f64(0.0);
        let empty = ExtractedLine {
            line: Line::new(zero, Angle::zero()),
            distance_variance: zero,
            direction_variance: zero,
            covariance: zero,
            extent: (zero, zero),
            beams: 0,
            reduced_chi2: zero,
        };
        Self { beams: [Beam::default(); BEAMS], wall_of_beam: [UNASSIGNED; BEAMS], lines: [empty; MAX_LINES] }
    }

    /// Extracts the wall lines of `scan`. Beams without a return, or with a NaN range, are ignored.
    ///
    /// # Errors
    /// [`ScanError`] for a scan or laser that is invalid.
    pub fn extract(
        &mut self,
        laser: &RangeFinder<S>,
        scan: &Scan<'_, S>,
    ) -> Result<LineExtraction<'_, S>, ScanError> {
        laser.check()?;
        scan.check(BEAMS.min(usize::from(u16::MAX)))?;
        let noise = BeamNoise::from_laser(laser);
        let returns = read_returns(laser, scan, &mut self.beams);
        let (beams, wall_of_beam) = (&self.beams[..returns], &mut self.wall_of_beam[..returns]);

        let segments = find(&noise, beams);
        let (mut walls, mut runs) = merge(&segments);
        reclaim_orphans(&noise, beams, &walls, &mut runs);
        let runs = trim_ambiguous(&noise, beams, scan, &walls, &runs);
        let equations_of_walls = fit(&noise, beams, &runs, &mut walls, wall_of_beam);

        let mut rejected = RejectedLines::default();
        let mut number = [UNASSIGNED; MAX_SEGMENTS];
        let mut kept = 0;
        for (wall, (candidate, equations)) in walls.iter().zip(equations_of_walls.iter()).enumerate() {
            let on_wall = |i: &usize| usize::from(wall_of_beam[*i]) == wall;
            let own = runs.iter().filter(|run| run.wall == wall);
            let stretches = own.filter_map(|run| {
                let mut own = (run.first..=run.last).filter(on_wall);
                let first = own.next()?;
                let [first, last] = [first, own.next_back().unwrap_or(first)];
                Some((candidate.line.along(&beams[first]), candidate.line.along(&beams[last])))
            });
            match validated(&noise, candidate, equations, stretches) {
                Ok(line) => {
                    self.lines[kept] = line;
                    number[wall] = kept as u8;
                    kept += 1;
                }
                Err(LineRejection::TooFewBeams) => rejected.too_few_beams += 1,
                Err(LineRejection::NotStraight) => rejected.not_straight += 1,
                Err(LineRejection::TooUncertain) => rejected.too_uncertain += 1,
            }
        }
        for o in wall_of_beam.iter_mut() {
            *o = number.get(usize::from(*o)).copied().unwrap_or(UNASSIGNED);
        }
        Ok(LineExtraction { lines: &self.lines[..kept], rejected, beams, wall_of_beam })
    }
}

/// Reason for the rejection of a line.
enum LineRejection {
    TooFewBeams,
    NotStraight,
    TooUncertain,
}

/// The line in (r, ψ) with its covariance, if it passes all checks.
fn validated<S: Float>(
    noise: &BeamNoise<S>,
    candidate: &WallCandidate<S>,
    equations: &LineNormalEquations<S>,
    stretches: impl Iterator<Item = (S, S)>,
) -> Result<ExtractedLine<S>, LineRejection> {
    let count = S::from_f64(f64::from(equations.count));
    let mut extent = (S::from_f64(f64::INFINITY), S::from_f64(f64::NEG_INFINITY));
    let mut longest = S::from_f64(0.0);
    for (one, other) in stretches {
        extent = (extent.0.min(one.min(other)), extent.1.max(one.max(other)));
        longest = longest.max((one - other).abs());
    }
    let inverse_squared = candidate.line.a.squared() + candidate.line.b.squared();
    let distance = S::from_f64(1.0) / inverse_squared.sqrt();
    if equations.count < 4 || count < min_beams(noise, distance, extent) {
        return Err(LineRejection::TooFewBeams);
    }

    let reduced_chi2 = equations.chi2 / (count - S::from_f64(2.0));
    let is_plain = equations.chi2 <= chi2_limit(equations.count);
    if !is_plain && (equations.count < 20 || reduced_chi2 > S::from_f64(MAX_REDUCED_CHI2)) {
        return Err(LineRejection::NotStraight);
    }

    let variance_scale = S::select(is_plain, S::from_f64(1.0), reduced_chi2);
    let seen = polar(candidate, variance_scale, extent, equations.count, reduced_chi2);
    let is_certain = seen.direction_variance <= S::from_f64(MAX_DIRECTION_STD * MAX_DIRECTION_STD)
        && seen.distance_variance > S::from_f64(0.0)
        && seen.direction_variance > S::from_f64(0.0)
        && seen.distance_variance.is_finite();
    if is_certain && longest >= S::from_f64(MIN_LENGTH) { Ok(seen) } else { Err(LineRejection::TooUncertain) }
}

/// Converts a line to (r, ψ), with the covariance of (a, b) times `variance_scale`.
///
/// To first order ∂r = −r²·n·∂(a, b) and ∂ψ = r·t·∂(a, b), with n = (cos ψ, sin ψ) and t to its left. First order is
/// insufficient for a short wall far from the foot of its perpendicular: its beams fix its position to a centimeter
/// and its direction hardly. Turned by δ about the beams, its distance changes by −l·δ − ½·r·δ², with l from the foot
/// to the beams. The second term has the mean −½·r·σ² and the variance ½·r²·σ⁴ for a normal δ, and may exceed the
/// centimeter. With the first term only, lines of 8 beams in the loop world had a mean NEES of 2.7 (expected 2). The
/// filter that used them had 3.16 (expected 3).
fn polar<S: Float>(
    candidate: &WallCandidate<S>,
    variance_scale: S,
    extent: (S, S),
    beams: u16,
    reduced_chi2: S,
) -> ExtractedLine<S> {
    let (line, covariance) = (&candidate.line, &candidate.covariance);
    let distance = S::from_f64(1.0) / (line.a.squared() + line.b.squared()).sqrt();
    let (nx, ny) = (line.a * distance, line.b * distance);
    let (two, half) = (S::from_f64(2.0), S::from_f64(0.5));
    let normal = covariance.aa * nx.squared() + two * covariance.ab * nx * ny + covariance.bb * ny.squared();
    let tangential =
        covariance.aa * ny.squared() - two * covariance.ab * nx * ny + covariance.bb * nx.squared();
    let mixed = (covariance.bb - covariance.aa) * nx * ny + covariance.ab * (nx.squared() - ny.squared());
    let squared = distance.squared() * variance_scale;
    let direction_variance = tangential * squared;
    let bent = half * direction_variance.squared();
    ExtractedLine {
        line: Line::new(
            distance * (S::from_f64(1.0) - half * direction_variance),
            Angle::from_vector(line.a, line.b),
        ),
        distance_variance: distance.squared() * (normal * squared + bent),
        direction_variance,
        covariance: -(mixed * squared * distance),
        extent,
        beams,
        reduced_chi2,
    }
}

/// Minimum number of beams of a line.
///
/// At steep incidence, bearing noise moves a range more than range noise does. A false wall from a few beams on either
/// side of an edge is then likely, and up to six more beams are required.
fn min_beams<S: Float>(noise: &BeamNoise<S>, distance: S, extent: (S, S)) -> S {
    let middle = (extent.0 + extent.1) * S::from_f64(0.5);
    let beside = S::select(extent.0 * extent.1 < S::from_f64(0.0), S::from_f64(0.0), middle);
    let tangent_squared = (beside / distance).squared();
    let by_bearing = tangent_squared * (distance.squared() + beside.squared()) * noise.bearing;
    S::from_f64(MIN_BEAMS) + (by_bearing / noise.range).min(S::from_f64(6.0))
}
