//! A place that cannot be written to is found before the work, and not after it.

mod common;

use std::time::{Duration, Instant};

use common::{folder, surepose};

/// A folder in which nobody can make a file, not even its owner.
#[cfg(target_os = "linux")]
#[test]
fn a_folder_that_cannot_be_written_to_is_refused_before_anything_is_read() {
    let map = folder("writable-map").join("walls.toml");
    let map = map.to_str().expect("UTF-8");
    for arguments in [
        &["calibrate", "ticks", "no/such/recording", "--out", "/proc"][..],
        &["replay", "wean", "no/such/log", "--map", "no/such/map", "--out", "/proc"],
        &["map", "from-log", "carmen", "no/such/log", "--out", map, "--picture", "/proc"],
        &["map", "from-log", "carmen", "no/such/log", "--out", "/proc/walls.toml"],
        &["sweep", "--runs", "4000000000", "--out", "/proc"],
        &["certify", "--out", "/proc"],
    ] {
        let run = surepose(arguments);
        assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{arguments:?}: {}", run.stderr);
        assert!(run.stderr.contains("cannot be written"), "{arguments:?}: {}", run.stderr);
    }
}

/// Its gains are looked for in minutes.
#[test]
fn a_file_that_cannot_be_begun_is_refused_at_once() {
    let folder = folder("writable-file");
    // Its beginning cannot be written where a folder has that name.
    std::fs::create_dir(folder.join("tuned.toml.part")).expect("made");
    let begun = Instant::now();
    let out = folder.join("tuned.toml");
    let run = surepose(&["tune", "--rounds", "1000", "--out", out.to_str().expect("UTF-8")]);
    assert_eq!(run.code, 2, "{}", run.stderr);
    assert!(run.stderr.contains("give --out the name of a file"), "{}", run.stderr);
    assert!(begun.elapsed() < Duration::from_secs(30), "{:?}", begun.elapsed());
}

/// What was there before stays, and nothing else is left.
#[test]
fn trying_leaves_nothing() {
    let folder = folder("writable-traces");
    let out = folder.join("walls.toml");
    std::fs::write(&out, "before").expect("written");
    let out = out.to_str().expect("UTF-8");
    let run = surepose(&["map", "from-log", "carmen", "no/such/log", "--out", out]);
    assert_eq!(run.code, 3, "{}", run.stderr);
    assert_eq!(std::fs::read_to_string(out).expect("kept"), "before");
    let names = || std::fs::read_dir(&folder).expect("readable").count();
    assert_eq!(names(), 1);
    // What stands in a folder is not in the way of what it is tried with.
    std::fs::create_dir(folder.join("surepose")).expect("made");
    let run = surepose(&["calibrate", "ticks", "no/such/log", "--out", folder.to_str().expect("UTF-8")]);
    assert_eq!((run.code, names()), (3, 2), "{}", run.stderr);
}
