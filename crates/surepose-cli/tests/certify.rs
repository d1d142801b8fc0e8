//! `surepose certify`: JSON keys and exit codes of certified and refused loops.

#![allow(clippy::expect_used, reason = "a failed precondition fails the test")]

mod common;

use common::{folder, surepose};

#[test]
fn default_gains_are_certified() {
    let run = surepose(&["certify", "--noise-position", "0.007", "--noise-heading", "0.25", "--json"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let json = run.json();
    assert_eq!(json["certified"], true);
    for key in [
        "capture_radius_m",
        "decrease_rate_per_s",
        "time_bound_s",
        "max_period_s",
        "final_heading_bound_deg",
        "final_position_bound_m",
        "heading_length_m",
        "reached_position_bound_m",
        "boxes",
        "wall_s",
    ] {
        assert!(json[key].is_number(), "{key} in {json}");
    }
    assert!(json["capture_radius_m"].as_f64().is_some_and(|radius| radius <= 0.05), "{json}");
    assert!(json["reason"].is_null() && json["counterexample"].is_null(), "{json}");
}

/// The wheels stop within the tolerance: that, and every assumption, is part of the verdict.
#[test]
fn verdict_states_its_assumptions_and_the_error_at_the_goal() {
    let run = surepose(&["certify", "--json", "--delay", "0.02", "--set", "robot.min_speed_m_s=0.01"]);
    let json = run.json();
    let said = json["assumptions"].as_array().expect("a list");
    for word in ["period", "pose", "wheels", "acceleration", "delay", "dead band", "footprint", "memory"] {
        let named = |line: &serde_json::Value| line.as_str().is_some_and(|line| line.starts_with(word));
        assert!(said.iter().any(named), "{word}: {json}");
    }
    let number = |key: &str| json[key].as_f64().expect(key);
    // Tolerance 1 cm and 1°, released at 1.5 times that; noise 7 mm and 0.25°; one tick at 0.3 m/s or 1 rad/s.
    let missed = json["reached_position_bound_m"].as_f64().expect("certified") - 0.015 - 0.007;
    assert!((0.0..0.11).contains(&missed), "{json}");
    assert!(number("reached_heading_bound_deg") > 1.75, "{json}");
    let table = surepose(&["certify"]).stderr;
    assert!(
        table.contains("assumed") && table.contains("acceleration") && table.contains("comes within"),
        "{table}"
    );

    let wide = ["certify", "--gaussian", "--json", "--set", "goal.position_tolerance_m=0.5"];
    let radius = surepose(&wide).json()["drift_radius_m"].as_f64().expect("a drift condition");
    assert!(radius > 0.5, "the wheels stop up to 50 cm from the goal, not only within {radius} m");
}

/// The proof is that of wheels that follow at once: a drive of slower ones that leaves the bounds refuses it.
#[test]
fn slow_wheels_are_refused_with_a_drive() {
    let out = folder("certify-slow");
    let slow = ["--set", "robot.wheel_acceleration_limit_m_s2=0.2", "--out", out.to_str().expect("UTF-8")];
    let run = surepose(&[&["certify", "--json"][..], &slow].concat());
    assert_eq!(run.code, 1, "{}", run.stderr);
    let json = run.json();
    let drive = &json["counterexample_drive"];
    assert!(json["capture_radius_m"].is_null() && json["reason"].is_string(), "{json}");
    assert!(drive["distance_m"].as_f64() > drive["bound_m"].as_f64(), "{json}");
    assert!(out.join("counterexample_drive.csv").is_file());
    // A slow law is no violation: it comes within the radius before the time bound.
    let late = surepose(&["certify", "--json", "--set", "law.k_v=0.02"]).json();
    assert!(late["certified"] == true && late["searched_kept_out_m"].as_f64() > Some(0.04), "{late}");
    // The default robot's wheels are faster; ideal wheels are not searched.
    let default = surepose(&["certify", "--json"]).json();
    assert!(default["certified"] == true && default["searched_final_position_m"].is_number(), "{default}");
    let ideal = surepose(&["certify", "--json", "--set", "robot.wheel_acceleration_limit_m_s2=1000"]).json();
    assert!(ideal["certified"] == true && ideal["searched_final_position_m"].is_null(), "{ideal}");
}

/// A quantity without a bound has a row that reports it, because a missing row is overlooked.
#[test]
fn table_lists_quantities_without_a_bound() {
    let table = |noise: [&str; 2]| {
        surepose(&["certify", "--noise-position", noise[0], "--noise-heading", noise[1]]).stderr
    };
    let bounded = table(["0.007", "0.25"]);
    assert!(bounded.contains("capture radius") && !bounded.contains("not bounded"), "{bounded}");
    assert!(!bounded.contains("_m") && !bounded.contains("true"), "{bounded}");
    let refused = table(["0.5", "5"]);
    for what in ["heading ", "position "] {
        let row = refused.lines().find(|line| line.trim_start().starts_with(what)).unwrap_or("");
        assert!(row.contains("not bounded"), "{what}: {refused}");
    }
}

#[test]
fn gains_of_the_paper_are_refused_with_a_counterexample() {
    let gains = ["--set", "law.k_v=10", "--set", "law.k_alpha=100", "--set", "law.h=1", "--period", "0.1"];
    let run = surepose(&[&["certify", "--json"][..], &gains[..]].concat());
    assert_eq!(run.code, 1, "{}", run.stderr);
    let json = run.json();
    assert_eq!(json["certified"], false);
    assert!(json["reason"].is_string() && json["capture_radius_m"].is_null(), "{json}");
    let found = &json["counterexample"];
    let weight = |key: &str| found[key].as_f64().unwrap_or(f64::NAN);
    assert!(weight("w_after") > weight("w_before"), "{json}");

    let paper = surepose(&[&["certify", "--law", "paper", "--json"][..], &gains[..]].concat());
    assert_eq!((paper.code, &paper.json()["certified"]), (1, &false.into()), "{}", paper.stderr);
    let unknown = surepose(&["certify", "--law", "best"]);
    assert!(unknown.code == 2 && unknown.stderr.contains("--law"), "{}", unknown.stderr);
}

/// The plotted margin is at least the certified decrease rate; a refusal is plotted with its gaps.
#[test]
fn margin_plots_agree_with_the_certificate() {
    let drawn = |name: &str, arguments: &[&str], code: i32| {
        let out = folder(name);
        let path = out.to_str().expect("UTF-8");
        let run = surepose(&[&["certify", "--json", "--out", path], arguments].concat());
        assert_eq!(run.code, code, "{}", run.stderr);
        for file in ["margin", "margin_over_distance"] {
            for end in ["svg", "png"] {
                let size = std::fs::metadata(out.join(format!("{file}.{end}"))).expect("written").len();
                assert!((1000..300_000).contains(&size), "{file}.{end} has {size} bytes");
            }
        }
        let mut csv = csv::Reader::from_path(out.join("margin.csv")).expect("written");
        let cells: Vec<[Option<f64>; 4]> =
            csv.deserialize().map(|cell| cell.expect("four numbers or nothing")).collect();
        let side = if code == 0 { 72 } else { 36 };
        assert_eq!(cells.len(), side * side);
        let summary = std::fs::read_to_string(out.join("summary.json")).expect("written");
        assert!(!summary.contains("wall_s") && summary.contains("certified"), "{summary}");
        (run.json(), cells)
    };
    let (json, cells) = drawn("certify-margin", &["--noise-position", "0.02", "--noise-heading", "1.2"], 0);
    let rate = json["decrease_rate_per_s"].as_f64().expect("certified");
    // The parser of JSON may round the last digit.
    let margins = || cells.iter().map(|cell| (cell[2].expect("shown"), cell[3].expect("shown")));
    assert!(margins().all(|(nearest, least)| nearest >= least && least >= rate - 1e-12), "below {rate}");
    assert!(margins().any(|(nearest, _)| nearest > 3.0 * rate), "it is the same everywhere");

    let loud = ["--noise-position", "0.2", "--noise-heading", "5"];
    let (json, cells) = drawn("certify-refused", &loud, 1);
    assert!(json["counterexample"].is_object(), "{json}");
    assert!(cells.iter().any(|cell| cell[3].is_none()), "W was shown to fall, and still refused");
}

#[test]
fn drift_certificate_covers_gaussian_noise() {
    let asked = |part: &str| {
        let bench = ["--noise-position", "0.005", "--noise-heading", "0.3", "--noise-speed-part", part];
        surepose(&[&["certify", "--gaussian", "--json"][..], &bench].concat())
    };
    let run = asked("0");
    assert_eq!(run.code, 0, "{}", run.stderr);
    let json = run.json();
    let number = |key: &str| json[key].as_f64().expect(key);
    assert!(number("drift_radius_m") < 0.1 && number("drift_rate_per_s") > 0.1, "{json}");
    assert!(number("exceeded_probability") < 1e-3 && number("expected_time_bound_s") > 0.0, "{json}");
    assert!(json["left_out"].as_array().is_some_and(|words| words.len() >= 3), "{json}");
    assert!(json["assumptions"].as_array().is_some_and(|words| words.len() >= 7), "{json}");
    // Wheel noise increases the radius; noise larger than the workspace is refused.
    assert!(asked("0.05").json()["drift_radius_m"].as_f64().is_some_and(|radius| radius > 0.1));
    let loud = surepose(&["certify", "--gaussian", "--noise-position", "2", "--json"]);
    assert_eq!(loud.code, 1, "{}", loud.stderr);
    assert!(loud.json()["reason"].is_string() && loud.json()["drift_radius_m"].is_null());
}

#[test]
fn invalid_command_line_exits_with_2() {
    for arguments in [
        &["certify", "--noise-position", "-1"][..],
        &["certify", "--noise-heading", "nan"],
        &["certify", "--period", "0"],
        &["certify", "--gaussian", "--out", "somewhere"],
        &["certify", "--noise-speed-part", "-0.1"],
        &["certify", "--delay", "-0.02"],
        &["certify", "--delay", "nan"],
        &["certify", "--config", "no/such/file.toml"],
    ] {
        let run = surepose(arguments);
        assert_eq!(run.code, 2, "{arguments:?}: {}", run.stderr);
        assert_eq!(run.stdout, "", "{arguments:?}");
    }
}

#[test]
fn uncertified_loop_gives_a_warning() {
    let said = |arguments: &[&str]| surepose(arguments).stderr;
    let hasty = ["--set", "law.k_v=10", "--set", "law.k_alpha=100"];
    for command in [&["run", "--json"][..], &["config", "check"]] {
        assert!(!said(command).contains("not certified"), "the default loop is certified");
        assert!(said(&[command, &hasty[..]].concat()).contains("not certified"), "{command:?}");
    }
}
