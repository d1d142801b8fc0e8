//! The CARMEN replay on variants of the real recordings: gaps, lags, a missing turn, travel without sign.
//!
//! Without the recordings, see `$SUREPOSE_DATA`, the tests print that they are skipped.

#![allow(clippy::expect_used, reason = "tests may panic")]

use surepose::geometry::{Angle, Body, Map, Pose};
use surepose::kinematics::{Integration, Motion};
use surepose_io::recording::{Recording, StampedPose};
use surepose_replay::ReplayReport;
use surepose_replay::carmen::{CarmenSettings, ScanLag, replay_log};
use surepose_sim::CancelToken;
use surepose_testdata::recording;

type Log = Recording<StampedPose>;

fn logs() -> impl Iterator<Item = (&'static str, Log)> {
    ["freiburg-101", "belgioioso"].into_iter().filter_map(|name| {
        let path = recording(&format!("carmen/{name}-corrected.log.gz"))?;
        Some((name, surepose_io::carmen::read(&path).expect("a readable log")))
    })
}

fn replayed(log: &Log, lag: Option<ScanLag>) -> ReplayReport {
    let settings = CarmenSettings { lag, ..CarmenSettings::default() };
    replay_log(log, None, &settings, &CancelToken::default()).expect("a log with scans")
}

/// Required of sound odometry: 0.13 m, 1.2°, and a consistent estimate.
fn assert_sound(what: &str, report: &ReplayReport) {
    println!("{what}: {:?} {:?} {:?}", report.position_rmse_m, report.heading_rmse_deg, report.nees_mean);
    assert!(report.position_rmse_m.is_some_and(|rmse| rmse <= 0.13), "{what}");
    assert!(report.heading_rmse_deg.is_some_and(|rmse| rmse <= 1.2), "{what}");
    assert!(report.nees_mean.is_some_and(|nees| nees <= 10.0), "{what}");
    assert!(report.judged_share.is_some_and(|share| share >= 0.9), "{what}");
}

/// Required of unsound odometry: 90 % of the scans within 0.15 m of the reference.
fn assert_recovered(what: &str, report: &ReplayReport) {
    let near = |estimate: &Pose<Map, Body, f64>, truth: &Pose<Map, Body, f64>| {
        estimate.origin().distance(truth.origin()) <= 0.15
    };
    let judged: Vec<_> = report.track.points.iter().filter_map(|at| Some((at.pose, at.truth?))).collect();
    let good = judged.iter().filter(|(estimate, truth)| near(estimate, truth)).count();
    println!("{what}: {good} of {} scans within 0.15 m, {:?}", judged.len(), report.skipped);
    assert!(good as f64 >= 0.9 * judged.len() as f64, "{what}");
}

/// Composes odometry anew from changed motions; `change` receives the index of a record and its motion.
fn with_motions(log: &Log, mut change: impl FnMut(usize, Motion<f64>) -> Motion<f64>) -> Log {
    let pose =
        |at: &StampedPose| -> Pose<Map, Body, f64> { Pose::new(at.x, at.y, Angle::from_radians(at.heading)) };
    let mut changed = log.clone();
    let mut at = log.odometry.first().map(pose).expect("odometry");
    for (k, pair) in log.odometry.windows(2).enumerate() {
        let motion = change(k + 1, Motion::between(pose(&pair[0]), pose(&pair[1])));
        at = at.integrate(motion, Integration::Arc);
        changed.odometry[k + 1] =
            StampedPose { time: pair[1].time, x: at.x, y: at.y, heading: at.heading.radians() };
    }
    changed
}

/// Leaves out all records of six stretches of this length; a record takes about 0.22 s.
fn with_gaps(log: &Log, seconds: f64) -> Log {
    let count = log.odometry.len();
    let length = (seconds / 0.22) as usize;
    let is_left_out = |record: usize| {
        (0..6).any(|gap| (0..length).contains(&(record.wrapping_sub((2 * gap + 1) * count / 12))))
    };
    let kept: Vec<bool> = (0..count).map(|record| !is_left_out(record)).collect();
    let mut changed = Log { scans: Vec::new(), reference: Vec::new(), ..log.clone() };
    changed.odometry = log.odometry.iter().zip(&kept).filter_map(|(at, kept)| kept.then_some(*at)).collect();
    for (scan, truth) in log.scans.iter().zip(&log.reference) {
        if scan.odometry_before.checked_sub(1).is_none_or(|last| kept[last]) {
            let mut scan = scan.clone();
            scan.odometry_before = kept[..scan.odometry_before].iter().filter(|kept| **kept).count();
            changed.scans.push(scan);
            changed.reference.push(*truth);
        }
    }
    changed
}

/// Delays the lines of the scans by this number of records.
fn with_lag(log: &Log, records: usize) -> Log {
    let mut changed = log.clone();
    for scan in &mut changed.scans {
        scan.odometry_before = (scan.odometry_before + records).min(log.odometry.len());
    }
    changed
}

#[test]
fn gaps_cost_no_more_than_their_scans() {
    for (name, log) in logs() {
        for seconds in [1.0, 3.0, 10.0, 30.0] {
            assert_sound(&format!("{name}, gaps of {seconds} s"), &replayed(&with_gaps(&log, seconds), None));
        }
    }
}

#[test]
fn lag_of_the_scans_is_estimated() {
    for (name, log) in logs() {
        let own = replayed(&log, None).scan_lag_records.expect("a lag");
        for records in [1, 2, 4] {
            let report = replayed(&with_lag(&log, records), None);
            let lag = report.scan_lag_records.expect("a lag");
            assert!((lag - own - records as f64).abs() < 0.5, "{name}: {lag}, {own} without {records}");
            assert_sound(&format!("{name}, scans {records} records late"), &report);
        }
    }
}

#[test]
fn wrong_lag_does_not_diverge() {
    for (name, log) in logs() {
        for records in [0.0, 0.4, 0.8] {
            let report = replayed(&log, Some(ScanLag { records, std: 0.3 }));
            assert_sound(&format!("{name}, lag {records}"), &report);
        }
    }
}

#[test]
fn robot_recovers_from_a_turn_that_odometry_missed() {
    for (name, log) in logs() {
        let from = log.odometry.len() / 3;
        let mut missed = 0.0;
        let changed = with_motions(&log, |record, motion| {
            if record < from || f64::abs(missed) > 1.4 {
                return motion;
            }
            missed += motion.turn;
            Motion { turn: 0.0, ..motion }
        });
        assert_recovered(&format!("{name}, a turn missing"), &replayed(&changed, None));
    }
}

#[test]
fn robot_recovers_from_travel_without_sign() {
    for (name, log) in logs() {
        let changed = with_motions(&log, |_, motion| Motion { length: motion.length.abs(), ..motion });
        assert_recovered(&format!("{name}, travel without sign"), &replayed(&changed, None));
    }
}
