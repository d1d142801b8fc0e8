//! Mounting of laser and compass, from the configuration or from `/tf_static`.

mod static_transforms;
#[cfg(test)]
mod tests;

use std::fmt;

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use static_transforms::{StaticTransforms, plain};
use surepose::geometry::{Angle, Body, Laser, Pose};
use surepose::param::MountingSource;
use surepose_config::Config;

use crate::convert::MessageError;
use crate::message::TfMessage;

/// Largest tilt of the scan plane \[rad].
const MAX_TILT: f64 = 10.0 * core::f64::consts::PI / 180.0;

/// Smallest difference \[m], \[rad] of two laser poses that causes a warning.
const DISAGREEMENT_THRESHOLD: (f64, f64) = (0.05, 3.0 * core::f64::consts::PI / 180.0);

/// Smallest change \[m], \[rad] of a mounting that invalidates estimates with the previous one.
const CHANGE_THRESHOLD: (f64, f64) = (0.002, 0.1 * core::f64::consts::PI / 180.0);

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

    fn differs_from(&self, other: Pose<Body, Laser, f64>, (distance, turn): (f64, f64)) -> bool {
        let between = self.body_from_laser.inverse() * other;
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

/// Resolves the mounting of laser and compass from configuration and `/tf_static`.
///
/// A configured pose has priority, since it may be calibrated; upside-down mounting is only known from `/tf_static`. Without
/// either source the mounting is unknown, and no measurement of the sensor may be used.
#[derive(Clone, Debug)]
pub(crate) struct ExtrinsicsResolver {
    /// Configured pose of the laser; `None` for that of `/tf_static`.
    configured: Option<Pose<Body, Laser, f64>>,
    /// Whether the compass offset of the configuration includes the mounting.
    is_compass_configured: bool,
    /// Whether an unknown mounting counts as that of the body frame: a recording holds all transforms that there are.
    assumes_identity: bool,
    static_transforms: StaticTransforms,
    /// Base frame from odometry; `None` before the first message.
    base: Option<String>,
    /// Frame of the first scan; scans of other frames are rejected.
    laser: Option<String>,
    /// Frame of the last heading; `None` before the first message.
    compass: Option<String>,
    /// Mountings with which measurements were used; `None` before the first.
    used_laser: Option<LaserExtrinsics>,
    used_compass: Option<UnitQuaternion<f64>>,
    has_changed: bool,
    /// Last source message.
    said: Option<String>,
}

impl ExtrinsicsResolver {
    /// Creates the resolver from `config`.
    pub(crate) fn new(config: &Config) -> Self {
        let laser = config.laser().body_from_laser;
        let has_laser_pose = match config.laser_mounting() {
            MountingSource::Auto => laser != Pose::identity(),
            MountingSource::Config => true,
            MountingSource::TfStatic => false,
        };
        let is_compass_configured = match config.compass_mounting() {
            MountingSource::Auto => config.compass().offset != Angle::zero(),
            MountingSource::Config => true,
            MountingSource::TfStatic => false,
        };
        Self {
            configured: has_laser_pose.then_some(laser),
            is_compass_configured,
            assumes_identity: false,
            static_transforms: StaticTransforms::default(),
            base: None,
            laser: None,
            compass: None,
            used_laser: None,
            used_compass: None,
            has_changed: false,
            said: None,
        }
    }

    /// Treats an unknown mounting as identity from now on.
    #[cfg(feature = "bag")]
    pub(crate) fn assume_identity(&mut self) {
        self.assumes_identity = true;
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

    /// Extrinsics of the laser whose scans are in `frame`; `None` while they are unknown. An empty frame is the base frame.
    ///
    /// # Errors
    /// [`MessageError::WrongFrame`] for a second laser; [`MessageError::Leaning`] for a tilted scan plane.
    pub(crate) fn laser(&mut self, frame: &str) -> Result<Option<LaserExtrinsics>, MessageError> {
        let frame = plain(frame);
        let laser = self.laser.get_or_insert_with(|| frame.to_owned());
        if frame != laser {
            return Err(MessageError::WrongFrame {
                expected: laser.clone(),
                got: frame.escape_debug().to_string(),
            });
        }
        // A mounting stays known although its transform no longer leads to the base.
        let Some(found) = self.laser_extrinsics().transpose()? else { return Ok(self.used_laser) };
        if let Some(used) = self.used_laser.replace(found) {
            self.has_changed |= used.is_upside_down != found.is_upside_down
                || used.differs_from(found.body_from_laser, CHANGE_THRESHOLD);
        }
        Ok(Some(found))
    }

    /// Rotation of the compass whose headings are in `frame`, relative to the body; `None` while it is unknown. An empty frame is
    /// the base frame.
    pub(crate) fn compass(&mut self, frame: &str) -> Option<UnitQuaternion<f64>> {
        let frame = plain(frame);
        if self.compass.as_deref() != Some(frame) {
            self.compass = Some(frame.to_owned());
        }
        let found = self.compass_rotation()?;
        if let Some(used) = self.used_compass.replace(found) {
            self.has_changed |= used.angle_to(&found) > CHANGE_THRESHOLD.1;
        }
        Some(found)
    }

    /// Whether a mounting with which measurements were used has changed since the last call.
    pub(crate) fn take_change(&mut self) -> bool {
        std::mem::take(&mut self.has_changed)
    }

    /// Mountings that are still unknown, as a line; `None` if every sensor that has reported is usable.
    pub(crate) fn waiting(&self) -> Option<String> {
        let base = self.base.as_deref()?.escape_debug();
        let laser =
            self.laser.as_ref().filter(|_| self.used_laser.is_none() && self.laser_extrinsics().is_none());
        let compass = self.compass.as_ref().filter(|_| self.compass_rotation().is_none());
        let frames: Vec<_> = [laser, compass].into_iter().flatten().collect();
        let named: Vec<_> =
            frames.iter().map(|frame| format!("{} -> {base}", frame.escape_debug())).collect();
        (!named.is_empty()).then(|| format!("waiting for /tf_static {}", named.join(" and ")))
    }

    /// Remedy for mountings that stay unknown.
    pub(crate) fn remedy(&self) -> &'static str {
        match (self.laser_extrinsics(), self.compass_rotation()) {
            (Some(_), None) => {
                "publish /tf_static, or set compass.offset_deg (compass.mounting = \"config\" for an offset of 0)"
            }
            _ => {
                "publish /tf_static, or set laser.x_m, laser.y_m and laser.heading_deg (laser.mounting = \"config\" for a pose of \
                 0, 0, 0°)"
            }
        }
    }

    /// Line with the laser extrinsics and their source; `None` if unchanged.
    pub(crate) fn take_source_message(&mut self) -> Option<String> {
        let source = self.source().filter(|source| self.said.as_ref() != Some(source))?;
        self.said = Some(source.clone());
        Some(source)
    }

    fn source(&self) -> Option<String> {
        let counts = self.laser_extrinsics()?.ok()?;
        let (laser, base) = (self.laser.as_ref()?.escape_debug(), self.base.as_ref()?.escape_debug());
        Some(match (self.configured, self.told()) {
            (None, Some(_)) if self.is_base(self.laser.as_deref()?) => {
                format!("the laser sits on '{base}' {counts}, as its scans are in this frame")
            }
            (None, Some(_)) => format!("the laser '{laser}' sits on '{base}' {counts}, by /tf_static"),
            (None, None) => format!(
                "laser '{laser}' on '{base}': unknown pose, neither in [laser] nor in /tf_static; default {counts} used"
            ),
            (Some(_), Some(Ok(told)))
                if told.differs_from(counts.body_from_laser, DISAGREEMENT_THRESHOLD) =>
            {
                format!(
                    "warning: the laser sits {counts}, by [laser]; /tf_static puts '{laser}' on '{base}' {told}"
                )
            }
            (Some(_), Some(Err(problem))) => {
                format!("warning: the laser sits {counts}, by [laser]; by /tf_static {problem}")
            }
            (Some(_), _) => format!("the laser '{laser}' sits on '{base}' {counts}, by [laser]"),
        })
    }

    /// Extrinsics of the laser in use; `None` while they are unknown.
    fn laser_extrinsics(&self) -> Option<Result<LaserExtrinsics, MessageError>> {
        let told = self.told();
        let Some(body_from_laser) = self.configured else {
            let ahead = LaserExtrinsics { body_from_laser: Pose::identity(), is_upside_down: false };
            return told.or(self.assumes_identity.then_some(Ok(ahead)));
        };
        let is_upside_down = matches!(told, Some(Ok(LaserExtrinsics { is_upside_down: true, .. })));
        Some(Ok(LaserExtrinsics { body_from_laser, is_upside_down }))
    }

    /// Rotation of the compass in use; `None` while it is unknown.
    fn compass_rotation(&self) -> Option<UnitQuaternion<f64>> {
        if self.is_compass_configured {
            return Some(UnitQuaternion::identity());
        }
        let told = self.on_base(self.compass.as_ref()?).map(|body_from_compass| body_from_compass.rotation);
        told.or(self.assumes_identity.then(UnitQuaternion::identity))
    }

    /// Extrinsics of the laser from `/tf_static`; `None` without a transform.
    fn told(&self) -> Option<Result<LaserExtrinsics, MessageError>> {
        Some(LaserExtrinsics::from_transform(&self.on_base(self.laser.as_ref()?)?))
    }

    /// Pose of `frame` on the base; `None` without a transform, and before the base frame is known.
    fn on_base(&self, frame: &str) -> Option<Isometry3<f64>> {
        if self.is_base(frame) {
            return Some(Isometry3::identity());
        }
        let base = self.base.as_deref().or(self.assumes_identity.then_some(BASE))?;
        self.static_transforms.between(base, frame)
    }

    /// Whether `frame` is the base frame; an empty frame is, too.
    fn is_base(&self, frame: &str) -> bool {
        self.base.as_deref().is_some_and(|base| frame.is_empty() || frame == base)
    }
}
