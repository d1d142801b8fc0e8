//! Tree of the static transforms of `/tf_static`.

use std::collections::BTreeMap;

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use surepose::geometry::{Body, Pose};

use crate::convert::{MessageError, pose_of};
use crate::message::{self, TransformStamped};

/// Static transforms: each frame with its parent and its pose there.
#[derive(Clone, Debug, Default)]
pub(super) struct StaticTransforms(BTreeMap<String, (String, Isometry3<f64>)>);

impl StaticTransforms {
    /// Adds a transform; a later one replaces that of the same frame.
    pub(super) fn learn(&mut self, static_transform: &TransformStamped) -> Result<(), MessageError> {
        let parent_from_child = isometry(&static_transform.transform)?;
        let (parent, child) =
            (plain(&static_transform.header.frame_id), plain(&static_transform.child_frame_id));
        self.0.insert(child.to_owned(), (parent.to_owned(), parent_from_child));
        Ok(())
    }

    /// Pose of `frame` on `base`; `None` if they are not connected.
    pub(super) fn between(&self, base: &str, frame: &str) -> Option<Isometry3<f64>> {
        let ((root, root_from_base), (other, other_from_frame)) = (self.rooted(base), self.rooted(frame));
        (root == other).then(|| root_from_base.inverse() * other_from_frame)
    }

    /// Root of `frame`, and its pose there. A cycle is followed once.
    fn rooted<'a>(&'a self, frame: &'a str) -> (&'a str, Isometry3<f64>) {
        let (mut root, mut root_from_frame) = (frame, Isometry3::identity());
        for _ in 0..self.0.len() {
            let Some((parent, parent_from_root)) = self.0.get(root) else { break };
            (root, root_from_frame) = (parent, parent_from_root * root_from_frame);
        }
        (root, root_from_frame)
    }
}

/// Converts a transform, which must give a valid pose in the plane.
fn isometry(transform: &message::Transform) -> Result<Isometry3<f64>, MessageError> {
    let message::Vector3 { x, y, z } = transform.translation;
    let position = message::Point { x, y, z };
    let _in_the_plane: Pose<Body, Body, f64> =
        pose_of(&message::Pose { position, orientation: transform.rotation.clone() })?;
    let message::Quaternion { x: i, y: j, z: k, w } = transform.rotation;
    let rotation = UnitQuaternion::new_normalize(Quaternion::new(w, i, j, k));
    Ok(Isometry3::from_parts(Translation3::new(x, y, z), rotation))
}

/// Frame name of tf2, without a leading slash.
pub(super) fn plain(frame: &str) -> &str {
    frame.trim_start_matches('/')
}
