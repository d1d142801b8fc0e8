//! Laser extrinsics from the configuration, or else from `/tf_static`.

use std::collections::BTreeMap;
use std::fmt;

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};
use surepose::geometry::{Angle, Body, Laser, Pose};
use surepose_config::Config;

use crate::convert::{MessageError, pose_of};
use crate::message::{self, TfMessage, TransformStamped};

/// Largest tilt of the scan plane \[rad].
const MAX_TILT: f64 = 10.0 * core::f64::consts::PI / 180.0;

/// Smallest difference \[m], \[rad] of two laser poses that causes a warning.
const DISAGREEMENT_THRESHOLD: (f64, f64) = (0.05, 3.0 * core::f64::consts::PI / 180.0);

/// Default base frame of REP 105.
const BASE: &str = "base_link";

/// Laser extrinsics.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LaserExtrinsics {
    /// Pose of the laser on the body.
    pub(crate) body_from_laser: Pose<Body, Laser, f64>,
    /// Whether its z axis points down, so that it scans clockwise.
    pub(crate) is_upside_down: bool,
}

impl LaserExtrinsics {
    /// Converts a pose in space.
    fn from_transform(body_from_laser: &Isometry3<f64>) -> Result<Self, MessageError> {
        let up = (body_from_laser.rotation * Vector3::z()).z;
        let leaning = up.abs().min(1.0).acos();
        if leaning > MAX_TILT {
            return Err(MessageError::Leaning { degrees: leaning.to_degrees() });
        }
        let (ahead, at) = (body_from_laser.rotation * Vector3::x(), body_from_laser.translation.vector);
        let body_from_laser = Pose::new(at.x, at.y, Angle::from_vector(ahead.x, ahead.y));
        Ok(Self { body_from_laser, is_upside_down: up < 0.0 })
    }

    fn is_far_from(&self, other: Pose<Body, Laser, f64>) -> bool {
        let between = self.body_from_laser.inverse() * other;
        let (distance, turn) = DISAGREEMENT_THRESHOLD;
        between.x.hypot(between.y) > distance || between.heading.radians().abs() > turn
    }
}

impl fmt::Display for LaserExtrinsics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Pose { x, y, heading, .. } = self.body_from_laser;
        let side = if self.is_upside_down { ", upside down" } else { "" };
        write!(f, "at ({x:.3}, {y:.3}) facing {:.1}°{side}", heading.degrees())
    }
}

/// Resolves the laser extrinsics from configuration and `/tf_static`.
///
/// A configured pose has priority, since it may be calibrated; upside-down mounting is only known from `/tf_static`.
#[derive(Clone, Debug)]
pub(crate) struct ExtrinsicsResolver {
    /// Configured pose; `None` for the default pose.
    configured: Option<Pose<Body, Laser, f64>>,
    static_transforms: StaticTransforms,
    /// Base frame from odometry; `None` before the first message.
    base: Option<String>,
    /// Frame of the first scan; scans of other frames are rejected.
    laser: Option<String>,
    /// Last source message.
    said: Option<String>,
}

impl ExtrinsicsResolver {
    /// Creates the resolver from `config`.
    pub(crate) fn new(config: &Config) -> Self {
        let configured = Some(config.laser().body_from_laser).filter(|pose| *pose != Pose::identity());
        Self {
            configured,
            static_transforms: StaticTransforms::default(),
            base: None,
            laser: None,
            said: None,
        }
    }

    /// Adds the transforms of `/tf_static`.
    ///
    /// # Errors
    /// [`MessageError`] for an invalid transform; the others are used.
    pub(crate) fn learn(&mut self, told: &TfMessage) -> Result<(), MessageError> {
        let refused = told
            .transforms
            .iter()
            .filter_map(|static_transform| self.static_transforms.learn(static_transform).err());
        refused.last().map_or(Ok(()), Err)
    }

    /// Sets the base frame, from odometry.
    pub(crate) fn set_base_frame(&mut self, body: &str) {
        let body = Some(plain(body)).filter(|body| !body.is_empty()).unwrap_or(BASE);
        if self.base.as_deref() != Some(body) {
            self.base = Some(body.to_owned());
        }
    }

