//! `surepose calibrate`: exit codes for recordings that do not allow a calibration.

mod common;

use common::{file, folder, rover, surepose};

#[test]
fn malformed_recording_exits_with_3() {
    let file = std::env::temp_dir().join("surepose-calibrate-broken.dat");
    std::fs::write(&file, "0 0 nan 3\n").unwrap();
    let path = file.to_string_lossy().into_owned();
    let broken = surepose(&["calibrate", "ticks", &path]);
    assert_eq!(broken.code, 3, "{}", broken.stderr);
    assert!(broken.stderr.contains("surepose-calibrate-broken.dat:1"), "{}", broken.stderr);
    assert_eq!(surepose(&["calibrate", "ticks", "no-such-recording.dat"]).code, 3);
    assert_eq!(surepose(&["calibrate", "tocks", &path]).code, 2);
    let mcap = surepose(&["calibrate", "mcap", &path]);
    assert!(mcap.code == 3 && mcap.stderr.contains("not an MCAP recording"), "{}", mcap.stderr);
}

/// The error names the cause, not a lack of records, of which there are many.
#[test]
fn constant_stamps_are_named() {
    let log = file(&folder("calibrate-clock"), "still.dat", &rover(20, 0));
    let run = surepose(&["calibrate", "ticks", &log]);
    assert_eq!(run.code, 3, "{}", run.stderr);
    let said = run.stderr.replace("\n  │ ", " ");
    assert!(said.contains("no two records with different stamps"), "{said}");
}

#[test]
fn options_of_other_formats_are_rejected() {
    for option in ["--compass", "--set=robot.track_m=0.5", "--remap=odom:=/base/odom"] {
        let run = surepose(&["calibrate", "ticks", "recording.dat", option]);
        assert!(run.code == 2 && run.stderr.contains("leave out"), "{option}: {}", run.stderr);
    }
    let run = surepose(&["calibrate", "mcap", "bag.mcap", "--remap", "murphy"]);
    assert!(run.code == 2 && run.stderr.contains("--remap odom:=/base/odom"), "{}", run.stderr);
}
