//! Beams of a scan, projected to the map.

use crate::estimation::Belief;
use crate::geometry::{Laser, Map, Point, Pose};
use crate::lidar::scan::{RangeFinder, Scan};
use crate::map::Wall;
use crate::scalar::Float;

/// Index of no wall.
const UNASSIGNED: u16 = u16::MAX;

/// Gate of the distance of a beam from its wall, in standard deviations.
const GATE: f64 = 3.0;

/// Margin of a wall beyond its end in the map \[m], and the fraction of the gate of the beam that adds to it.
const END_MARGIN: f64 = 0.05;
const END_MARGIN_PER_GATE: f64 = 0.3;

/// A beam with a return, and its associated wall.
#[derive(Clone, Copy, Debug)]
pub(super) struct MapBeam<S> {
    /// cos φ, sin φ of the bearing in the laser frame.
    cos: S,
    sin: S,
    /// Range \[m].
    pub range: S,
    /// End point on the map \[m].
    pub end: (S, S),
    /// Direction on the map.
    pub direction: (S, S),
    /// Maximum distance of the wall from the end point \[m].
    pub gate: S,
    /// Distance of the nearest wall from the end point \[m].
    distance_to_wall: S,
    wall: u16,
}

impl<S: Float> Default for MapBeam<S> {
    fn default() -> Self {
        let zero = S::from_f64(0.0);
        Self {
            cos: zero,
            sin: zero,
            range: zero,
            end: (zero, zero),
            direction: (zero, zero),
            gate: zero,
            distance_to_wall: zero,
            wall: UNASSIGNED,
        }
    }
}

impl<S: Float> MapBeam<S> {
    /// Associates the beam with this wall if it is nearer than the present one.
    #[inline]
    pub(super) fn try_associate(&mut self, number: u16, candidate: &Wall<S>) {
        let end = Point::new(self.end.0, self.end.1);
        let off = candidate.line().distance_from(end).abs();
        if off < self.distance_to_wall {
            let beyond = candidate.distance_beyond_ends(end);
            let longer = S::from_f64(END_MARGIN).max(self.gate * S::from_f64(END_MARGIN_PER_GATE));
            let distance = (off.squared() + beyond.squared()).sqrt();
            if beyond < longer && distance < self.distance_to_wall {
                self.distance_to_wall = distance;
                self.wall = number;
            }
        }
    }

    #[inline]
    pub(super) fn is_associated_with(&self, number: u16) -> bool {
        self.wall == number
    }
}

/// Fills `beams` with the beams that have a return, and returns their number.
pub(super) fn read_returns<S: Float>(
    laser: &RangeFinder<S>,
    scan: &Scan<'_, S>,
    beams: &mut [MapBeam<S>],
) -> usize {
    let mut count = 0;
    for (number, range) in scan.ranges.iter().copied().enumerate() {
        if let (true, Some(slot)) = (laser.is_return(range), beams.get_mut(count)) {
            let bearing = scan.angle_min.radians() + scan.angle_increment * S::from_f64(number as f64);
            let (sin, cos) = bearing.sin_cos();
            *slot = MapBeam { cos, sin, range, ..MapBeam::default() };
            count += 1;
        }
    }
    count
}

/// Projects the beams from `estimate` to the map and clears their associations.
pub(super) fn project<S: Float>(
    estimate: &Belief<S>,
    map_from_laser: Pose<Map, Laser, S>,
    range_std: S,
    max_correspondence_distance: S,
    beams: &mut [MapBeam<S>],
) {
    let (sin, cos) = map_from_laser.heading.sin_cos();
    let position = estimate.covariance.entry(0, 0) + estimate.covariance.entry(1, 1);
    let heading = estimate.covariance.entry(2, 2);
    for beam in beams {
        beam.direction = (cos * beam.cos - sin * beam.sin, sin * beam.cos + cos * beam.sin);
        beam.end = (
            map_from_laser.x + beam.range * beam.direction.0,
            map_from_laser.y + beam.range * beam.direction.1,
        );
        let variance = position + beam.range.squared() * heading + range_std.squared();
        beam.gate = (S::from_f64(GATE) * variance.sqrt()).min(max_correspondence_distance);
        beam.distance_to_wall = beam.gate;
        beam.wall = UNASSIGNED;
    }
}

/// Sum of the squared normalized distances of the beams from their walls, each bounded by the gate.
pub(super) fn total_cost<S: Float>(laser: &RangeFinder<S>, beams: &[MapBeam<S>]) -> S {
    let scale = S::from_f64(1.0) / laser.range_std.squared();
    let max_cost = S::from_f64(GATE * GATE);
    let cost = |beam: &MapBeam<S>| {
        if beam.wall == UNASSIGNED {
            max_cost
        } else {
            (beam.distance_to_wall.squared() * scale).min(max_cost)
        }
    };
    beams.iter().fold(S::from_f64(0.0), |sum, beam| sum + cost(beam))
}
