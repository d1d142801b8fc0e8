//! Resolution of mountings from configuration and `/tf_static`.

use surepose::time::Stamp;
use surepose_config::Config;

use crate::convert::header;
use crate::message::{self, Transform, TransformStamped, Vector3};

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
    TransformStamped { header: header(Stamp::default(), parent), child_frame_id: child.to_owned(), transform }
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
        extrinsics(&Config::default(), static_transforms()).laser("laser").unwrap().unwrap(),
        (0.3, 0.2, 60.0),
    );
    let mut footprint = extrinsics(&Config::default(), static_transforms());
    footprint.set_base_frame("base_footprint");
    let (sin, cos) = 45_f64.to_radians().sin_cos();
    let there = (1.0 + 0.3 * cos - 0.2 * sin, 2.0 + 0.3 * sin + 0.2 * cos, 105.0);
    assert_is(footprint.laser("laser").unwrap().unwrap(), there);
}

#[test]
fn upside_down_laser_is_accepted_and_tilted_one_rejected() {
    let at = |roll| {
        extrinsics(
            &Config::default(),
            vec![static_transform("base_link", "laser", [0.2, 0.0, 0.0], (roll, 30.0))],
        )
    };
    let hanging = at(180.0).laser("laser").unwrap().unwrap();
    assert!(hanging.is_upside_down);
    assert_is(hanging, (0.2, 0.0, 30.0));
    assert!(!at(3.0).laser("laser").unwrap().unwrap().is_upside_down);
    assert!(
        matches!(at(20.0).laser("laser"), Err(MessageError::Leaning { degrees }) if (degrees - 20.0).abs() < 1e-9)
    );
}

#[test]
fn configuration_overrides_tf_static() {
    let static_transforms = |x| vec![static_transform("base_link", "laser", [x, 0.0, 0.0], (180.0, 0.0))];
    let mut calibrated = extrinsics(&configured(), static_transforms(0.12));
    assert_is(calibrated.laser("laser").unwrap().unwrap(), (0.1, 0.0, 0.0));
    assert!(
        calibrated.laser("laser").unwrap().unwrap().is_upside_down,
        "upside-down mounting is from /tf_static"
    );
    assert!(!calibrated.source().unwrap().contains("warning"));
    let mut contradicted = extrinsics(&configured(), static_transforms(0.3));
    assert_is(contradicted.laser("laser").unwrap().unwrap(), (0.1, 0.0, 0.0));
    assert!(contradicted.source().unwrap().contains("warning: the laser sits at (0.100, 0.000)"));
}

/// No scan is used before its mounting is known; the line names the transform, and the remedy the keys.
#[test]
fn unknown_laser_pose_is_waited_for() {
    let mut late = extrinsics(&Config::default(), vec![]);
    assert_eq!(late.waiting(), None, "before the first scan");
    assert_eq!(late.laser("base_scan"), Ok(None));
    assert_eq!(late.waiting().as_deref(), Some("waiting for /tf_static base_scan -> base_link"));
    assert!(late.remedy().contains("laser.x_m, laser.y_m and laser.heading_deg"));
    assert_eq!(late.take_source_message(), None);
    let other = static_transform("base_link", "camera", [0.1, 0.0, 0.0], (0.0, 0.0));
    late.learn(&TfMessage { transforms: vec![other] }).unwrap();
    assert_eq!(late.laser("base_scan"), Ok(None), "a transform of another frame");
    let told = |x| TfMessage {
        transforms: vec![static_transform("base_link", "base_scan", [x, 0.0, 0.0], (0.0, 0.0))],
    };
    late.learn(&told(0.2)).unwrap();
    assert_is(late.laser("base_scan").unwrap().unwrap(), (0.2, 0.0, 0.0));
    assert_eq!((late.waiting(), late.take_change()), (None, false));
    // The same transform again is no change, another one is.
    for (x, changes) in [(0.2, false), (0.25, true), (0.25, false)] {
        late.learn(&told(x)).unwrap();
        assert_is(late.laser("base_scan").unwrap().unwrap(), (x, 0.0, 0.0));
        assert_eq!(late.take_change(), changes, "{x}");
    }
}

