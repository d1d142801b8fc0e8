//! Output paths are checked before the computation.

mod common;

use std::time::{Duration, Instant};

use common::{folder, surepose};

/// A directory in which no file can be created, not even by its owner.
#[cfg(target_os = "linux")]
#[test]
fn unwritable_directory_is_rejected_before_input_is_read() {
    let map = folder("writable-map").join("walls.toml");
    let map = map.to_str().expect("UTF-8");
    for arguments in [
        &["calibrate", "ticks", "no/such/recording", "--out", "/proc"][..],
        &["replay", "wean", "no/such/log", "--map", "no/such/map", "--out", "/proc"],
        &["map", "from-log", "carmen", "no/such/log", "--out", map, "--picture", "/proc"],
        &["map", "from-log", "carmen", "no/such/log", "--out", "/proc/walls.toml"],
        &["sweep", "--runs", "40000000", "--out", "/proc"],
        &["certify", "--out", "/proc"],
    ] {
        let run = surepose(arguments);
        assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{arguments:?}: {}", run.stderr);
        assert!(run.stderr.contains("cannot be written"), "{arguments:?}: {}", run.stderr);
    }
}

/// The search itself would take minutes.
#[test]
fn unwritable_file_is_rejected_at_once() {
    let folder = folder("writable-file");
    // A directory blocks the temporary name.
    std::fs::create_dir(folder.join("tuned.toml.part")).expect("made");
    let begun = Instant::now();
    let out = folder.join("tuned.toml");
    let run = surepose(&["tune", "--rounds", "1000", "--out", out.to_str().expect("UTF-8")]);
    assert_eq!(run.code, 2, "{}", run.stderr);
    assert!(run.stderr.contains("give --out the name of a file"), "{}", run.stderr);
    assert!(begun.elapsed() < Duration::from_secs(30), "{:?}", begun.elapsed());
}

/// The check keeps the existing file and leaves no other.
#[test]
fn write_check_leaves_no_files() {
    let folder = folder("writable-traces");
    let out = folder.join("walls.toml");
    std::fs::write(&out, "before").expect("written");
    let out = out.to_str().expect("UTF-8");
    let run = surepose(&["map", "from-log", "carmen", "no/such/log", "--out", out]);
    assert_eq!(run.code, 3, "{}", run.stderr);
    assert_eq!(std::fs::read_to_string(out).expect("kept"), "before");
    let names = || std::fs::read_dir(&folder).expect("readable").count();
    assert_eq!(names(), 1);
    // Existing entries do not interfere with the check.
    std::fs::create_dir(folder.join("surepose")).expect("made");
    let run = surepose(&["calibrate", "ticks", "no/such/log", "--out", folder.to_str().expect("UTF-8")]);
    assert_eq!((run.code, names()), (3, 2), "{}", run.stderr);
}
