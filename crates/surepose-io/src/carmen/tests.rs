use std::f64::consts::{FRAC_PI_2, PI};
use std::path::Path;

use proptest::prelude::*;

use crate::error::DataError;
use crate::lines::LineReader;
use crate::recording::{Recording, StampedPose};

use super::parse;

/// A robot that drives 1 m ahead, is corrected to (5, 5) facing north, and drives 1 m ahead again.
const LOG: &str = "\
# message formats defined: PARAM SYNC ODOM FLASER RLASER
PARAM robot_frontlaser_offset -0.04 nohost 0
ODOM 1 2 0 0 0 0 10.5 pippo 10.5
ODOM 2 2 0 0 0 0 11 pippo 11
FLASER 3 1.5 81.91 2 5 5 1.5707963267948966 5 5 1.5707963267948966 11 pippo 11
ODOM 5 5 1.5707963267948966 0 0 0 -2.88423 pippo 0
NEFF 30
ODOM 5 6 1.5707963267948966 0 0 0 12 pippo 12
";

fn read(text: &[u8]) -> Result<Recording<StampedPose>, DataError> {
    parse(LineReader::from_bytes(Path::new("log"), text))
}

fn message(text: &str) -> String {
    read(text.as_bytes()).unwrap_err().to_string()
}

#[test]
fn raw_odometry_excludes_the_correction() {
    let recording = read(LOG.as_bytes()).unwrap();
    let raw: Vec<_> = recording.odometry.iter().map(|pose| (pose.time, pose.x, pose.y)).collect();
    let expected = [(10.5, 1.0, 2.0), (11.0, 2.0, 2.0), (12.0, 3.0, 2.0)];
    assert_eq!(raw.len(), expected.len());
    for (raw, expected) in raw.iter().zip(expected) {
        assert!(
            (raw.0 - expected.0).abs() + (raw.1 - expected.1).hypot(raw.2 - expected.2) < 1e-12,
            "{raw:?}"
        );
    }
    assert!(recording.odometry.iter().all(|pose| pose.heading.abs() < 1e-12));
    assert!((recording.duration() - 1.5).abs() < 1e-12);
}

#[test]
fn scan_has_reference_odometry_and_beam_angles() {
    let recording = read(LOG.as_bytes()).unwrap();
    let reference = StampedPose { time: 11.0, x: 5.0, y: 5.0, heading: FRAC_PI_2 };
    assert_eq!(recording.reference, [reference]);
    let scan = &recording.scans[0];
    assert_eq!(scan.ranges, [1.5, f64::INFINITY, 2.0]);
    assert_eq!(scan.odometry_before, 2);
    assert_eq!(scan.odometry.unwrap(), recording.odometry[1]);
    assert!((scan.angle(2) - FRAC_PI_2).abs() < 1e-15);
    assert!((scan.angle_increment - PI / 2.0).abs() < 1e-15);
}

#[test]
fn malformed_logs_name_line_and_problem() {
    assert_eq!(
        message("FLASER 999999999 1 2 0 0 0 0 0 0 1 h 1\n"),
        "log:1: ranges: wrong count (got 2, expected 999999999 as declared)"
    );
    assert!(message("FLASER\n").starts_with("log:1: columns: wrong number"));
    assert!(message("FLASER 1 2 0 0\n").starts_with("log:1: columns: wrong number"));
    assert!(message("FLASER 0 0 0 0 0 0 0 1 h 1\n").starts_with("log:1: no ranges found"));
    assert!(
        message("FLASER -1 1 2 0 0 0 0 0 0 1 h 1\n").contains("column 2 (number of ranges): not an integer")
    );
    assert!(message("FLASER 1 nan 0 0 0 0 0 0 1 h 1\n").contains("column 3 (range): not finite (got 'nan')"));
    assert!(message("FLASER 1 -2 0 0 0 0 0 0 1 h 1\n").contains("column 3 (range): out of range (got '-2',"));
    assert!(message("ODOM 0 1e400 0 0 0 0 1 h 1\n").contains("column 3 (y): not finite (got '1e400')"));
    assert!(message("ODOM 0 0 0 0 0 0 1e15 h 1\n").contains("column 8 (time): out of range (got '1e15',"));
    assert!(message("ODOM 0 0\n").starts_with("log:1: columns: wrong number (got 3, expected 4"));
    assert!(message("hello\n").starts_with("log:1: record: unknown (got 'hello'"));
    assert!(message("PARAM a b\n").starts_with("log: no odometry (ODOM lines) and no scans"));
}

