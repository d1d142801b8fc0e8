//! Reference trajectory of a recording.

use surepose::geometry::{Angle, Body, Map, Pose};
use surepose_io::recording::StampedPose;

/// Maximum interval between samples for interpolation \[s].
const MAX_GAP: f64 = 0.1;

/// Maximum interval of a slow reference \[s], and the time from a sample within which it is interpolated: the robot's
/// acceleration is unknown.
const MAX_SLOW_GAP: f64 = 2.0;
const NEAR_SAMPLE: f64 = 0.02;

/// Reference poses with interpolation.
#[derive(Clone, Copy, Debug)]
pub struct Reference<'a> {
    poses: &'a [StampedPose],
}

impl<'a> Reference<'a> {
    /// Creates the reference from `poses`, which are ordered by time.
    pub fn new(poses: &'a [StampedPose]) -> Self {
        Self { poses }
    }

    /// Returns the median interval between samples \[s]; `None` if there are fewer than two.
    pub fn interval(&self) -> Option<f64> {
        let mut intervals: Vec<f64> = self.poses.windows(2).map(|pair| pair[1].time - pair[0].time).collect();
        let middle = intervals.len() / 2;
        (!intervals.is_empty()).then(|| *intervals.select_nth_unstable_by(middle, f64::total_cmp).1)
    }

    /// Returns the true pose at `time` \[s]; `None` outside the record and inside its gaps. Between samples more than 0.1 s
    /// apart, only times close to one of them have a pose.
    pub fn at(&self, time: f64) -> Option<Pose<Map, Body, f64>> {
        let after = self.poses.partition_point(|pose| pose.time <= time);
        let before = self.poses.get(after.checked_sub(1)?)?;
        let heading = Angle::from_radians(before.heading);
        let Some(next) = self.poses.get(after) else {
            // The last sample has no successor to interpolate to.
            return (before.time >= time).then(|| Pose::new(before.x, before.y, heading));
        };
        let span = next.time - before.time;
        let is_near = time - before.time <= NEAR_SAMPLE || next.time - time <= NEAR_SAMPLE;
        if span > MAX_GAP && !(is_near && span <= MAX_SLOW_GAP) {
            return None;
        }
        let share = (time - before.time) / span;
        let turn = (Angle::from_radians(next.heading) - heading).radians();
        Some(Pose::new(
            before.x + share * (next.x - before.x),
            before.y + share * (next.y - before.y),
            heading.rotated_by(share * turn),
        ))
    }

    /// Returns the length of the true path between `start` and `end` \[m].
    pub fn distance(&self, start: f64, end: f64) -> f64 {
        let first = self.poses.partition_point(|pose| pose.time < start);
        let last = self.poses.partition_point(|pose| pose.time <= end);
        let within = self.poses.get(first..last).unwrap_or_default();
        let step = |pair: &[StampedPose]| libm::hypot(pair[1].x - pair[0].x, pair[1].y - pair[0].y);
        within.windows(2).map(step).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pose(time: f64, x: f64, heading: f64) -> StampedPose {
        StampedPose { time, x, y: 2.0 * x, heading }
    }

    #[test]
    fn headings_are_interpolated_over_the_shorter_arc() {
        let poses = [pose(0.0, 0.0, 3.1), pose(0.1, 1.0, -3.1)];
        let middle = Reference::new(&poses).at(0.05).unwrap();
        assert!((middle.x - 0.5).abs() < 1e-12 && (middle.y - 1.0).abs() < 1e-12);
        assert!((middle.heading.radians().abs() - core::f64::consts::PI).abs() < 1e-12);
    }

    #[test]
    fn reference_is_none_outside_the_record_and_in_gaps() {
        let poses = [pose(0.0, 0.0, 0.0), pose(0.05, 1.0, 0.0), pose(0.2, 2.0, 0.0)];
        let reference = Reference::new(&poses);
        assert!(
            reference.at(-0.01).is_none()
                && reference.at(0.1).is_none()
                && reference.at(0.19).is_some()
                && reference.at(0.21).is_none()
        );
        assert!((reference.at(0.2).unwrap().x - 2.0).abs() < 1e-12);
        assert!((reference.distance(0.0, 0.1) - 5.0_f64.sqrt()).abs() < 1e-12);
    }
}
