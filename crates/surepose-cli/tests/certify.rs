//! `surepose certify`: keys and exit codes of what is certified and of what is refused.

mod common;

use common::surepose;

#[test]
fn the_default_gains_are_certified() {
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
        "boxes",
        "wall_s",
    ] {
        assert!(json[key].is_number(), "{key} in {json}");
    }
    assert!(json["capture_radius_m"].as_f64().is_some_and(|radius| radius <= 0.05), "{json}");
    assert!(json["reason"].is_null() && json["counterexample"].is_null(), "{json}");
}

#[test]
fn the_paper_s_gains_are_refused_with_a_situation() {
    let gains = ["--set", "law.k_v=10", "--set", "law.k_alpha=100", "--set", "law.h=1", "--period", "0.1"];
    let run = surepose(&[&["certify", "--json"][..], &gains[..]].concat());
    assert_eq!(run.code, 1, "{}", run.stderr);
    let json = run.json();
    assert_eq!(json["certified"], false);
    assert!(json["reason"].is_string() && json["capture_radius_m"].is_null(), "{json}");
    let found = &json["counterexample"];
    let weight = |key: &str| found[key].as_f64().unwrap_or(f64::NAN);
    assert!(weight("w_after") > weight("w_before"), "{json}");
}

#[test]
fn a_wrong_command_line_exits_with_2() {
    for arguments in [
        &["certify", "--noise-position", "-1"][..],
        &["certify", "--noise-heading", "nan"],
        &["certify", "--period", "0"],
        &["certify", "--config", "no/such/file.toml"],
    ] {
        let run = surepose(arguments);
        assert_eq!(run.code, 2, "{arguments:?}: {}", run.stderr);
        assert_eq!(run.stdout, "", "{arguments:?}");
    }
}

#[test]
fn a_loop_without_certificate_is_warned_of_before_it_drives() {
    let said = |arguments: &[&str]| surepose(arguments).stderr;
    let slow = ["--set", "law.k_v=9", "--set", "law.k_alpha=9"];
    for command in [&["run", "--json"][..], &["config", "check"]] {
        assert!(!said(command).contains("not certified"), "the default loop is certified");
        assert!(said(&[command, &slow[..]].concat()).contains("not certified"), "{command:?}");
    }
}