    /// Extrinsics of the laser whose scans are in `frame`.
    ///
    /// # Errors
    /// [`MessageError::WrongFrame`] for a second laser; [`MessageError::Leaning`] for a tilted scan plane.
    pub(crate) fn lookup(&mut self, frame: &str) -> Result<LaserExtrinsics, MessageError> {
        let frame = plain(frame);
        let laser = self.laser.get_or_insert_with(|| frame.to_owned());
        if frame != laser {
            return Err(MessageError::WrongFrame {
                expected: laser.clone(),
                got: frame.escape_debug().to_string(),
            });
        }
        let told = self.told();
        let Some(body_from_laser) = self.configured else {
            let ahead = LaserExtrinsics { body_from_laser: Pose::identity(), is_upside_down: false };
            return told.unwrap_or(Ok(ahead));
        };
        let is_upside_down = matches!(told, Some(Ok(LaserExtrinsics { is_upside_down: true, .. })));
        Ok(LaserExtrinsics { body_from_laser, is_upside_down })
    }

    /// Line with the extrinsics and their source; `None` if unchanged.
    pub(crate) fn take_source_message(&mut self) -> Option<String> {
        let source = self.source().filter(|source| self.said.as_ref() != Some(source))?;
        self.said = Some(source.clone());
        Some(source)
    }

    fn source(&mut self) -> Option<String> {
        let frame = self.laser.clone()?;
        let counts = self.lookup(&frame).ok()?;
        let (laser, base) = (frame.escape_debug(), self.base.as_ref()?.escape_debug());
        Some(match (self.configured, self.told()) {
            (None, Some(_)) => format!("the laser '{laser}' sits on '{base}' {counts}, by /tf_static"),
            (None, None) => format!(
                "laser '{laser}' on '{base}': unknown pose, neither in [laser] nor in /tf_static; default {counts} used"
            ),
            (Some(_), Some(Ok(told))) if told.is_far_from(counts.body_from_laser) => format!(
                "warning: the laser sits {counts}, by [laser]; /tf_static puts '{laser}' on '{base}' {told}"
            ),
            (Some(_), Some(Err(problem))) => {
                format!("warning: the laser sits {counts}, by [laser]; by /tf_static {problem}")
            }
            (Some(_), _) => format!("the laser '{laser}' sits on '{base}' {counts}, by [laser]"),
        })
    }

    /// Extrinsics from `/tf_static`; `None` without a transform.
    fn told(&self) -> Option<Result<LaserExtrinsics, MessageError>> {
        Some(LaserExtrinsics::from_transform(
            &self.static_transforms.between(self.base.as_deref().unwrap_or(BASE), self.laser.as_ref()?)?,
        ))
    }
}

/// Static transforms: each frame with its parent and its pose there.
#[derive(Clone, Debug, Default)]
struct StaticTransforms(BTreeMap<String, (String, Isometry3<f64>)>);

impl StaticTransforms {
    /// Adds a transform; a later one replaces that of the same frame.
    fn learn(&mut self, static_transform: &TransformStamped) -> Result<(), MessageError> {
        let parent_from_child = isometry(&static_transform.transform)?;
        let (parent, child) =
            (plain(&static_transform.header.frame_id), plain(&static_transform.child_frame_id));
        self.0.insert(child.to_owned(), (parent.to_owned(), parent_from_child));
        Ok(())
    }

