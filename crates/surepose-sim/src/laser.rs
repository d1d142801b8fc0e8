//! Laser range finder: ray casting against wall segments, with the noise of [Tran2012] Sec. 5.2.

mod sweep;

use core::f64::consts::PI;

use surepose::geometry::{Angle, Body, Laser, Map, Pose};
use surepose::time::Stamp;

use crate::arena::WallSegment;
use crate::random::Stream;

pub use sweep::{LaserSweep, PoseTrack};

/// Parameters of a laser range finder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LaserModel {
    /// Extrinsics: pose of the laser in the body frame.
    pub body_from_laser: Pose<Body, Laser, f64>,
    /// Angle of the first beam in the laser frame \[rad].
    pub angle_min: f64,
    /// Angle between successive beams \[rad]; negative for clockwise scans.
    pub angle_increment: f64,
    /// Number of beams.
    pub beams: usize,
    /// Standard deviation of a range \[m].
    pub range_std: f64,
    /// Standard deviation of the beam direction \[rad].
    pub bearing_std: f64,
    /// Range beyond which there is no return \[m].
    pub max_range: f64,
    /// Obstacles that are on no map.
    pub clutter: Clutter,
    /// Probability that a beam has no return.
    pub lost: f64,
    /// Time that a scan takes.
    pub sweep: LaserSweep,
}

/// Obstacles that are on no map, such as people; each hides several adjacent beams.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Clutter {
    /// Fraction of hidden beams, in [0, 1).
    pub fraction: f64,
    /// Mean number of adjacent beams hidden by one obstacle, at least 1.
    pub width: f64,
}

/// One laser scan.
///
/// The range of a beam without return is +∞. NaN occurs only as the result of a fault.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SimulatedScan {
    /// Angle of the first beam in the laser frame \[rad].
    pub angle_min: f64,
    /// Angle between successive beams \[rad].
    pub angle_increment: f64,
    /// Ranges of all beams \[m].
    pub ranges: Vec<f64>,
    /// Time from one beam to the next \[s].
    pub time_increment: f64,
}

impl LaserModel {
    /// The paper's laser with `beams` beams over 180°, at the body origin, facing forward.
    pub fn half_circle(beams: usize) -> Self {
        Self::facing_forward(beams, PI)
    }

    /// As [`LaserModel::half_circle`], with another field of view \[rad].
    pub fn facing_forward(beams: usize, field_of_view: f64) -> Self {
        Self {
            body_from_laser: Pose::identity(),
            angle_min: -0.5 * field_of_view,
            angle_increment: field_of_view / beams.saturating_sub(1).max(1) as f64,
            beams,
            range_std: 0.030,
            bearing_std: 0.25_f64.to_radians(),
            max_range: 8.0,
            clutter: Clutter::default(),
            lost: 0.0,
            sweep: LaserSweep::default(),
        }
    }

    /// Simulates a scan of `walls` whose beams are all measured at the true pose.
    pub fn scan(
        &self,
        walls: &[WallSegment],
        map_from_body: Pose<Map, Body, f64>,
        noise: &mut Stream,
    ) -> SimulatedScan {
        let bearings = self.bearings(noise);
        let rays = Rays::cast(map_from_body * self.body_from_laser, &bearings, walls);
        self.finished(rays.ranges, 0.0, noise)
    }

    /// Simulates a scan whose last beam is measured at `end`, each beam at the pose of its time.
    pub fn sweep(
        &self,
        walls: &[WallSegment],
        track: &PoseTrack,
        end: Stamp,
        noise: &mut Stream,
    ) -> SimulatedScan {
        let bearings = self.bearings(noise);
        let steps = self.beams.saturating_sub(1).max(1);
        let time_increment = self.sweep.duration / steps as f64;
        let range = |(number, bearing): (usize, &f64)| {
            let before_end = time_increment * (steps as f64 - number as f64);
            let map_from_laser = track.at(end.after(-before_end)) * self.body_from_laser;
            Rays::cast(map_from_laser, core::slice::from_ref(bearing), walls).ranges.first().copied()
        };
        let ranges = bearings.iter().enumerate().filter_map(range).collect();
        self.finished(ranges, time_increment, noise)
    }

