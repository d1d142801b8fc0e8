//! `surepose sweep`: JSON keys, exit codes, given start poses, and results that do not depend on the thread count.

#![allow(clippy::expect_used, reason = "a failed precondition fails the test")]

mod common;

use common::{file, folder, surepose};

#[test]
fn json_has_the_documented_keys() {
    let run = surepose(&["sweep", "--runs", "50", "--noise", "bench", "--threads", "1", "--json"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let json = run.json();
    for key in ["runs", "success_rate", "steps", "wall_s", "steps_per_s", "cusps_mean", "seed"] {
        assert!(json[key].is_number(), "{key} in {json}");
    }
    for key in ["time_s", "time_ratio", "path_ratio", "final_position_error_m", "final_heading_error_deg"] {
        for quantile in ["p50", "p95", "max"] {
            assert!(json[key][quantile].is_number(), "{key} in {json}");
        }
    }
    assert_eq!((&json["runs"], &json["success_rate"]), (&50.into(), &1.0.into()), "{json}");
}

#[test]
fn sweep_without_success_exits_with_1() {
    let run = surepose(&["sweep", "--runs", "10", "--set", "law.k_v=0.001", "--json"]);
    assert_eq!((run.code, &run.json()["success_rate"]), (1, &0.0.into()), "{}", run.stderr);
}

#[test]
fn json_describes_the_trials_and_a_warning_lists_ignored_parameters() {
    let set = ["--set", "robot.track_m=0.5", "--set", "goal.hold_s=2", "--set", "law.direction=forward"];
    let run = surepose(&[&["sweep", "--runs", "10", "--period", "0.1", "--json"], &set[..]].concat());
    assert!(run.stderr.contains("Ignored parameters: robot.track_m, goal.hold_s"), "{}", run.stderr);
    let json = run.json();
    for (key, expected) in [("loop", "bench"), ("noise", "none"), ("law", "surepose"), ("precision", "f64")] {
        assert_eq!(json[key], expected, "{json}");
    }
    assert_eq!(json["period_s"], 0.1);
    let run = surepose(&["sweep", "--runs", "10", "--loop", "ekf", "--set", "filter.delta=0.003", "--json"]);
    assert!(!run.stderr.contains("Ignored"), "{}", run.stderr);
    assert_eq!(run.json()["noise"], "bench");
}

/// The written configuration repeats the sweep without a warning.
#[test]
fn written_configuration_gives_no_warning() {
    let out = folder("sweep-again-by-its-own");
    let config = out.join("config.toml");
    let sweep = |more: &[&str]| {
        let run = surepose(&[&["sweep", "--runs", "10", "--period", "0.1", "--json"], more].concat());
        assert_eq!(run.code, 0, "{}", run.stderr);
        (run.stderr, run.stdout.split_once("wall_s").map(|(before, _)| before.to_owned()))
    };
    let config = config.to_str().expect("UTF-8");
    let first = sweep(&["--out", out.to_str().expect("UTF-8")]);
    assert_eq!(sweep(&["--config", config]), first);
    let (stderr, _) = sweep(&["--config", config, "--set", "goal.hold_s=2"]);
    assert!(stderr.contains("Ignored parameters: goal.hold_s\n"), "{stderr}");
}

#[test]
fn thread_count_does_not_change_the_trials() {
    let trials = |name: &str, threads: &str| {
        let out = folder(name);
        let path = out.to_str().expect("UTF-8");
        let run =
            surepose(&["sweep", "--runs", "200", "--threads", threads, "--noise", "bench", "--out", path]);
        assert_eq!(run.code, 0, "{}", run.stderr);
        std::fs::read_to_string(out.join("trials.csv")).expect("written")
    };
    let alone = trials("sweep-1", "1");
    assert_eq!(alone.lines().count(), 201);
    assert_eq!(alone, trials("sweep-2", "2"));
}

/// Runs a sweep and returns every file of `--out`, by name.
fn written(name: &str, arguments: &[&str]) -> Vec<(String, Vec<u8>)> {
    let out = folder(name);
    let path = out.to_str().expect("UTF-8");
    let run = surepose(&[&["sweep", "--out", path], arguments].concat());
    assert_eq!(run.code, 0, "{}", run.stderr);
    let entries = std::fs::read_dir(out).expect("written").map(|entry| entry.expect("readable"));
    let mut files: Vec<_> = entries
        .map(|entry| {
            (entry.file_name().into_string().expect("UTF-8"), std::fs::read(entry.path()).expect("readable"))
        })
        .collect();
    files.sort();
    files
}

#[test]
fn same_seed_writes_the_same_bytes_in_every_file() {
    let arguments = ["--runs", "500", "--noise", "bench", "--threads"];
    let once = written("sweep-once", &[&arguments[..], &["1"]].concat());
    let names: Vec<&str> = once.iter().map(|(name, _)| name.as_str()).collect();
    let pictures = ["spreads.png", "spreads.svg", "start_map.png", "start_map.svg"];
    assert_eq!(
        names,
        [&["config.toml"], &pictures[..], &["summary.json", "trials.csv", "trials.parquet"]].concat()
    );
    let again = written("sweep-again", &[&arguments[..], &["2"]].concat());
    for ((name, bytes), (_, other)) in once.iter().zip(&again) {
        assert!(bytes == other, "{name} differs");
    }
    let other = written("sweep-other", &[&arguments[..], &["1", "--seed", "2"]].concat());
    for ((name, bytes), (_, other)) in once.iter().zip(&other) {
        assert!(bytes != other || name == "config.toml", "{name} does not depend on the seed");
    }
    let summary: serde_json::Value =
        serde_json::from_slice(&once.iter().find(|(name, _)| name == "summary.json").expect("written").1)
            .expect("JSON");
    assert_eq!(summary["runs"], 500);
    assert!(summary["wall_s"].is_null() && summary["steps_per_s"].is_null(), "{summary}");
}

/// The reader of the `parquet` crate finds the numbers of the CSV file.
#[test]
fn parquet_file_equals_the_csv() {
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::Field;

    // With these values the law of the paper fails in half of the trials, so that some times are absent.
    let far = "law.capture_radius_m=0.033";
    let quick = "law.k_theta=10";
    let arguments = [
        "--runs", "60", "--law", "paper", "--noise", "bench", "--period", "0.1", "--set", far, "--set", quick,
    ];
    let files = written("sweep-parquet", &arguments);
    let bytes = |expected: &str| files.iter().find(|(name, _)| name == expected).expect("written").1.clone();
    let mut csv = csv::Reader::from_reader(std::io::Cursor::new(bytes("trials.csv")));
    let header = csv.headers().expect("a header").clone();
    let lines: Vec<csv::StringRecord> = csv.records().map(|line| line.expect("a line")).collect();
    let reader = SerializedFileReader::new(bytes::Bytes::from(bytes("trials.parquet"))).expect("Parquet");
    let rows: Vec<_> = reader.get_row_iter(None).expect("rows").map(|row| row.expect("a row")).collect();
    assert_eq!((rows.len(), lines.len()), (60, 60));
    let mut absent = 0;
    for (row, line) in rows.iter().zip(&lines) {
        for (((name, field), column), text) in row.get_column_iter().zip(&header).zip(line) {
            assert_eq!(name, column);
            let same = match field {
                Field::Null => text.is_empty(),
                Field::Bool(truth) => text == truth.to_string(),
                Field::Long(count) => text == count.to_string(),
                Field::Double(number) => text.parse::<f64>().is_ok_and(|it| it.to_bits() == number.to_bits()),
                _ => false,
            };
            assert!(same, "{name}: {field} is not {text}");
            absent += usize::from(name == "time_s" && *field == Field::Null);
        }
    }
    assert!((10..50).contains(&absent), "{absent} of 60 trials failed");
}

#[test]
fn plots_stay_small_and_handle_few_or_failed_trials() {
    let sizes = |files: &[(String, Vec<u8>)], end: &str| -> Vec<usize> {
        files.iter().filter(|(name, _)| name.ends_with(end)).map(|(_, bytes)| bytes.len()).collect()
    };
    let many = written("sweep-many", &["--runs", "20000"]);
    assert!(sizes(&many, ".svg").iter().all(|size| *size < 300_000), "{:?}", sizes(&many, ".svg"));
    for (name, arguments) in [
        ("sweep-one", &["--runs", "1"][..]),
        (
            "sweep-paper",
            &[
                "--runs",
                "30",
                "--law",
                "paper",
                "--noise",
                "bench",
                "--set",
                "law.k_theta=10",
                "--set",
                "law.capture_radius_m=0.01",
            ],
        ),
    ] {
        let files = written(name, arguments);
        for (file, bytes) in &files {
            let text = String::from_utf8_lossy(bytes);
            assert!(
                !file.ends_with("svg") || !text.contains("NaN") && !text.contains("inf"),
                "{name}: {file}"
            );
        }
        assert_eq!(sizes(&files, ".png").len(), 2, "{name}");
    }
}

/// The values that the paper does not print are those with which its law arrives.
#[test]
fn law_of_the_paper_arrives_with_its_default_values() {
    for noise in ["none", "bench"] {
        let run = surepose(&["sweep", "--law", "paper", "--runs", "2000", "--noise", noise, "--json"]);
        assert!(run.json()["success_rate"].as_f64() == Some(1.0), "{noise}: {}", run.stdout);
    }
}

/// Only the full loop has filter statistics.
#[test]
fn full_loop_reports_filter_consistency() {
    let keys = ["nees_mean", "position_rmse_m", "heading_rmse_deg", "refused_part"];
    let full = surepose(&["sweep", "--loop", "ekf", "--runs", "50", "--json"]);
    assert_eq!(full.code, 0, "{}", full.stderr);
    assert!(keys.iter().all(|key| full.json()[*key].is_number()), "{}", full.stdout);
    assert!(
        full.json()["nees_mean"].as_f64().is_some_and(|nees| (2.7..3.3).contains(&nees)),
        "{}",
        full.stdout
    );
    let bench = surepose(&["sweep", "--noise", "bench", "--runs", "50", "--json"]);
    assert!(keys.iter().all(|key| bench.json()[*key].is_null()), "{}", bench.stdout);
    // A filter that underestimates the wheel noise by a factor of ten is inconsistent.
    let proud =
        surepose(&["sweep", "--loop", "ekf", "--runs", "50", "--json", "--set", "filter.delta=0.000025"]);
    assert!(proud.json()["nees_mean"].as_f64() > Some(6.0), "{}", proud.stdout);
}

#[test]
fn malformed_start_poses_exit_with_3() {
    let folder = folder("sweep-starts");
    let good = file(&folder, "starts.csv", b"x_m,y_m,heading_deg\n-1,0.3,20\n2,2,180\n");
    let run = surepose(&["sweep", "--starts", &good, "--period", "0.1", "--json"]);
    assert_eq!(run.json()["runs"], 2, "{}", run.stderr);
    // With a byte-order mark, as Excel writes it.
    let marked =
        file(&folder, "bom.csv", "\u{feff}x_m,y_m,heading_deg\r\n-1,0.3,20\r\n2,2,180\r\n".as_bytes());
    let run = surepose(&["sweep", "--starts", &marked, "--period", "0.1", "--json"]);
    assert_eq!(run.json()["runs"], 2, "{}", run.stderr);

    for (name, bytes) in
        [("short.csv", &b"1,2,3\n1,2\n"[..]), ("nan.csv", b"1,2,3\n1,nan,2\n"), ("empty.csv", b"")]
    {
        let path = file(&folder, name, bytes);
        let run = surepose(&["sweep", "--starts", &path, "--json"]);
        assert_eq!(run.code, 3, "{name}: {}", run.stderr);
        let place = if bytes.is_empty() { path.clone() } else { format!("{path}:2") };
        assert!(run.stderr.contains(&place), "{place} in {}", run.stderr);
    }
    assert_eq!(surepose(&["sweep", "--starts", "no/such/file.csv"]).code, 3);
}

#[test]
fn invalid_command_line_exits_with_2() {
    for arguments in [
        &["sweep", "--noise", "loud"][..],
        &["sweep", "--law", "murphy"],
        &["sweep", "--period", "0"],
        &["sweep", "--period", "nan"],
        &["sweep", "--threads", "0"],
        &["sweep", "--threads", "65535"],
        &["sweep", "--runs", "-1"],
        &["sweep", "--runs", "0"],
        &["sweep", "--precision", "f16"],
        &["sweep", "--loop", "open"],
    ] {
        let run = surepose(arguments);
        assert_eq!(run.code, 2, "{arguments:?}: {}", run.stderr);
        assert_eq!(run.stdout, "", "{arguments:?}");
    }
}

#[test]
fn sweep_without_success_is_reported() {
    let run = surepose(&["sweep", "--runs", "20", "--set", "law.k_v=0.001"]);
    assert!(run.stderr.contains("success") && run.stderr.contains("0.000 %"), "{}", run.stderr);
    assert!(!run.stderr.contains("reversals"), "{}", run.stderr);
}

/// A base with a dead band: unknown, the goals are aborted; known, the robot parks.
#[test]
fn trials_on_a_base_with_its_own_properties() {
    let runs = ["sweep", "--runs", "20", "--period", "0.1", "--json"];
    let unknown = surepose(&[&runs[..], &["--world", "robot.min_speed_m_s=0.03"]].concat());
    let json = unknown.json();
    assert_eq!(
        (unknown.code, &json["success_rate"], &json["aborted"]["stalled"]),
        (1, &0.0.into(), &20.into()),
        "{json}"
    );
    assert_eq!(json["world"]["robot.min_speed_m_s"], 0.03, "{json}");
    let known = surepose(&[&runs[..], &["--set", "robot.min_speed_m_s=0.03"]].concat());
    assert_eq!((known.code, &known.json()["success_rate"]), (0, &1.0.into()), "{}", known.stderr);
    assert!(!known.stderr.contains("Ignored"), "{}", known.stderr);
    let usual = surepose(&runs).json();
    assert!(usual["aborted"].is_null() && usual["world"].is_null(), "{usual}");
}

#[test]
fn base_of_the_trials_has_no_sensors() {
    for (options, named) in [
        (&["--world", "laser.x_m=0.1"][..], "`laser.x_m`: not a property"),
        (&["--world", "robot.track=0.5"], "the key is `track_m`"),
        (&["--world", "robot.track_m=0.5", "--loop", "ekf"], "--loop ekf: not available"),
        (&["--world", "robot.track_m=0.5", "--precision", "f32"], "--precision f32"),
    ] {
        let run = surepose(&[&["sweep", "--runs", "5", "--json"], options].concat());
        assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{options:?}: {}", run.stderr);
        assert!(run.stderr.contains(named), "{options:?}: {}", run.stderr);
    }
    let help = surepose(&["sweep", "--world", "help"]);
    assert!(
        help.code == 0 && help.stdout.contains("robot.command_delay_s") && !help.stdout.contains("laser.")
    );
}