/// A laser in the base frame, a configured pose and a recording need no transform.
#[test]
fn known_laser_poses_need_no_transform() {
    let option = |text: &str| Config::default().with_option(text).unwrap();
    for frame in ["base_link", "/base_link", ""] {
        let mut at_base = extrinsics(&Config::default(), vec![]);
        assert_is(at_base.laser(frame).unwrap().unwrap(), (0.0, 0.0, 0.0));
        assert!(at_base.take_source_message().unwrap().contains("as its scans are in this frame"));
    }
    let mut configured = extrinsics(&option("laser.mounting=config"), vec![]);
    assert_is(configured.laser("laser").unwrap().unwrap(), (0.0, 0.0, 0.0));
    let mut ignored = extrinsics(&configured_pose_with_tf_static(), vec![]);
    assert_eq!(ignored.laser("laser"), Ok(None), "a configured pose that is not to be used");
    let mut before_odometry = ExtrinsicsResolver::new(&Config::default());
    assert_eq!(before_odometry.laser("base_link"), Ok(None), "the base frame is unknown");
    #[cfg(feature = "bag")]
    {
        let mut recorded = extrinsics(&Config::default(), vec![]);
        recorded.assume_identity();
        assert_is(recorded.laser("laser").unwrap().unwrap(), (0.0, 0.0, 0.0));
        assert!(recorded.take_source_message().unwrap().contains("unknown pose"));
    }
}

fn configured_pose_with_tf_static() -> Config {
    configured().with_option("laser.mounting=tf_static").unwrap()
}

#[test]
fn compass_in_another_frame_is_waited_for() {
    let mut late = extrinsics(&Config::default(), vec![]);
    assert_eq!(late.compass("base_link"), Some(UnitQuaternion::identity()));
    assert_eq!(late.compass("imu_link"), None);
    assert_eq!(late.waiting().as_deref(), Some("waiting for /tf_static imu_link -> base_link"));
    let told = TfMessage {
        transforms: vec![static_transform("base_link", "imu_link", [0.0, 0.0, 0.1], (0.0, 90.0))],
    };
    late.learn(&told).unwrap();
    let rotation = late.compass("imu_link").unwrap();
    assert!((rotation.euler_angles().2.to_degrees() - 90.0).abs() < 1e-9 && late.waiting().is_none());
    // A calibrated offset includes the mounting.
    let mut calibrated = extrinsics(&Config::default().with_option("compass.offset_deg=3").unwrap(), vec![]);
    calibrated.learn(&told).unwrap();
    assert_eq!(calibrated.compass("imu_link"), Some(UnitQuaternion::identity()));
}

#[test]
fn scans_of_a_second_laser_are_rejected() {
    let mut extrinsics = extrinsics(&configured(), vec![]);
    assert!(extrinsics.laser("/front").is_ok() && extrinsics.laser("front").is_ok());
    assert!(matches!(extrinsics.laser("rear"), Err(MessageError::WrongFrame { .. })));
}

#[test]
fn invalid_transforms_are_rejected_and_cycles_terminate() {
    let mut extrinsics = ExtrinsicsResolver::new(&Config::default());
    let mut broken = static_transform("base_link", "laser", [f64::NAN, 0.0, 0.0], (0.0, 0.0));
    let ring =
        [static_transform("a", "b", [0.0; 3], (0.0, 0.0)), static_transform("b", "a", [0.0; 3], (0.0, 0.0))];
    let told = TfMessage { transforms: [vec![broken.clone()], ring.to_vec()].concat() };
    assert_eq!(extrinsics.learn(&told), Err(MessageError::NotFinite));
    broken.transform.translation.x = 0.0;
    broken.transform.rotation.w = 0.0;
    assert_eq!(extrinsics.learn(&TfMessage { transforms: vec![broken] }), Err(MessageError::NotARotation));
    extrinsics.set_base_frame("");
    assert_eq!(extrinsics.laser("b"), Ok(None));
}
