//! From a scan to the lines of its walls: the pipeline.

use crate::angle::Angle;
use crate::frame::Laser;
use crate::line::Line;
use crate::scalar::Float;

use super::beam::{Beam, BeamNoise, read};
use super::boundary::certain;
use super::evidence::{Evidence, misfit_limit};
use super::fit::{NOBODY, fit};
use super::join::{Candidate, adopt, join};
use super::scan::{RangeFinder, Scan, ScanRefusal};
use super::segment::{MOST_SEGMENTS, ROUGHEST, find};

/// The most lines of one scan.
pub const MOST_LINES: usize = MOST_SEGMENTS;

/// The fewest beams of a line.
const FEWEST: f64 = 6.0;

/// The vaguest direction of a line \[rad]: beyond it (r, ψ) is no longer linear in what the beams say.
const VAGUEST: f64 = 0.08;

/// The shortest line \[m]: what is shorter is as likely a leg as a wall, and two legs on one line are no longer.
const SHORTEST: f64 = 0.25;

/// A wall as one scan sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenLine<S> {
    /// Where it is; its distance is positive, so its normal points away from the laser.
    pub line: Line<Laser, S>,
    /// Variance of the distance r \[m²].
    pub distance_variance: S,
    /// Variance of the direction ψ \[rad²].
    pub direction_variance: S,
    /// Covariance of the two \[m·rad].
    pub covariance: S,
    /// From where to where it was seen: distances from the foot of the perpendicular, to its left \[m].
    pub extent: (S, S),
    /// How many beams see it.
    pub beams: u16,
    /// χ² of these beams per degree of freedom: 1 where wall and laser are what they are said to be.
    pub roughness: S,
}

/// How many lines were found and then refused, by reason.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RefusedLines {
    /// Too few beams are sure to see it, for how steeply they meet it.
    pub too_few_beams: u16,
    /// Its beams do not lie on a straight line.
    pub not_straight: u16,
    /// It is too short, or its direction too uncertain.
    pub too_vague: u16,
}

/// What a scan says of the walls.
#[derive(Clone, Copy, Debug)]
pub struct Extracted<'a, S> {
    /// The lines, in the order of the beams.
    pub lines: &'a [SeenLine<S>],
    /// How many more were refused.
    pub refused: RefusedLines,
    /// For each beam that came back, in order: its number in the scan and the line it belongs to.
    beams: &'a [Beam<S>],
    owner: &'a [u8],
}

impl<S: Float> Extracted<'_, S> {
    /// For each beam on a line: its number in the scan, and that of the line.
    pub fn beams(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let owned = self.beams.iter().zip(self.owner).filter(|(_, owner)| **owner != NOBODY);
        owned.map(|(beam, owner)| (usize::from(beam.number), usize::from(*owner)))
    }
}

/// Finds lines in scans of up to `BEAMS` beams.
///
/// It holds the memory that the work needs, about 40 bytes a beam in `f64`, and nothing from one scan to the next.
/// The work is bounded by a constant times the number of beams times [`MOST_LINES`]; in rooms it is a few passes over
/// the beams.
#[derive(Clone, Debug)]
pub struct LineExtractor<S, const BEAMS: usize> {
    beams: [Beam<S>; BEAMS],
    owner: [u8; BEAMS],
    lines: [SeenLine<S>; MOST_LINES],
}

impl<S: Float, const BEAMS: usize> Default for LineExtractor<S, BEAMS> {
    fn default() -> Self {
        Self::new()
    }
}

impl<S: Float, const BEAMS: usize> LineExtractor<S, BEAMS> {
    /// An extractor with nothing in it.
    pub fn new() -> Self {
        let zero = S::of(0.0);
        let nothing = SeenLine {
            line: Line::new(zero, Angle::zero()),
            distance_variance: zero,
            direction_variance: zero,
            covariance: zero,
            extent: (zero, zero),
            beams: 0,
            roughness: zero,
        };
        Self { beams: [Beam::default(); BEAMS], owner: [NOBODY; BEAMS], lines: [nothing; MOST_LINES] }
    }

    /// The walls in `scan`. Beams without a return, or with one that is not a number, are as if not there.
    ///
    /// # Errors
    /// [`ScanRefusal`], before anything is looked at.
    pub fn extract(
        &mut self,
        laser: &RangeFinder<S>,
        scan: &Scan<'_, S>,
    ) -> Result<Extracted<'_, S>, ScanRefusal> {
        laser.check()?;
        scan.check(BEAMS.min(usize::from(u16::MAX)))?;
        let noise = BeamNoise::of(laser);
        let back = read(laser, scan, &mut self.beams);
        let (beams, owner) = (&self.beams[..back], &mut self.owner[..back]);

        let segments = find(&noise, beams);
        let (mut walls, mut pieces) = join(&segments);
        adopt(&noise, beams, &walls, &mut pieces);
        let pieces = certain(&noise, beams, scan, &walls, &pieces);
        let evidences = fit(&noise, beams, &pieces, &mut walls, owner);

