//! The MRCLAM replay on a synthetic log with a known result, and on real recordings.
//!
//! The recordings are not part of this repository. The test looks for them in `$SUREPOSE_DATA`, else in
//! `../shared/data` beside the workspace; without them it prints that it is skipped.

use surepose_io::mrclam::{Landmark, LandmarkObservation, RobotLog, Target};
use surepose_io::recording::{StampedPose, StampedTwist};
use surepose_replay::mrclam::{MrclamSettings, replay, replay_log};
use surepose_replay::{ReplayError, ReplayReport};
use surepose_testdata::recording;

/// Log of a robot commanded to stand still at (1, 0), facing a landmark at (4, 0), for 10 s.
fn standing(sightings: Vec<LandmarkObservation>) -> RobotLog {
    let times = || (0..=1000).map(|tick| f64::from(tick) * 0.01);
    RobotLog {
        odometry: times().map(|time| StampedTwist { time, speed: 0.0, turn_rate: 0.0 }).collect(),
        sightings,
        reference: times().map(|time| StampedPose { time, x: 1.0, y: 0.0, heading: 0.0 }).collect(),
        landmarks: vec![Landmark { subject: 6, x: 4.0, y: 0.0, x_std: 0.0, y_std: 0.0 }],
    }
}

/// Returns the camera's record of that landmark.
fn seen(time: f64, target: Target) -> LandmarkObservation {
    LandmarkObservation { time, target, range: 3.0 * MrclamSettings::default().camera.scale, bearing: 0.0 }
}

#[test]
fn every_observation_is_counted() {
    let outlier = LandmarkObservation { range: 30.0, ..seen(5.0, Target::Landmark(6)) };
    let behind = LandmarkObservation { bearing: 3.0, ..seen(6.0, Target::Landmark(6)) };
    let log = standing(vec![
        seen(0.0, Target::Landmark(6)),
        seen(1.0, Target::Landmark(6)),
        seen(2.0, Target::Robot(2)),
        seen(3.0, Target::Unknown { barcode: 99 }),
        outlier,
        behind,
        seen(20.0, Target::Landmark(6)),
    ]);
    let report = replay_log(&log, &MrclamSettings::default()).unwrap();
    // The first comes before the first command takes effect; the last comes after the last command and still
    // counts.
    assert_eq!(report.accepted, 2);
    for (reason, count) in [("stale", 1), ("outlier", 1), ("not_finite", 1), ("future", 0)] {
        assert_eq!(report.rejected[reason], count, "{reason}");
    }
    assert_eq!((report.skipped["other_robot"], report.skipped["unknown_barcode"]), (1, 1));
    assert_eq!(report.steps, 1001);
    assert!(report.position_rmse_m.is_some_and(|rmse| rmse < 1e-12), "{report:?}");
    assert!(report.nees_mean.is_some_and(|nees| nees < 1e-12), "{report:?}");
}

#[test]
fn without_a_reference_there_is_no_start() {
    let mut log = standing(vec![]);
    log.reference.truncate(1);
    log.reference[0].time = 100.0;
    assert!(matches!(replay_log(&log, &MrclamSettings::default()), Err(ReplayError::NoStart)));
    log.odometry.clear();
    assert!(matches!(replay_log(&log, &MrclamSettings::default()), Err(ReplayError::NoStart)));
}

fn median(reports: &[ReplayReport], of: impl Fn(&ReplayReport) -> Option<f64>) -> f64 {
    let mut values: Vec<f64> = reports.iter().filter_map(of).collect();
    assert_eq!(values.len(), reports.len(), "every robot has a reference");
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

#[test]
fn all_five_robots_meet_their_figures_with_one_set_of_settings() {
    let Some(folder) = recording("mrclam7") else { return };
    let settings = MrclamSettings::default();
    let reports: Vec<_> =
        (1..=5).map(|robot| replay(&folder, robot, &settings).expect("a readable data set")).collect();
    for (robot, report) in (1..).zip(&reports) {
        println!("robot {robot}: {report:?}");
        assert!(report.position_rmse_m.is_some_and(|rmse| rmse <= 0.095), "robot {robot}");
        assert!(report.rejected["outlier"] <= 20, "robot {robot}");
        let named = report.accepted + report.rejected.values().chain(report.skipped.values()).sum::<u32>();
        let log = surepose_io::mrclam::read(&folder, robot).expect("a readable data set");
        assert_eq!(named as usize, log.sightings.len(), "robot {robot}");
        // Speed is required of release builds only.
        if cfg!(not(debug_assertions)) {
            assert!(report.duration_s >= 1000.0 * report.wall_s, "robot {robot}");
        }
    }
    // Required: 0.165 m, 4.5° and a NEES of 7. The bounds are the measured values with a small tolerance, so
    // that a worse model fails.
    assert!(median(&reports, |report| report.position_rmse_m) <= 0.076);
    assert!(median(&reports, |report| report.heading_rmse_deg) <= 4.1);
    assert!(median(&reports, |report| report.nees_median) <= 3.4);
    // The recorded commands alone: 2.9 m and 79°.
    assert!(median(&reports, |report| report.dead_reckoning_position_rmse_m) > 2.5);
}

#[test]
fn replays_are_reproducible() {
    let Some(folder) = recording("mrclam7") else { return };
    let run = || {
        let report = replay(&folder, 4, &MrclamSettings::default()).expect("a readable data set");
        ReplayReport { wall_s: 0.0, ..report }
    };
    assert_eq!(run(), run());
}