    /// Direction of each beam, with its noise \[rad].
    fn bearings(&self, noise: &mut Stream) -> Vec<f64> {
        let nominal = |i: usize| self.angle_min + self.angle_increment * i as f64;
        (0..self.beams).map(|i| nominal(i) + self.bearing_std * noise.normal()).collect()
    }

    /// Adds clutter, noise and missing returns to the distances of the walls.
    fn finished(&self, mut ranges: Vec<f64>, time_increment: f64, noise: &mut Stream) -> SimulatedScan {
        self.clutter.hide(&mut ranges, noise);
        for range in &mut ranges {
            let read = *range + self.range_std * noise.normal();
            let back = *range <= self.max_range && !noise.bernoulli(self.lost);
            *range = if back { read.max(0.0) } else { f64::INFINITY };
        }
        let Self { angle_min, angle_increment, .. } = *self;
        SimulatedScan { angle_min, angle_increment, ranges, time_increment }
    }
}

impl Clutter {
    /// Hides beams at 20 % to 90 % of the distance to the wall.
    fn hide(&self, ranges: &mut [f64], noise: &mut Stream) {
        if self.fraction <= 0.0 {
            return;
        }
        // Markov chain with the states free and hidden; the parameters give the mean run length and the
        // fraction.
        let leave = 1.0 / self.width.max(1.0);
        let fraction = self.fraction.min(0.99);
        let enter = leave * fraction / (1.0 - fraction);
        let mut hidden = noise.bernoulli(fraction);
        let mut part = noise.uniform(0.2, 0.9);
        for range in ranges {
            if hidden {
                *range *= part;
            }
            let change = noise.bernoulli(if hidden { leave } else { enter });
            if change {
                hidden = !hidden;
                part = noise.uniform(0.2, 0.9);
            }
        }
    }
}

/// Rays from one origin and their ranges \[m].
struct Rays {
    origin: (f64, f64),
    cos: Vec<f64>,
    sin: Vec<f64>,
    ranges: Vec<f64>,
}

impl Rays {
    fn cast(map_from_laser: Pose<Map, Laser, f64>, bearings: &[f64], walls: &[WallSegment]) -> Self {
        let beams = bearings.len();
        let (mut cos, mut sin) = (Vec::with_capacity(beams), Vec::with_capacity(beams));
        for bearing in bearings {
            let direction: Angle<f64> = map_from_laser.heading.rotated_by(*bearing);
            let (s, c) = direction.sin_cos();
            cos.push(c);
            sin.push(s);
        }
        let origin = (map_from_laser.x, map_from_laser.y);
        let mut rays = Self { origin, cos, sin, ranges: vec![f64::INFINITY; beams] };
        for wall in walls {
            rays.meet(wall);
        }
        rays
    }

    /// Shortens the rays that intersect `wall`.
    ///
    /// The inner loop runs over the rays without branches, so the compiler can vectorize it.
    #[allow(
        clippy::needless_bitwise_bool,
        clippy::manual_range_contains,
        reason = "lazy operators are branches, and branches keep the loop from being vector code"
    )]
    fn meet(&mut self, wall: &WallSegment) {
        let (ax, ay) = (wall.start.x - self.origin.0, wall.start.y - self.origin.1);
        let (ex, ey) = (wall.end.x - wall.start.x, wall.end.y - wall.start.y);
        // Intersection of ray t·d and wall a + u·e: t = (a × e)/(d × e), u = (a × d)/(d × e).
        let area = ax * ey - ay * ex;
        let directions = self.cos.iter().zip(&self.sin);
        for (range, (cos, sin)) in self.ranges.iter_mut().zip(directions) {
            let per_cross = 1.0 / (cos * ey - sin * ex);
            let t = area * per_cross;
            let u = (ax * sin - ay * cos) * per_cross;
            // A ray parallel to the wall gives NaN or ∞, which compares false.
            let meets = (t > 0.0) & (u >= 0.0) & (u <= 1.0) & (t < *range);
            *range = if meets { t } else { *range };
        }
    }
}

#[cfg(test)]
mod tests;
