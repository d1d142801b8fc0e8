//! `surepose replay`: JSON keys, exit codes and malformed recordings.

mod common;

use std::path::Path;

use common::{file, folder, surepose};
use surepose_testdata::recordings;

/// Writes an MRCLAM data set of one robot at rest in front of a landmark.
fn data_set(folder: &Path) {
    file(folder, "Barcodes.dat", b"# subject barcode\n1 5\n6 72\n");
    file(folder, "Landmark_Groundtruth.dat", b"# s x y sx sy\n6 4.0 0.0 0.0001 0.0001\n");
    let times = || (0..200).map(|tick| f64::from(tick) * 0.02);
    let lines = |row: &dyn Fn(f64) -> String| times().map(row).collect::<String>();
    file(folder, "Robot1_Odometry.dat", lines(&|t| format!("{t} 0.0 0.0\n")).as_bytes());
    file(folder, "Robot1_Groundtruth.dat", lines(&|t| format!("{t} 1.0 0.0 0.0\n")).as_bytes());
    file(folder, "Robot1_Measurement.dat", b"1.0 72 3.12 0.0\n2.0 72 3.12 0.0\n");
}

#[test]
fn json_has_the_documented_keys() {
    let folder = folder("replay-keys");
    data_set(&folder);
    let run = surepose(&["replay", "mrclam", folder.to_str().expect("UTF-8"), "--robot", "1", "--json"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let json = run.json();
    for key in [
        "steps",
        "duration_s",
        "distance_m",
        "wall_s",
        "position_rmse_m",
        "heading_rmse_deg",
        "position_median_m",
        "nees_mean",
        "nees_median",
        "dead_reckoning_position_rmse_m",
        "dead_reckoning_heading_rmse_deg",
        "accepted",
        "rejected",
    ] {
        assert!(!json[key].is_null(), "{key} in {json}");
    }
    assert_eq!(json["accepted"], 2);
}

#[test]
fn parameters_reach_the_filter() {
    let folder = folder("replay-set");
    data_set(&folder);
    let path = folder.to_str().expect("UTF-8");
    let rmse = |scale: &str| {
        let run = surepose(&["replay", "mrclam", path, "--set", scale, "--json"]);
        run.json()["position_rmse_m"].as_f64().expect("a number")
    };
    // The landmark is at 3 m and measured at 1.04 times that; another scale makes the filter move the estimate.
    assert!(rmse("camera.scale=1.04") < 1e-9);
    assert!(rmse("camera.scale=0.8") > 1e-4);
}

/// For a robot at rest dead reckoning is exact. A biased landmark makes the estimate worse, which is no failure as long as it
/// is consistent; a rejected one leaves nothing to evaluate.
#[test]
fn estimate_without_a_measurement_exits_with_1() {
    let folder = folder("replay-useless");
    data_set(&folder);
    let path = folder.to_str().expect("UTF-8");
    let harmed = surepose(&["replay", "mrclam", path, "--set", "camera.scale=0.8", "--json"]);
    assert_eq!(harmed.code, 0, "{}{}", harmed.stdout, harmed.stderr);
    let json = harmed.json();
    let error = |key: &str| json[key].as_f64().expect("a number");
    assert!(error("position_rmse_m") > error("dead_reckoning_position_rmse_m") + 1e-4, "{json}");
    file(&folder, "Robot1_Measurement.dat", b"1.0 72 1.0 2.0\n");
    let unmoved = surepose(&["replay", "mrclam", path, "--json"]);
    assert_eq!((unmoved.code, &unmoved.json()["accepted"]), (1, &0.into()), "{}", unmoved.stdout);
    assert!(unmoved.stderr.contains("no measurement was accepted"), "{}", unmoved.stderr);
    // The table has labels instead of keys.
    let table = surepose(&["replay", "mrclam", path]).stderr;
    assert!(table.contains("accepted measurements") && !table.contains("_m "), "{table}");
}

/// A single scan is accepted, but without odometry there is no step to evaluate.
#[test]
fn recording_without_a_step_exits_with_1() {
    let folder = folder("replay-still");
    let range = |degrees: i32| {
        let (sin, cos) = f64::from(degrees).to_radians().sin_cos();
        format!("{:.0} ", 200.0 / sin.abs().max(cos.abs()))
    };
    let scan = |time: f64| format!("L 0 0 0 0 0 0 {}{time}\n", (-90..90).map(range).collect::<String>());
    let wall = |from: [i32; 2], to: [i32; 2]| format!("[[wall]]\nfrom_m = {from:?}\nto_m = {to:?}\n");
    let walls =
        [wall([-2, -2], [2, -2]), wall([2, -2], [2, 2]), wall([2, 2], [-2, 2]), wall([-2, 2], [-2, -2])];
    let map = file(&folder, "room.toml", walls.concat().as_bytes());
    let replayed = |name: &str, text: String| {
        let log = file(&folder, name, text.as_bytes());
        surepose(&["replay", "wean", &log, "--map", &map, "--start", "0,0,0", "--json"])
    };
    let (one, two) = (replayed("one.log", scan(0.1)), replayed("two.log", scan(0.1) + &scan(0.2)));
    assert_eq!((one.code, &one.json()["accepted"]), (1, &1.into()), "{}", one.stdout);
    assert!(one.stderr.contains("no step of odometry"), "{}", one.stderr);
    assert_eq!((two.code, &two.json()["steps"]), (0, &1.into()), "{}{}", two.stdout, two.stderr);
}

/// The extension before `.gz` selects the map format; plain content is accepted under a `.gz` name.
#[test]
fn compressed_map_keeps_its_format() {
    let folder = folder("replay-compressed-map");
    let log = file(&folder, "damaged.log", b"damaged\n");
    for (name, map, blamed) in [
        ("room.toml.gz", &b"[[wall]]\nfrom_m = [0, 0]\nto_m = [4, 0]\n"[..], "damaged.log:1"),
        ("room.yaml.gz", b"image: 1\norigin: wide\n", "room.yaml.gz:2"),
        ("room.dat.gz", b"[[wall]]\n", "robot_specifications"),
    ] {
        let map = file(&folder, name, map);
        let run = surepose(&["replay", "wean", &log, "--map", &map]);
        assert!(run.code == 3 && run.stderr.contains(blamed), "{blamed} in {}", run.stderr);
    }
}

#[test]
fn robot_option_is_rejected_for_single_robot_formats() {
    for format in ["carmen", "ticks"] {
        let run = surepose(&["replay", format, "no/such/file", "--robot", "3"]);
        assert_eq!(run.code, 2, "{}", run.stderr);
        assert!(run.stderr.contains("leave out --robot"), "{}", run.stderr);
    }
}

#[test]
fn malformed_recording_exits_with_3_and_names_file_and_line() {
    let damages: [(&str, &[u8], Option<u32>); 8] = [
        ("Robot1_Odometry.dat", b"0.0 0.1 0.0\n0.1 0.1\n", Some(2)),
        ("Robot1_Odometry.dat", b"0.0 0.1 0.0\n0.1 nan 0.0\n", Some(2)),
        ("Robot1_Odometry.dat", b"0.0 1e300 0.0\n", Some(1)),
        ("Robot1_Groundtruth.dat", b"0.0 0.1 zero 0.0\n", Some(1)),
        ("Robot1_Measurement.dat", &[0, 1, 2, 0xff, 0xfe, b'\n'], Some(1)),
        ("Barcodes.dat", b"", None),
        ("Landmark_Groundtruth.dat", b"6 4.0 0.0 0.0001\n", Some(1)),
        ("Robot1_Odometry.dat", &[0x1f, 0x8b, 8, 0, 0, 0, 0, 0], None),
    ];
    for (name, bytes, line) in damages {
        let folder = folder("replay-damage");
        data_set(&folder);
        let path = file(&folder, name, bytes);
        let run = surepose(&["replay", "mrclam", folder.to_str().expect("UTF-8"), "--json"]);
        assert_eq!(run.code, 3, "{name}: {}", run.stderr);
        assert_eq!(run.stdout, "", "{name}");
        let place = line.map_or(path.clone(), |line| format!("{path}:{line}"));
        assert!(run.stderr.contains(&place), "{place} in {}", run.stderr);
    }
}

#[test]
fn missing_recording_exits_with_3() {
    let run = surepose(&["replay", "mrclam", "no/such/folder"]);
    assert_eq!(run.code, 3);
    assert!(run.stderr.contains("no/such/folder"), "{}", run.stderr);
}

/// The recording is valid; the option is not.
#[test]
fn unknown_robot_exits_with_2() {
    let folder = folder("replay-robot");
    data_set(&folder);
    let run = surepose(&["replay", "mrclam", folder.to_str().expect("UTF-8"), "--robot", "9"]);
    assert_eq!(run.code, 2, "{}", run.stderr);
    assert!(run.stderr.contains("got 9") && run.stderr.contains("expected one of 1"), "{}", run.stderr);
}

#[test]
fn real_recording_is_replayed() {
    let Some(data) = recordings() else { return };
    let path = data.join("mrclam7");
    let run = surepose(&["replay", "mrclam", path.to_str().expect("UTF-8"), "--robot", "2", "--json"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let json = run.json();
    assert!(json["position_rmse_m"].as_f64().is_some_and(|rmse| rmse < 0.25), "{json}");
    assert!(json["duration_s"].as_f64().is_some_and(|duration| duration > 800.0), "{json}");
}

#[test]
fn wean_hall_run_is_localized_and_plotted() {
    let Some(data) = recordings() else { return };
    let (log, grid) = (data.join("cmu_wean/robotdata3.log.gz"), data.join("cmu_wean/wean.dat.gz"));
    if !(log.exists() && grid.exists()) {
        eprintln!("skipped: no cmu_wean in {}", data.display());
        return;
    }
    let out = folder("replay-hall");
    let [log, grid, out] = [&log, &grid, &out].map(|path| path.to_str().expect("UTF-8"));
    let run = surepose(&["replay", "wean", log, "--map", grid, "--out", out, "--json"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let json = run.json();
    assert_eq!(json["hypotheses_left"], 1, "{json}");
    for key in ["found_s", "found_x_m", "found_y_m", "found_heading_deg", "explained", "beams_on_walls"] {
        assert!(json[key].is_number(), "{key} in {json}");
    }
    assert!(json["position_rmse_m"].is_null() && json["withdrawn"].is_null(), "{json}");
    for picture in ["replay.svg", "replay.png"] {
        assert!(Path::new(out).join(picture).exists(), "{picture}");
    }
}

#[test]
fn malformed_mcap_exits_with_3() {
    let path = file(&folder("replay-mcap"), "drive.mcap", b"\x89MCAP0\r\n and nothing more");
    let run = surepose(&["replay", "mcap", &path]);
    assert_eq!(run.code, 3, "{}", run.stderr);
    assert!(run.stderr.contains("drive.mcap") && run.stderr.contains("damaged recording"), "{}", run.stderr);
    let run = surepose(&["replay", "mcap", &path, "--remap", "odom"]);
    assert_eq!(run.code, 2, "{}", run.stderr);
    let run = surepose(&["replay", "ticks", &path, "--compass"]);
    assert_eq!(run.code, 2, "{}", run.stderr);
}
