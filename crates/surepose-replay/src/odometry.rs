//! Recorded odometry poses: gaps, motions and interpolation.

use surepose::geometry::{Angle, Body, Map, Pose};
use surepose::kinematics::{Integration, Motion};
use surepose_io::recording::StampedPose;

/// Converts a recorded pose to the core's type.
pub(crate) fn pose_of(at: &StampedPose) -> Pose<Map, Body, f64> {
    Pose::new(at.x, at.y, Angle::from_radians(at.heading))
}

/// An interval this many times as long as the median one is a gap.
const GAP_INTERVALS: f64 = 3.0;
/// Without usable stamps, a motion this many times as large as the 90 % quantile is a gap, and at least so large: length \[m],
/// turn \[rad].
const GAP_MOTIONS: f64 = 5.0;
const MIN_GAP_MOTION: [f64; 2] = [0.3, 0.3];
/// Share of the usual motion that adds to the noise over a gap. The noise of the presets is several times that of usual odometry,
/// and the encoders count on.
const UNSEEN_SHARE: f64 = 0.2;
/// Length \[m] or turn \[rad] that counts as a motion of usual size, at least.
const MIN_LENGTH: f64 = 1e-9;

/// Odometry poses by record, with the gaps between them.
#[derive(Clone, Debug)]
pub(crate) struct RecordedOdometry {
    poses: Vec<Pose<Map, Body, f64>>,
    /// Number of usual intervals in the interval that ends at a record; 1 outside gaps.
    intervals: Vec<f64>,
    /// Median interval \[s]; 0 if the stamps are too coarse.
    pub(crate) period: f64,
    /// Mean motion of a record: length \[m], turn without sign \[rad].
    mean: Motion<f64>,
}

impl RecordedOdometry {
    /// Finds the gaps of `records` by their stamps, or by their motions if the stamps are too coarse.
    pub(crate) fn new(records: &[StampedPose]) -> Self {
        let poses: Vec<_> = records.iter().map(pose_of).collect();
        let times: Vec<f64> = records.windows(2).map(|pair| pair[1].time - pair[0].time).collect();
        let motions: Vec<_> = poses.windows(2).map(|pair| Motion::between(pair[0], pair[1])).collect();
        let (lengths, turns): (Vec<f64>, Vec<f64>) =
            motions.iter().map(|motion| (motion.length.abs(), motion.turn.abs())).unzip();
        let count = motions.len().max(1) as f64;
        let mean =
            Motion { length: lengths.iter().sum::<f64>() / count, turn: turns.iter().sum::<f64>() / count };
        let period = quantile(&times, 0.5);
        let usual = [quantile(&lengths, 0.9), quantile(&turns, 0.9)];
        let limits = [0, 1].map(|i| (usual[i] * GAP_MOTIONS).max(MIN_GAP_MOTION[i]));
        let interval = |k: usize| {
            let intervals = if period > 0.0 {
                times[k] / period
            } else if lengths[k] > limits[0] || turns[k] > limits[1] {
                (lengths[k] / usual[0].max(MIN_LENGTH)).max(turns[k] / usual[1].max(MIN_LENGTH))
            } else {
                1.0
            };
            if intervals > GAP_INTERVALS { intervals } else { 1.0 }
        };
        let intervals =
            std::iter::once(1.0).chain((0..times.len()).map(interval)).take(poses.len()).collect();
        Self { poses, intervals, period, mean }
    }

    /// Returns the pose after `count` records, interpolated on the arc between two of them; `None` without records.
    pub(crate) fn pose_after(&self, count: f64) -> Option<Pose<Map, Body, f64>> {
        let whole = libm::floor(count);
        let last = self.poses.len().checked_sub(1)?;
        let record = |count: f64| self.poses.get(((count - 1.0).max(0.0) as usize).min(last)).copied();
        let (before, after) = (record(whole)?, record(whole + 1.0)?);
        let motion = Motion::between(before, after);
        let part = Motion { length: motion.length * (count - whole), turn: motion.turn * (count - whole) };
        Some(before.integrate(part, Integration::Arc))
    }

