//! `surepose sweep`: keys, exit codes, given starts, the same trials whatever the threads.

#![allow(clippy::expect_used, reason = "a test stops where its footing is gone")]

mod common;

use common::{file, folder, surepose};

#[test]
fn the_json_has_the_contracts_keys() {
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
fn threads_change_nothing_but_the_time() {
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

/// Only the full loop has a filter to judge.
#[test]
fn the_full_loop_says_how_good_the_filter_is() {
    let keys = ["nees_mean", "position_rmse_m", "heading_rmse_deg", "refused_part"];
    let full = surepose(&["sweep", "--loop", "ekf", "--runs", "50", "--json"]);
    assert_eq!(full.code, 0, "{}", full.stderr);
    assert!(keys.iter().all(|key| full.json()[*key].as_f64() > Some(0.0)), "{}", full.stdout);
    let bench = surepose(&["sweep", "--noise", "bench", "--runs", "50", "--json"]);
    assert!(keys.iter().all(|key| bench.json()[*key].is_null()), "{}", bench.stdout);
    // A filter that takes the wheels for ten times as exact as they are contradicts itself.
    let proud =
        surepose(&["sweep", "--loop", "ekf", "--runs", "50", "--json", "--set", "filter.delta=0.000025"]);
    assert!(proud.json()["nees_mean"].as_f64() > Some(6.0), "{}", proud.stdout);
}

#[test]
fn given_starts_are_driven_and_damaged_ones_exit_with_3() {
    let folder = folder("sweep-starts");
    let good = file(&folder, "starts.csv", b"x_m,y_m,heading_deg\n-1,0.3,20\n2,2,180\n");
    let run = surepose(&["sweep", "--starts", &good, "--period", "0.1", "--json"]);
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
fn a_wrong_command_line_exits_with_2() {
    for arguments in [
        &["sweep", "--noise", "loud"][..],
        &["sweep", "--law", "murphy"],
        &["sweep", "--period", "0"],
        &["sweep", "--period", "nan"],
        &["sweep", "--threads", "0"],
        &["sweep", "--runs", "-1"],
        &["sweep", "--precision", "f16"],
        &["sweep", "--loop", "open"],
    ] {
        let run = surepose(arguments);
        assert_eq!(run.code, 2, "{arguments:?}: {}", run.stderr);
        assert_eq!(run.stdout, "", "{arguments:?}");
    }
}
