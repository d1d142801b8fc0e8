//! What is to be known of a recording before it is heard from its beginning.

use surepose::geometry::{Body, Map, Pose};
use surepose::time::Stamp;
use surepose_config::Config;
use surepose_io::recording::StampedPose;
use surepose_replay::Reference;

use crate::convert::{MessageError, pose_of, stamp_of};
use crate::extrinsics::ExtrinsicsResolver;

use super::BagError;
use super::reader::{Bag, BagMessage};

/// How well a reference tells the start: standard deviations of x, y \[m] and heading \[rad].
pub(super) const REFERENCE_STD: [f64; 3] = [0.01, 0.01, 0.01];

/// The truth, and how the laser sits: a node hears the latter as soon as it listens, whenever it was said.
pub(super) struct BagIndex {
    /// The reference poses in the order of time.
    pub(super) poses: Vec<StampedPose>,
    /// When the first odometry was, if there is a truth.
    first: Option<Stamp>,
    pub(super) extrinsics: ExtrinsicsResolver,
}

impl BagIndex {
    /// That of `bag`, whose laser sits as `config` says, or `/tf_static`; `skip` hears of what is no pose.
    ///
    /// # Errors
    /// [`BagError`].
    pub(super) fn from_bag(
        bag: &Bag,
        config: &Config,
        mut skip: impl FnMut(MessageError),
    ) -> Result<Self, BagError> {
        let mut bag_index =
            Self { poses: Vec::new(), first: None, extrinsics: ExtrinsicsResolver::new(config) };
        if bag.needs_index() {
            bag.messages(|said| {
                if let Err(why) = bag_index.hear(said) {
                    skip(why);
                }
            })?;
        }
        bag_index.poses.sort_by(|a, b| a.time.total_cmp(&b.time));
        Ok(bag_index)
    }

    /// Where the robot truly was at the first odometry.
    pub(super) fn start(&self) -> Option<Pose<Map, Body, f64>> {
        Reference::new(&self.poses).at(self.first?.seconds())
    }

    fn hear(&mut self, said: BagMessage) -> Result<(), MessageError> {
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
            BagMessage::Scan(_) | BagMessage::Imu(_) => {}
        }
        Ok(())
    }
}
