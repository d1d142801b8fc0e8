//! What is to be known of a recording before it is heard from its beginning.

use surepose::{Body, Map, Pose, Stamp};
use surepose_data::Config;
use surepose_data::recording::StampedPose;
use surepose_lab::replay::Reference;

use super::BagError;
use super::reader::{Bag, Said};
use crate::convert::{Refused, pose_of, stamp_of};
use crate::mounting::LaserMount;

/// How well a reference tells the start: standard deviations of x, y \[m] and heading \[rad].
pub(super) const REFERENCE_STD: [f64; 3] = [0.01, 0.01, 0.01];

/// The truth, and how the laser sits: a node hears the latter as soon as it listens, whenever it was said.
pub(super) struct Prologue {
    /// The reference poses in the order of time.
    pub(super) poses: Vec<StampedPose>,
    /// When the first odometry was, if there is a truth.
    first: Option<Stamp>,
    pub(super) mount: LaserMount,
}

impl Prologue {
    /// That of `bag`, whose laser sits as `config` says, or `/tf_static`; `skip` hears of what is no pose.
    ///
    /// # Errors
    /// [`BagError`].
    pub(super) fn of(bag: &Bag, config: &Config, mut skip: impl FnMut(Refused)) -> Result<Self, BagError> {
        let mut prologue = Self { poses: Vec::new(), first: None, mount: LaserMount::new(config) };
        if bag.has_prologue() {
            bag.messages(|said| {
                if let Err(why) = prologue.hear(said) {
                    skip(why);
                }
            })?;
        }
        prologue.poses.sort_by(|a, b| a.time.total_cmp(&b.time));
        Ok(prologue)
    }

    /// Where the robot truly was at the first odometry.
    pub(super) fn start(&self) -> Option<Pose<Map, Body, f64>> {
        Reference::new(&self.poses).at(self.first?.seconds())
    }

    fn hear(&mut self, said: Said) -> Result<(), Refused> {
        match said {
            Said::Truth(told) => {
                let Pose { x, y, heading, .. } = pose_of::<Map, Body>(&told.pose)?;
                let time = stamp_of(told.header.stamp).seconds();
                self.poses.push(StampedPose { time, x, y, heading: heading.radians() });
            }
            Said::Joints(told) => self.mount.learn(&told)?,
            Said::Odometry(odometry) => {
                self.mount.sits_on(&odometry.child_frame_id);
                self.first = self.first.or(Some(stamp_of(odometry.header.stamp)));
            }
            Said::Scan(_) | Said::Imu(_) => {}
        }
        Ok(())
    }
}
