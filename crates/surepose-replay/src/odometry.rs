//! Interpolation of recorded odometry poses.

use surepose::geometry::{Angle, Body, Map, Pose};
use surepose::kinematics::{Integration, Motion};
use surepose_io::recording::StampedPose;

/// Converts a recorded pose to the core's type.
pub(crate) fn pose_of(at: &StampedPose) -> Pose<Map, Body, f64> {
    Pose::new(at.x, at.y, Angle::from_radians(at.heading))
}

/// Returns the pose after `count` records, interpolated on the arc between two of them; `None` without records.
pub(super) fn pose_after(records: &[StampedPose], count: f64) -> Option<Pose<Map, Body, f64>> {
    let whole = libm::floor(count);
    let last = records.len().checked_sub(1)?;
    let record = |count: f64| records.get(((count - 1.0).max(0.0) as usize).min(last)).map(pose_of);
    let (before, after) = (record(whole)?, record(whole + 1.0)?);
    let motion = Motion::between(before, after);
    let part = Motion { length: motion.length * (count - whole), turn: motion.turn * (count - whole) };
    Some(before.integrate(part, Integration::Arc))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn interpolated_poses_are_on_the_arc() {
        let at = |x: f64| StampedPose { time: 0.0, x, y: 0.0, heading: 0.0 };
        let records = [at(0.0), at(1.0), at(3.0)];
        let x = |count: f64| pose_after(&records, count).map(|pose| pose.x);
        assert_eq!([0.5, 1.0, 1.5, 2.25, 3.0, 9.0].map(x), [0.0, 0.0, 0.5, 1.5, 3.0, 3.0].map(Some));
        assert_eq!(pose_after(&[], 1.0), None);
    }
}
