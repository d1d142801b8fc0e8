//! Motion between recorded odometry poses.

use surepose::{Angle, Body, Frame, Integration, Map, Motion, Point, Pose};
use surepose_data::recording::StampedPose;

/// Converts a recorded pose to the core's type.
pub(crate) fn pose_of(at: &StampedPose) -> Pose<Map, Body, f64> {
    Pose::new(at.x, at.y, Angle::from_radians(at.heading))
}

/// Returns the motion along the arc from one pose to the other: the inverse of [`Pose::integrate`].
///
/// Displacement off the arc is not a motion of wheels and is dropped.
pub fn motion_between<In: Frame>(from: Pose<In, Body, f64>, to: Pose<In, Body, f64>) -> Motion<f64> {
    let turn = (to.heading - from.heading).radians();
    let (sin, cos) = from.heading.rotated_by(0.5 * turn).sin_cos();
    let chord = (to.x - from.x) * cos + (to.y - from.y) * sin;
    let unit = Pose::<In, Body, f64>::identity().integrate(Motion { length: 1.0, turn }, Integration::Arc);
    Motion { length: chord / unit.origin().distance(Point::new(0.0, 0.0)), turn }
}

/// Returns the pose after `count` records, interpolated on the arc between two of them.
pub(super) fn pose_after(records: &[StampedPose], count: f64) -> Option<Pose<Map, Body, f64>> {
    let whole = libm::floor(count);
    let last = records.len().checked_sub(1)?;
    let record = |count: f64| records.get(((count - 1.0).max(0.0) as usize).min(last)).map(pose_of);
    let (before, after) = (record(whole)?, record(whole + 1.0)?);
    let motion = motion_between(before, after);
    let part = Motion { length: motion.length * (count - whole), turn: motion.turn * (count - whole) };
    Some(before.integrate(part, Integration::Arc))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn motion_between_poses_inverts_integrate() {
        let from: Pose<Map, Body, f64> = Pose::new(1.0, -2.0, Angle::from_degrees(170.0));
        for motion in [(0.3, 0.5), (-0.2, -3.0), (0.4, 0.0), (0.0, 1.0)] {
            let motion = Motion { length: motion.0, turn: motion.1 };
            let to = from.integrate(motion, Integration::Arc);
            let found = motion_between(from, to);
            assert!((found.length - motion.length).abs() < 1e-12 && (found.turn - motion.turn).abs() < 1e-12);
        }
    }

    #[test]
    fn interpolated_poses_are_on_the_arc() {
        let at = |x: f64| StampedPose { time: 0.0, x, y: 0.0, heading: 0.0 };
        let records = [at(0.0), at(1.0), at(3.0)];
        let x = |count: f64| pose_after(&records, count).map(|pose| pose.x);
        assert_eq!([0.5, 1.0, 1.5, 2.25, 3.0, 9.0].map(x), [0.0, 0.0, 0.5, 1.5, 3.0, 3.0].map(Some));
        assert_eq!(pose_after(&[], 1.0), None);
    }
}