    /// Pose of `frame` on `base`; `None` if they are not connected.
    fn between(&self, base: &str, frame: &str) -> Option<Isometry3<f64>> {
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
fn plain(frame: &str) -> &str {
    frame.trim_start_matches('/')
}

#[cfg(test)]
mod tests {
    use surepose::time::Stamp;
    use surepose_config::Config;

    use crate::convert::header;
    use crate::message::{Transform, Vector3};

    use super::*;

    /// Transform at x, y, z, rotated about x and then about z \[°].
    fn static_transform(
        parent: &str,
        child: &str,
        [x, y, z]: [f64; 3],
        (roll, yaw): (f64, f64),
    ) -> TransformStamped {
        let turn = UnitQuaternion::from_euler_angles(roll.to_radians(), 0.0, yaw.to_radians());
        let rotation = message::Quaternion { x: turn.i, y: turn.j, z: turn.k, w: turn.w };
        let transform = Transform { translation: Vector3 { x, y, z }, rotation };
        TransformStamped {
            header: header(Stamp::default(), parent),
            child_frame_id: child.to_owned(),
            transform,
        }
    }

    fn extrinsics(config: &Config, static_transforms: Vec<TransformStamped>) -> ExtrinsicsResolver {
        let mut extrinsics = ExtrinsicsResolver::new(config);
        extrinsics.set_base_frame("");
        extrinsics.learn(&TfMessage { transforms: static_transforms }).unwrap();
        extrinsics
    }

    fn configured() -> Config {
        Config::default().with_option("laser.x_m=0.1").unwrap()
    }

    fn assert_is(laser_extrinsics: LaserExtrinsics, (x, y, degrees): (f64, f64, f64)) {
        let pose = laser_extrinsics.body_from_laser;
        assert!((pose.x - x).hypot(pose.y - y) < 1e-12, "{laser_extrinsics}");
        assert!((pose.heading - Angle::from_degrees(degrees)).radians().abs() < 1e-12, "{laser_extrinsics}");
    }

    #[test]
    fn transform_chains_are_resolved_from_any_root() {
        // The laser is 20 cm ahead of a mast that is rotated by 90°: to the body's left.
        let static_transforms = || {
            vec![
                static_transform("base_link", "mast", [0.3, 0.0, 0.5], (0.0, 90.0)),
                static_transform("/mast", "laser", [0.2, 0.0, 0.1], (0.0, -30.0)),
                static_transform("base_footprint", "base_link", [1.0, 2.0, 0.1], (0.0, 45.0)),
            ]
        };
        assert_is(
            extrinsics(&Config::default(), static_transforms()).lookup("laser").unwrap(),
            (0.3, 0.2, 60.0),
        );
        let mut footprint = extrinsics(&Config::default(), static_transforms());
        footprint.set_base_frame("base_footprint");
        let (sin, cos) = 45_f64.to_radians().sin_cos();
        let there = (1.0 + 0.3 * cos - 0.2 * sin, 2.0 + 0.3 * sin + 0.2 * cos, 105.0);
        assert_is(footprint.lookup("laser").unwrap(), there);
    }

    #[test]
    fn upside_down_laser_is_accepted_and_tilted_one_rejected() {
        let at = |roll| {
            extrinsics(
                &Config::default(),
                vec![static_transform("base_link", "laser", [0.2, 0.0, 0.0], (roll, 30.0))],
            )
        };
        let hanging = at(180.0).lookup("laser").unwrap();
        assert!(hanging.is_upside_down);
        assert_is(hanging, (0.2, 0.0, 30.0));
        assert!(!at(3.0).lookup("laser").unwrap().is_upside_down);
        assert!(
            matches!(at(20.0).lookup("laser"), Err(MessageError::Leaning { degrees }) if (degrees - 20.0).abs() < 1e-9)
        );
    }

    #[test]
    fn configuration_overrides_tf_static() {
        let static_transforms = |x| vec![static_transform("base_link", "laser", [x, 0.0, 0.0], (180.0, 0.0))];
        let mut calibrated = extrinsics(&configured(), static_transforms(0.12));
        assert_is(calibrated.lookup("laser").unwrap(), (0.1, 0.0, 0.0));
        assert!(
            calibrated.lookup("laser").unwrap().is_upside_down,
            "upside-down mounting is from /tf_static"
        );
        assert!(!calibrated.source().unwrap().contains("warning"));
        let mut contradicted = extrinsics(&configured(), static_transforms(0.3));
        assert_is(contradicted.lookup("laser").unwrap(), (0.1, 0.0, 0.0));
        assert!(contradicted.source().unwrap().contains("warning: the laser sits at (0.100, 0.000)"));
        // Without either source the default pose is used, with a warning.
        let mut unknown = extrinsics(&Config::default(), vec![]);
        assert_is(unknown.lookup("laser").unwrap(), (0.0, 0.0, 0.0));
        assert!(unknown.source().unwrap().contains("unknown pose"));
    }

    #[test]
    fn scans_of_a_second_laser_are_rejected() {
        let mut extrinsics = extrinsics(&Config::default(), vec![]);
        assert!(extrinsics.lookup("/front").is_ok() && extrinsics.lookup("front").is_ok());
        assert!(matches!(extrinsics.lookup("rear"), Err(MessageError::WrongFrame { .. })));
    }

    #[test]
    fn invalid_transforms_are_rejected_and_cycles_terminate() {
        let mut extrinsics = ExtrinsicsResolver::new(&Config::default());
        let mut broken = static_transform("base_link", "laser", [f64::NAN, 0.0, 0.0], (0.0, 0.0));
        let ring = [
            static_transform("a", "b", [0.0; 3], (0.0, 0.0)),
            static_transform("b", "a", [0.0; 3], (0.0, 0.0)),
        ];
        let told = TfMessage { transforms: [vec![broken.clone()], ring.to_vec()].concat() };
        assert_eq!(extrinsics.learn(&told), Err(MessageError::NotFinite));
        broken.transform.translation.x = 0.0;
        broken.transform.rotation.w = 0.0;
        assert_eq!(
            extrinsics.learn(&TfMessage { transforms: vec![broken] }),
            Err(MessageError::NotARotation)
        );
        assert_is(extrinsics.lookup("b").unwrap(), (0.0, 0.0, 0.0));
    }
}
