//! Poses of the robot during a sweep of the laser.

use std::collections::VecDeque;

use surepose::geometry::{Body, Map, Pose};
use surepose::lidar::StampedBeam;
use surepose::time::Stamp;

/// Time that a laser needs for a scan, and how its driver states it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LaserSweep {
    /// Time from the first beam to the last \[s]; 0 for beams that are all measured at once.
    pub duration: f64,
    /// The beam that the stamp of a scan belongs to.
    pub stamped: StampedBeam,
}

/// True poses of the last moments, oldest first.
#[derive(Clone, Debug, Default)]
pub struct PoseTrack {
    poses: VecDeque<(Stamp, Pose<Map, Body, f64>)>,
}

impl LaserSweep {
    /// Time from the stamped beam to the last one \[s].
    pub fn stamp_age(&self) -> f64 {
        self.duration * (1.0 - self.stamped.fraction())
    }
}

impl PoseTrack {
    /// Adds the pose at `now`, and drops those that no sweep of this duration \[s] needs.
    pub fn record(&mut self, now: Stamp, pose: Pose<Map, Body, f64>, duration: f64) {
        let begin = now.after(-duration);
        while self.poses.get(1).is_some_and(|(next, _)| *next <= begin) {
            self.poses.pop_front();
        }
        self.poses.push_back((now, pose));
    }

    /// Pose at `stamp`, interpolated between two recorded poses; the identity if there is none.
    pub fn at(&self, stamp: Stamp) -> Pose<Map, Body, f64> {
        let after = self.poses.partition_point(|(recorded, _)| *recorded < stamp);
        let last = self.poses.len().saturating_sub(1);
        let (Some(&(end, to)), Some(&(start, from))) =
            (self.poses.get(after.min(last)), self.poses.get(after.saturating_sub(1).min(last)))
        else {
            return Pose::identity();
        };
        let whole = end.since(start);
        let part = if whole > 0.0 { stamp.since(start) / whole } else { 0.0 };
        let turn = (to.heading - from.heading).radians();
        Pose::new(
            from.x + (to.x - from.x) * part,
            from.y + (to.y - from.y) * part,
            from.heading.rotated_by(turn * part),
        )
    }
}
