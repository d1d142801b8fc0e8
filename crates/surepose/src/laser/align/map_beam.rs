//! The beams of a scan, placed on the map.

use crate::estimate::Belief;
use crate::frame::{Laser, Map};
use crate::laser::scan::{RangeFinder, Scan};
use crate::laser::wall::Wall;
use crate::pose::{Point, Pose};
use crate::scalar::Float;

/// No wall.
const NOBODY: u16 = u16::MAX;

/// How many standard deviations a beam may end from its wall.
const GATE: f64 = 3.0;

/// How far a wall may reach beyond its end in the map \[m], and how much of a beam's own gate.
const LONGER: f64 = 0.05;
const LONGER_BY_GATE: f64 = 0.3;

/// A beam that came back, and the wall it is given to.
#[derive(Clone, Copy, Debug)]
pub(super) struct MapBeam<S> {
    /// cos φ, sin φ of its bearing in the laser's frame.
    cos: S,
    sin: S,
    /// Its range \[m].
    pub range: S,
    /// Where it ended on the map \[m].
    pub end: (S, S),
    /// Its direction on the map.
    pub direction: (S, S),
    /// How far from the end its wall may be \[m].
    pub gate: S,
    /// How far from the end the nearest wall is \[m].
    nearest: S,
    owner: u16,
}

impl<S: Float> Default for MapBeam<S> {
    fn default() -> Self {
        let zero = S::of(0.0);
        Self {
            cos: zero,
            sin: zero,
            range: zero,
            end: (zero, zero),
            direction: (zero, zero),
            gate: zero,
            nearest: zero,
            owner: NOBODY,
        }
    }
}

impl<S: Float> MapBeam<S> {
    /// Gives the beam to this wall, if it is nearer than the one it has.
    #[inline]
    pub(super) fn offer(&mut self, number: u16, wall: &Wall<S>) {
        let end = Point::new(self.end.0, self.end.1);
        let off = wall.line().distance_from(end).abs();
        if off < self.nearest {
            let beyond = wall.beyond(end);
            let longer = S::of(LONGER).max(self.gate * S::of(LONGER_BY_GATE));
            let distance = (off.squared() + beyond.squared()).sqrt();
            if beyond < longer && distance < self.nearest {
                self.nearest = distance;
                self.owner = number;
            }
        }
    }

    #[inline]
    pub(super) fn is_of(&self, number: u16) -> bool {
        self.owner == number
    }
}

/// Fills `beams` with what came back and says how many these are.
pub(super) fn read<S: Float>(laser: &RangeFinder<S>, scan: &Scan<'_, S>, beams: &mut [MapBeam<S>]) -> usize {
    let mut count = 0;
    for (number, range) in scan.ranges.iter().copied().enumerate() {
        if let (true, Some(slot)) = (laser.came_back(range), beams.get_mut(count)) {
            let bearing = scan.first_bearing.radians() + scan.bearing_step * S::of(number as f64);
            let (sin, cos) = bearing.sin_cos();
            *slot = MapBeam { cos, sin, range, ..MapBeam::default() };
            count += 1;
        }
    }
    count
}

/// Puts the beams where they end if the robot is where it is `found`, and takes their walls away.
pub(super) fn place<S: Float>(
    found: &Belief<S>,
    map_from_laser: Pose<Map, Laser, S>,
    range_std: S,
    farthest_off: S,
    beams: &mut [MapBeam<S>],
) {
    let (sin, cos) = map_from_laser.heading.sin_cos();
    let position = found.covariance.entry(0, 0) + found.covariance.entry(1, 1);
    let heading = found.covariance.entry(2, 2);
    for beam in beams {
        beam.direction = (cos * beam.cos - sin * beam.sin, sin * beam.cos + cos * beam.sin);
        beam.end = (
            map_from_laser.x + beam.range * beam.direction.0,
            map_from_laser.y + beam.range * beam.direction.1,
        );
        let variance = position + beam.range.squared() * heading + range_std.squared();
        beam.gate = (S::of(GATE) * variance.sqrt()).min(farthest_off);
        beam.nearest = beam.gate;
        beam.owner = NOBODY;
    }
}

/// How badly the beams fit the walls they were given to: their squared normalised distances, each bounded by the gate's.
pub(super) fn misfit<S: Float>(laser: &RangeFinder<S>, beams: &[MapBeam<S>]) -> S {
    let scale = S::of(1.0) / laser.range_std.squared();
    let most = S::of(GATE * GATE);
    let of = |beam: &MapBeam<S>| {
        if beam.owner == NOBODY { most } else { (beam.nearest.squared() * scale).min(most) }
    };
    beams.iter().fold(S::of(0.0), |sum, beam| sum + of(beam))
}