#[test]
fn the_three_kinds_of_scan_lines_are_one_scan() {
    let angles = "0 -1.5707963 3.1415927 1.5707963 80 0.01 0";
    let robot = format!(
        "ROBOTLASER1 {angles} 3 1.5 81.91 2 0 5 5 1.5707963267948966 5 5 1.5707963267948966 0 0 0 0 0 11 pippo 11"
    );
    let raw = format!("RAWLASER1 {angles} 3 1.5 81.91 2 2 9 9 11 pippo 11");
    let flaser = LOG.lines().find(|line| line.starts_with("FLASER")).unwrap();
    let expected = read(LOG.as_bytes()).unwrap();
    let both = format!("{raw}\n{robot}");
    for other in [&robot, &raw, &both] {
        let recording = read(LOG.replace(flaser, other).as_bytes()).unwrap();
        assert_eq!(recording.odometry, expected.odometry, "{other}");
        assert_eq!(recording.reference, expected.reference, "{other}");
        assert_eq!(recording.scans.len(), 1, "{other}");
        let scan = &recording.scans[0];
        assert_eq!((&scan.ranges, scan.odometry_before), (&expected.scans[0].ranges, 2), "{other}");
        assert!((scan.angle(2) - FRAC_PI_2).abs() < 1e-6 && (scan.angle(0) + FRAC_PI_2).abs() < 1e-6);
    }
}

#[test]
fn order_comes_from_the_lines() {
    let log = |times: [f64; 5]| {
        let line = |(i, time): (usize, &f64)| format!("ODOM {i} 0 0 0 0 0 {time} h 0\n");
        let odometry: String = times.iter().enumerate().map(line).collect();
        read((odometry + "FLASER 1 1 0 0 0 0 0 0 1 h 1\n").as_bytes()).unwrap()
    };
    let times = |recording: &Recording<StampedPose>| -> Vec<f64> {
        recording.odometry.iter().map(|at| at.time).collect()
    };
    let below = log([-2.0, -1.0, 0.5, 1.0, 2.0]);
    assert_eq!(times(&below), [-2.0, -1.0, 0.5, 1.0, 2.0]);
    assert_eq!(below.irregular, [("stamp_below_zero", 2)].into());
    // One damaged stamp, and a clock that is set back for good.
    let single = log([10.0, 11.0, 0.0, 13.0, 14.0]);
    assert_eq!(times(&single), [10.0, 11.0, 11.0, 13.0, 14.0]);
    let set_back = log([10.0, 11.0, 3.0, 4.0, 5.0]);
    assert_eq!(times(&set_back), [10.0, 11.0, 11.0, 12.0, 13.0]);
    for log in [&single, &set_back] {
        assert_eq!(log.irregular, [("stamp_stepped_back", 1)].into());
    }
}

#[test]
fn odometry_may_have_any_number_of_columns() {
    for (line, time, absent) in [
        ("ODOM 1 2 0.5", 0.0, 1),
        ("ODOM 1 2 0.5 7 h 7", 7.0, 0),
        ("ODOM 1 2 0.5 0 0 7 h 7", 7.0, 0),
        ("ODOM 1 2 0.5 0 0 0 7 h 7 8 9", 7.0, 0),
        ("ODOM 1 2 0.5 0 0 0 7", 7.0, 0),
    ] {
        let log = read(format!("{line}\nFLASER 1 1 0 0 0 0 0 0 1 h 1\n").as_bytes()).unwrap();
        assert_eq!(log.odometry, [StampedPose { time, x: 1.0, y: 2.0, heading: 0.5 }], "{line}");
        assert_eq!(log.irregular.get("stamp_absent").copied().unwrap_or(0), absent, "{line}");
    }
}

proptest! {
    #[test]
    fn any_bytes_give_a_recording_or_an_error(bytes in prop::collection::vec(any::<u8>(), 0..256)) {
        let _ = read(&bytes);
    }

    #[test]
    fn any_records_give_a_recording_or_an_error(
        text in "((FLASER [0-9]{1,2}|(RAW|ROBOT)LASER1 0 0 0 0 0 0 0 [0-9]|ODOM|NEFF)( (-?[0-9]{1,3}|nan|1e400|h)){0,14}\n){0,6}"
    ) {
        let _ = read(text.as_bytes());
    }
}
