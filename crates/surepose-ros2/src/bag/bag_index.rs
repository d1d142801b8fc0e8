//! Reads truth and laser extrinsics of a recording before its replay.

use surepose::geometry::{Body, Map, Pose};
use surepose::time::Stamp;
use surepose_config::Config;
use surepose_io::recording::StampedPose;
use surepose_replay::Reference;

use crate::convert::{MessageError, pose_of, stamp_of};
use crate::extrinsics::ExtrinsicsResolver;

use super::BagError;
use super::reader::{Bag, BagMessage};

/// Uncertainty of a start from the reference: standard deviations of x, y \[m] and heading \[rad].
pub(super) const REFERENCE_STD: [f64; 3] = [0.01, 0.01, 0.01];

/// Reference poses, and laser extrinsics from `/tf_static`: a node receives these at its start.
pub(super) struct BagIndex {
    /// Reference poses in the order of time.
    pub(super) poses: Vec<StampedPose>,
    /// Time of the first odometry; `None` without a reference.
    first: Option<Stamp>,
    pub(super) extrinsics: ExtrinsicsResolver,
}

impl BagIndex {
    /// Reads the index of `bag`; the laser's pose is from `config` or `/tf_static`. `skip` receives rejected messages.
    ///
    /// # Errors
    /// [`BagError`] for an unreadable recording.
    pub(super) fn from_bag(
        bag: &Bag,
        config: &Config,
        mut skip: impl FnMut(MessageError),
    ) -> Result<Self, BagError> {
        let mut bag_index =
            Self { poses: Vec::new(), first: None, extrinsics: ExtrinsicsResolver::new(config) };
        if bag.needs_index() {
            bag.messages(|said| {
                if let Err(why) = bag_index.add(said) {
                    skip(why);
                }
            })?;
        }
        // A recording holds all transforms: a mounting that is not among them stays unknown.
        bag_index.extrinsics.assume_identity();
        bag_index.poses.sort_by(|a, b| a.time.total_cmp(&b.time));
        Ok(bag_index)
    }

    /// Reference pose at the first odometry; `None` without one.
    pub(super) fn start(&self) -> Option<Pose<Map, Body, f64>> {
        Reference::new(&self.poses).at(self.first?.seconds())
    }

    fn add(&mut self, said: BagMessage) -> Result<(), MessageError> {
        match said {
            BagMessage::Truth(told) => {
                let Pose { x, y, heading, .. } = pose_of::<Map, Body>(&told.pose)?;
                let time = stamp_of(told.header.stamp).seconds();
                self.poses.push(StampedPose { time, x, y, heading: heading.radians() });
            }
            BagMessage::StaticTransforms(told) => self.extrinsics.learn(&told)?,
            BagMessage::Odometry(odometry) => {
                self.extrinsics.set_base_frame(&odometry.child_frame_id);
                self.first = self.first.or(Some(stamp_of(odometry.header.stamp)));
            }
            BagMessage::Scan(_) | BagMessage::Imu(_) | BagMessage::Command(_) => {}
        }
        Ok(())
    }
}
