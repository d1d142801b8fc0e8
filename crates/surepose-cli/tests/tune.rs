//! `surepose tune`: JSON keys, exit codes and the written configuration.

#![allow(clippy::expect_used, reason = "a failed precondition fails the test")]

mod common;

use common::{folder, surepose};

const GAINS: [&str; 5] = ["k_v", "k_alpha", "h", "k_theta", "capture_radius_m"];

#[test]
fn result_is_certified_and_no_slower() {
    let folder = folder("tune");
    let out = folder.join("tuned.toml");
    let path = out.to_str().expect("UTF-8");
    let arguments = ["tune", "--period", "0.1", "--rounds", "2", "--runs", "2000", "--out", path, "--json"];
    let run = surepose(&arguments);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let json = run.json();
    for gain in GAINS {
        assert!(json[gain].is_number() && json["start"][gain].is_number(), "{gain} in {json}");
    }
    assert_eq!((&json["certified"], &json["after"]["success_rate"]), (&true.into(), &1.0.into()), "{json}");
    for quantile in ["p50", "p95"] {
        let figure = |when: &str| json[when]["time_ratio"][quantile].as_f64();
        assert!(figure("after") <= figure("before"), "{json}");
    }
    let slowest = |when: &str| json[when]["time_s"]["max"].as_f64();
    assert!(slowest("after") <= slowest("before"), "{json}");
    for when in ["before", "after"] {
        for bound in ["capture_radius_m", "final_position_bound_m", "final_heading_bound_deg"] {
            assert!(json["certificate"][when][bound].is_number(), "{bound} in {json}");
        }
    }
    assert!(run.stderr.contains("other gains may be faster"), "{}", run.stderr);

    // The file is a valid configuration, for which `sweep` gives the same figures.
    assert_eq!(surepose(&["config", "check", path]).code, 0);
    let sweep = ["sweep", "--config", path, "--noise", "bench", "--runs", "2000", "--json"];
    assert_eq!(surepose(&sweep).json()["time_ratio"], json["after"]["time_ratio"]);
    let certify = surepose(&["certify", "--config", path, "--json"]);
    assert_eq!(certify.code, 0, "{}", certify.stdout);
}

/// The bench robot has no acceleration limit, and its law knows the noise of the bench. The written configuration
/// contains neither, because it is for another robot.
#[test]
fn configuration_excludes_parameters_of_the_bench() {
    let folder = folder("tune-out");
    let out = folder.join("tuned.toml");
    let path = out.to_str().expect("UTF-8");
    let given = ["--set", "robot.track_m=0.5", "--law", "surepose"];
    let run = surepose(
        &[&["tune", "--rounds", "0", "--runs", "100", "--out", path, "--json"], &given[..]].concat(),
    );
    assert_eq!(run.code, 0, "{}", run.stderr);
    let text = std::fs::read_to_string(&out).expect("written");
    let mut keys: Vec<&str> = text
        .lines()
        .filter(|line| !line.starts_with('#'))
        .filter_map(|line| line.split_once(" = "))
        .map(|(key, _)| key)
        .collect();
    keys.sort_unstable();
    let mut expected = [&GAINS[..], &["braking", "name", "period_s", "track_m"]].concat();
    expected.sort_unstable();
    assert_eq!(keys, expected, "{text}");

    let shown = surepose(&["config", "show", path, "--json"]).json();
    let default = surepose(&["config", "show", "--json"]).json();
    for key in ["robot.wheel_acceleration_limit_m_s2", "robot.wheel_speed_limit_m_s", "law.position_noise_m"]
    {
        assert_eq!(shown[key], default[key], "{key}");
    }
    assert_eq!(shown["loop.period_s"]["value"], 0.02);
}

#[test]
fn missing_certificate_exits_with_1_and_writes_nothing() {
    let folder = folder("tune-refused");
    let out = folder.join("tuned.toml");
    let path = out.to_str().expect("UTF-8");
    let run = surepose(&[
        "tune",
        "--rounds",
        "0",
        "--runs",
        "100",
        "--noise-position",
        "0.5",
        "--out",
        path,
        "--json",
    ]);
    assert_eq!(run.code, 1, "{}", run.stderr);
    let json = run.json();
    assert_eq!(json["certified"], false, "{json}");
    assert!(json["k_v"].is_null() && json["after"].is_null() && json["before"].is_object(), "{json}");
    assert!(!out.exists() && run.stderr.contains("no gains were certified"), "{}", run.stderr);
}

#[test]
fn invalid_command_line_exits_with_2() {
    for arguments in [
        &["tune", "--runs", "0"][..],
        &["tune", "--noise-position", "-1"],
        &["tune", "--period", "0"],
        &["tune", "--rounds", "many"],
        &["tune", "--rounds", "0", "--runs", "1", "--out", "no/such/folder/tuned.toml"],
    ] {
        let run = surepose(arguments);
        assert_eq!(run.code, 2, "{arguments:?}: {}", run.stderr);
        assert_eq!(run.stdout, "", "{arguments:?}");
    }
}