    /// Returns the count `lag` records before `count`, but not beyond a gap: nothing is interpolated across one.
    pub(crate) fn before(&self, count: usize, lag: f64) -> f64 {
        let earliest = (count as f64 - lag).max(0.0);
        let passed = libm::ceil(earliest) as usize..count;
        // The interval that ends at record k, counted from 1, is entry k − 1.
        let gap = (passed.start.max(1)..=passed.end).rev().find(|record| self.is_gap(*record));
        // Within a gap, the scan belongs to its end.
        gap.map_or(earliest, |record| (record as f64).max(earliest))
    }

    /// Whether the interval that ends after `count` records is a gap.
    pub(crate) fn is_gap(&self, count: usize) -> bool {
        self.intervals_until(count) > 1.0
    }

    /// Motion of usual size in the time of a gap that ends after `count` records: what odometry may have missed; zero outside
    /// gaps.
    pub(crate) fn unseen_motion(&self, count: usize) -> Motion<f64> {
        let missed = (self.intervals_until(count) - 1.0) * UNSEEN_SHARE;
        Motion { length: self.mean.length * missed, turn: self.mean.turn * missed }
    }

    fn intervals_until(&self, count: usize) -> f64 {
        count.checked_sub(1).and_then(|index| self.intervals.get(index)).copied().unwrap_or(1.0)
    }
}

/// Returns the quantile of `values`; 0 if there are none.
fn quantile(values: &[f64], share: f64) -> f64 {
    let mut values = values.to_vec();
    let middle = (values.len() as f64 * share) as usize;
    if values.is_empty() {
        return 0.0;
    }
    let index = middle.min(values.len() - 1);
    *values.select_nth_unstable_by(index, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(time: f64, x: f64) -> StampedPose {
        StampedPose { time, x, y: 0.0, heading: 0.0 }
    }

    #[test]
    fn interpolated_poses_are_on_the_arc() {
        let records = RecordedOdometry::new(&[at(0.0, 0.0), at(0.0, 1.0), at(0.0, 3.0)]);
        let x = |count: f64| records.pose_after(count).map(|pose| pose.x);
        assert_eq!([0.5, 1.0, 1.5, 2.25, 3.0, 9.0].map(x), [0.0, 0.0, 0.5, 1.5, 3.0, 3.0].map(Some));
        assert!(RecordedOdometry::new(&[]).pose_after(1.0).is_none());
    }

    #[test]
    fn nothing_is_interpolated_across_a_gap() {
        let times = [0.0, 0.2, 0.4, 5.0, 5.2, 5.4, 5.6];
        let records: Vec<_> = times.iter().map(|time| at(*time, *time)).collect();
        let odometry = RecordedOdometry::new(&records);
        assert!(odometry.is_gap(4) && !odometry.is_gap(3) && !odometry.is_gap(5));
        // The scan after the first record behind the gap, and one more record later.
        for (count, expected) in [(4, 4.0), (5, 4.0), (6, 4.4), (3, 1.4)] {
            let before = odometry.before(count, 1.6);
            assert!((before - expected).abs() < 1e-12, "{count}: {before}");
        }
        assert!(odometry.unseen_motion(4).length > 0.2 && odometry.unseen_motion(3).length.abs() < 1e-12);
    }

    #[test]
    fn whole_motion_keeps_any_increment() {
        let before: Pose<Map, Body, f64> = Pose::new(1.0, 2.0, Angle::from_radians(0.4));
        for (x, y, turn) in
            [(1.0, 0.5, 2.0), (-1.0, -0.3, -3.0), (0.0, 0.7, 0.1), (0.0, 0.0, 1.0), (-2.0, 0.0, 0.0)]
        {
            let after = before * Pose::<Body, Body, f64>::new(x, y, Angle::from_radians(turn));
            let end = Motion::turn_drive_turn(before, after)
                .iter()
                .fold(before, |pose, motion| pose.integrate(*motion, Integration::Arc));
            assert!(end.origin().distance(after.origin()) < 1e-12, "{x} {y} {turn}");
            assert!((end.heading - after.heading).radians().abs() < 1e-12, "{x} {y} {turn}");
        }
    }
}