        let mut refused = RefusedLines::default();
        let mut number = [NOBODY; MOST_SEGMENTS];
        let mut kept = 0;
        for (wall, (candidate, evidence)) in walls.iter().zip(evidences.iter()).enumerate() {
            let on_wall = |i: &usize| usize::from(owner[*i]) == wall;
            let own = pieces.iter().filter(|piece| piece.wall == wall);
            let stretches = own.filter_map(|piece| {
                let mut own = (piece.first..=piece.last).filter(on_wall);
                let first = own.next()?;
                let [first, last] = [first, own.next_back().unwrap_or(first)];
                Some((candidate.line.along(&beams[first]), candidate.line.along(&beams[last])))
            });
            match judge(&noise, candidate, evidence, stretches) {
                Ok(line) => {
                    self.lines[kept] = line;
                    number[wall] = kept as u8;
                    kept += 1;
                }
                Err(Flaw::TooFewBeams) => refused.too_few_beams += 1,
                Err(Flaw::NotStraight) => refused.not_straight += 1,
                Err(Flaw::TooVague) => refused.too_vague += 1,
            }
        }
        for o in owner.iter_mut() {
            *o = number.get(usize::from(*o)).copied().unwrap_or(NOBODY);
        }
        Ok(Extracted { lines: &self.lines[..kept], refused, beams, owner })
    }
}

/// Why a line is refused.
enum Flaw {
    TooFewBeams,
    NotStraight,
    TooVague,
}

/// The line in (r, ψ) with its covariance, if it is one to rely on.
fn judge<S: Float>(
    noise: &BeamNoise<S>,
    candidate: &Candidate<S>,
    evidence: &Evidence<S>,
    stretches: impl Iterator<Item = (S, S)>,
) -> Result<SeenLine<S>, Flaw> {
    let count = S::of(f64::from(evidence.count));
    let mut extent = (S::of(f64::INFINITY), S::of(f64::NEG_INFINITY));
    let mut longest = S::of(0.0);
    for (one, other) in stretches {
        extent = (extent.0.min(one.min(other)), extent.1.max(one.max(other)));
        longest = longest.max((one - other).abs());
    }
    let inverse_squared = candidate.line.a.squared() + candidate.line.b.squared();
    let distance = S::of(1.0) / inverse_squared.sqrt();
    if evidence.count < 4 || count < fewest(noise, distance, extent) {
        return Err(Flaw::TooFewBeams);
    }

    let roughness = evidence.misfit / (count - S::of(2.0));
    let is_plain = evidence.misfit <= misfit_limit(evidence.count);
    if !is_plain && (evidence.count < 20 || roughness > S::of(ROUGHEST)) {
        return Err(Flaw::NotStraight);
    }

    let widened = S::select(is_plain, S::of(1.0), roughness);
    let seen = polar(candidate, widened, extent, evidence.count, roughness);
    let sharp = seen.direction_variance <= S::of(VAGUEST * VAGUEST)
        && seen.distance_variance > S::of(0.0)
        && seen.direction_variance > S::of(0.0)
        && seen.distance_variance.is_finite();
    if sharp && longest >= S::of(SHORTEST) { Ok(seen) } else { Err(Flaw::TooVague) }
}

/// The line in (r, ψ), with the covariance of (a, b) times `widened`.
///
/// To first order ∂r = −r²·n·∂(a, b) and ∂ψ = r·t·∂(a, b), with n = (cos ψ, sin ψ) and t to its left. That is not enough
/// for a short wall far beside the foot of its perpendicular: its beams know to a centimetre where it passes them and
/// hardly which way it goes. Turned by δ about them, its distance changes by −l·δ − ½·r·δ², with l from the foot to them;
/// the second term, of mean −½·r·σ² and variance ½·r²·σ⁴ for a normal δ, may be larger than the centimetre. With the first
/// term only, lines of 8 beams in the loop world had a mean NEES of 2.7 for 2, and the filter that used them 3.16 for 3.
fn polar<S: Float>(
    candidate: &Candidate<S>,
    widened: S,
    extent: (S, S),
    beams: u16,
    roughness: S,
) -> SeenLine<S> {
    let (line, spread) = (&candidate.line, &candidate.spread);
    let distance = S::of(1.0) / (line.a.squared() + line.b.squared()).sqrt();
    let (nx, ny) = (line.a * distance, line.b * distance);
    let (two, half) = (S::of(2.0), S::of(0.5));
    let normal = spread.aa * nx.squared() + two * spread.ab * nx * ny + spread.bb * ny.squared();
    let tangential = spread.aa * ny.squared() - two * spread.ab * nx * ny + spread.bb * nx.squared();
    let mixed = (spread.bb - spread.aa) * nx * ny + spread.ab * (nx.squared() - ny.squared());
    let squared = distance.squared() * widened;
    let direction_variance = tangential * squared;
    let bent = half * direction_variance.squared();
    SeenLine {
        line: Line::new(
            distance * (S::of(1.0) - half * direction_variance),
            Angle::of_vector(line.a, line.b),
        ),
        distance_variance: distance.squared() * (normal * squared + bent),
        direction_variance,
        covariance: -(mixed * squared * distance),
        extent,
        beams,
        roughness,
    }
}

/// How many beams it takes to believe in a line.
///
/// A wall met so steeply that bearing noise moves a range more than range noise does is easily made up from a few beams
/// on either side of an edge: up to six more are asked for.
fn fewest<S: Float>(noise: &BeamNoise<S>, distance: S, extent: (S, S)) -> S {
    let middle = (extent.0 + extent.1) * S::of(0.5);
    let beside = S::select(extent.0 * extent.1 < S::of(0.0), S::of(0.0), middle);
    let tangent_squared = (beside / distance).squared();
    let by_bearing = tangent_squared * (distance.squared() + beside.squared()) * noise.bearing;
    S::of(FEWEST) + (by_bearing / noise.range).min(S::of(6.0))
}
