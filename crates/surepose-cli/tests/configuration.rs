//! `surepose config`, and errors in configurations and command lines.

mod common;

use common::{file, folder, surepose, surepose_into};

#[test]
fn default_configuration_is_valid_and_round_trips() {
    let check = surepose(&["config", "check", "--json"]);
    assert_eq!(check.code, 0);
    assert_eq!(check.json()["valid"], true);

    let shown = surepose(&["config", "show"]);
    assert_eq!(shown.code, 0);
    let path = file(&folder("show"), "robot.toml", shown.stdout.as_bytes());
    let again = surepose(&["config", "show", &path]);
    let values = |text: &str| -> Vec<String> {
        text.lines().map(|line| line.split('#').next().unwrap_or("").trim().to_owned()).collect()
    };
    assert_eq!(values(&shown.stdout), values(&again.stdout));
    assert!(again.stdout.contains("robot.toml:2"), "{}", again.stdout);
}

/// A shown configuration has the same effect, and gains that are not set are fitted again after a change.
#[test]
fn shown_configuration_keeps_gains_fitted() {
    let folder = folder("show-fitted");
    let effect = |arguments: &[&str]| -> Vec<(String, serde_json::Value)> {
        let json = surepose(&[&["config", "show", "--json"], arguments].concat()).json();
        json.as_object()
            .expect("an object")
            .iter()
            .map(|(key, it)| (key.clone(), it["value"].clone()))
            .collect()
    };
    for (name, given) in
        [("default", &[][..]), ("paper", &["--set", "law.name=paper"]), ("mixed", &["--set", "law.k_v=3"])]
    {
        let shown = surepose(&[&["config", "show"], given].concat());
        assert!(shown.stdout.contains("\n# k_alpha = "), "{}", shown.stdout);
        let path = file(&folder, name, shown.stdout.as_bytes());
        assert_eq!(effect(&[&path]), effect(given), "{name}");
        let slower = ["--set", "loop.period_s=0.1"];
        assert_eq!(
            effect(&[&[&path[..]], &slower[..]].concat()),
            effect(&[given, &slower[..]].concat()),
            "{name}"
        );
        // Without the comment mark a gain is fixed.
        let kept = shown.stdout.replace("# k_alpha", "k_alpha");
        let path = file(&folder, name, kept.as_bytes());
        assert_eq!(effect(&[&path]), effect(given), "{name}");
    }
}

/// A huge number is not printed with all its digits.
#[test]
fn huge_number_is_printed_with_exponent() {
    let run = surepose(&["run", "--set", "law.k_v=1e300"]);
    assert_eq!(run.code, 2, "{}", run.stderr);
    assert!(run.stderr.contains("law.k_v = 1e300"), "{}", run.stderr);
    assert!(run.stderr.lines().all(|line| line.len() < 200), "{}", run.stderr);
}

#[test]
fn each_value_has_its_origin() {
    let path = file(&folder("origin"), "robot.toml", b"[law]\nk_v = 3\n");
    let json = surepose(&["config", "show", &path, "--set", "law.h=0.25", "--json"]).json();
    assert!(json["law.k_v"]["from"].as_str().is_some_and(|from| from.ends_with("robot.toml:2")), "{json}");
    assert_eq!(json["law.h"]["from"], "command line");
    assert_eq!(json["law.h"]["value"], 0.25);
    assert_eq!(json["law.k_alpha"]["from"], "preset fitted");
    assert_eq!(json["goal.hold_s"]["from"], "default");
    assert_eq!(json["robot.track_m"]["unit"], "m");
}

#[test]
fn explain_prints_unit_range_and_reason() {
    let json = surepose(&["config", "explain", "robot.track_m", "--json"]).json();
    for key in ["name", "unit", "default", "range", "reason", "meaning"] {
        assert!(!json[key].is_null(), "{key} in {json}");
    }
    let ambiguous = surepose(&["config", "explain", "latency_s"]);
    assert_eq!(ambiguous.code, 2);
    assert!(ambiguous.stderr.contains("compass.latency_s, laser.latency_s"), "{}", ambiguous.stderr);
}

#[test]
fn schema_is_a_json_document() {
    let json = surepose(&["config", "schema"]).json();
    assert_eq!(json["$schema"], "https://json-schema.org/draft/2020-12/schema");
    assert_eq!(json["properties"]["robot"]["properties"]["wheel_speed_limit_m_s"]["exclusiveMinimum"], 0.0);
    assert_eq!(json["properties"]["law"]["properties"]["direction"]["enum"][1], "forward");
}

#[test]
fn committed_reference_page_is_current() {
    let page = surepose(&["config", "reference"]).stdout;
    let committed = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/parameters.md"));
    assert!(
        committed.is_ok_and(|committed| committed == page),
        "docs/parameters.md is not current; run `cargo run --release -- config reference > docs/parameters.md`"
    );
}

#[test]
fn problems_point_into_the_file() {
    let text =
        "[robot]\nwheel_radius_mm = 50\ntrack_m = -0.6\n\n[compass]\nstd_deg = -0.1\n\n[law]\nk_alfa = 3\n";
    let folder = folder("problems");
    let path = file(&folder, "robot.toml", text.as_bytes());
    let run = surepose(&["config", "check", &path]);
    assert_eq!(run.code, 2);
    assert_eq!(run.stdout, "");
    let message = run.stderr.replace(&path, "robot.toml");
    insta::assert_snapshot!(message);
}

#[test]
fn json_lists_the_same_problems() {
    let path =
        file(&folder("problems-json"), "robot.toml", b"[robot]\ntrack_m = -0.6\n\n[law]\nk_alfa = 3\n");
    let run = surepose(&["config", "check", &path, "--json"]);
    assert_eq!(run.code, 2);
    let json = run.json();
    let problems = json["problems"].as_array().expect("a list");
    assert_eq!((&json["valid"], problems.len()), (&false.into(), 2), "{json}");
    assert_eq!((&problems[0]["file"], &problems[0]["line"]), (&path.as_str().into(), &2.into()), "{json}");
    assert_eq!(problems[1]["help"], "did you mean `k_alpha`?");
    assert!(problems[0]["message"].as_str().is_some_and(|it| it.contains("negative")), "{json}");
    // An option has no line number.
    let option = surepose(&["config", "check", "--set", "law.k_v=-1", "--json"]).json();
    assert_eq!(option["problems"][0]["file"], "--set");
    assert!(option["problems"][0]["line"].is_null(), "{option}");
}

#[test]
fn malformed_configuration_exits_with_2() {
    let folder = folder("damage");
    let cases: [(&str, &[u8]); 9] = [
        ("truncated", b"[robot]\ntrack_m ="),
        ("binary", &[0x1f, 0x8b, 0x08, 0x00, 0xff, 0xfe, 0x00, 0x80]),
        ("nan", b"[robot]\ntrack_m = nan\n"),
        ("huge number", b"[robot]\ntrack_m = 1e999\n"),
        ("huge whole number", b"[laser]\nbeams = 99999999999999999999999999\n"),
        ("text for a number", b"[robot]\ntrack_m = \"wide\"\n"),
        ("a list", b"robot = [1, 2]\n"),
        ("twice", b"[robot]\ntrack_m = 1\ntrack_m = 2\n"),
        ("nested", b"[robot.track_m]\nx = 1\n"),
    ];
    for (name, bytes) in cases {
        let path = file(&folder, name, bytes);
        for arguments in [vec!["config", "check", &path], vec!["replay", "mrclam", ".", "--config", &path]] {
            let run = surepose(&arguments);
            assert_eq!(run.code, 2, "{name}: {}", run.stderr);
            assert_eq!(run.stdout, "", "{name}");
            let for_programs = surepose(&["config", "check", &path, "--json"]);
            assert_eq!((for_programs.code, &for_programs.json()["valid"]), (2, &false.into()), "{name}");
            assert!(for_programs.json()["problems"][0]["message"].is_string(), "{name}");
            let line = if ["truncated", "nan", "text for a number"].contains(&name) { 2 } else { 0 };
            let place = format!("{path}:{line}");
            assert!(line == 0 || run.stderr.contains(&place), "{name}: {}", run.stderr);
        }
    }
    let absent = surepose(&["config", "check", "no/such/file.toml"]);
    assert_eq!(absent.code, 2);
    assert!(absent.stderr.contains("no/such/file.toml"), "{}", absent.stderr);
}

#[test]
fn invalid_command_line_exits_with_2() {
    for arguments in [
        &["parc"][..],
        &["config", "explain"],
        &["config", "explain", "nothing"],
        &["config", "check", "--set", "law.k_v=-1"],
        &["config", "check", "--set", "law.k_v"],
        &["replay", "mrclam"],
        &["replay", "marclam", "."],
        &["replay", "mrclam", ".", "--robot", "-1"],
    ] {
        let run = surepose(arguments);
        assert_eq!(run.code, 2, "{arguments:?}: {}", run.stderr);
        assert_eq!(run.stdout, "", "{arguments:?}");
    }
    assert_eq!(surepose(&["--help"]).code, 0);
    assert_eq!(surepose(&["--version"]).code, 0);
}

#[test]
fn version_names_the_binary() {
    assert!(surepose(&["--version"]).stdout.starts_with("surepose 0."));
}

/// A script must not mistake truncated output for a result; a closed pipe is not an error.
#[cfg(target_os = "linux")]
#[test]
fn unwritable_standard_output_exits_with_2() {
    for arguments in [
        &["config", "show"][..],
        &["config", "show", "--json"],
        &["config", "explain", "k_v"],
        &["config", "check", "--json"],
        &["sweep", "--runs", "1", "--json"],
        &["run", "--json"],
        &["--help"],
        &["--version"],
    ] {
        let (code, stderr) = surepose_into("/dev/full", arguments);
        assert!(code == 2 && stderr.contains("standard output"), "{arguments:?}: {code}: {stderr}");
        assert_eq!(surepose_into("/dev/null", arguments).0, 0, "{arguments:?}");
    }
}

/// Errors name the option as typed and the bound that the value violates.
#[test]
fn errors_name_the_option_and_its_bounds() {
    for (arguments, said) in [
        (&["sweep", "--period", "-1"][..], "--period: `period_s`: negative value"),
        (&["tune", "--period", "0"], "--period: `period_s`"),
        (&["certify", "--period", "nan"], "--period: `period_s`"),
        (&["sweep", "--law", "murphy"], "--law: `name`"),
        (&["sweep", "--law", "paper", "--set", "law.name=surepose"], "conflicting control laws"),
        (&["sweep", "--period", "soon"], "--period: `period_s`: expected a number, got text"),
        (&["run", "--seed", "x"], "expected an integer from 0"),
        (&["certify", "--period", "99"], "--period: `period_s`: out of range"),
        (&["sweep", "--set", "law.k_v=-1"], "--set: `k_v`: negative value"),
        (&["sweep", "--seed", "-1"], "invalid value '-1' for '--seed <SEED>'"),
        (&["run", "--seed", "-1"], "invalid value '-1' for '--seed <SEED>'"),
        (&["sweep", "--runs", "-1"], "expected an integer from 1 to"),
        (&["sweep", "--runs", "0"], "expected an integer from 1 to"),
        (&["tune", "--runs", "-1"], "expected an integer from 1 to"),
        (&["tune", "--rounds", "-1"], "expected an integer from 0 to 1000"),
        (&["sweep", "--threads", "-1"], "expected an integer from 1 to"),
        (&["reproduce", "--out", "x", "--runs", "-1"], "invalid value '-1'"),
        (&["certify", "--noise-heading=-1"], "less than 180°"),
        (&["certify", "--noise-heading", "north"], "less than 180°"),
        (&["certify", "--noise-position", "5mm"], "expected a number from 0 to 1000"),
    ] {
        let run = surepose(arguments);
        assert_eq!(run.code, 2, "{arguments:?}: {}", run.stderr);
        assert!(run.stderr.contains(said), "{arguments:?}: {}", run.stderr);
    }
}

#[test]
fn each_problem_is_printed_once() {
    let run = surepose(&["run", "--set", "law.k_v=-1"]);
    assert_eq!(
        run.stderr.matches("--set").count(),
        2,
        "in the message and above the source line: {}",
        run.stderr
    );
    assert!(!run.stderr.contains("Error:"), "{}", run.stderr);
}

#[test]
fn config_check_warns_about_an_invalid_goal() {
    let path = file(&folder("far-goal"), "far.toml", b"[scenario]\ngoal_x_m = 50\n");
    let run = surepose(&["config", "check", &path]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(run.stderr.contains("rejected by `surepose run`: the goal (50, 2)"), "{}", run.stderr);
    assert!(run.stderr.contains("valid, with a warning"), "{}", run.stderr);
}

#[test]
fn explain_suggests_names() {
    for (name, said) in [
        ("capture_radius", "did you mean law.capture_radius_m?"),
        ("goal", "the keys of [goal] are position_tolerance_m"),
        ("murphy", "lists every parameter"),
    ] {
        let run = surepose(&["config", "explain", name]);
        assert!(run.code == 2 && run.stderr.contains(said), "{name}: {}", run.stderr);
    }
    assert!(surepose(&["config", "explain", "period_s"]).stdout.contains("default: 0.1 s"));
}

#[cfg(unix)]
#[test]
fn endless_and_hopeless_files_are_rejected_at_once() {
    let run = surepose(&["config", "check", "/dev/zero"]);
    assert!(run.code == 2 && run.stderr.contains("too long"), "{}", run.stderr);
    let keys: Vec<String> = (0..20_000).map(|number| format!("x{number} = 1")).collect();
    let path = file(&folder("hopeless"), "keys.toml", format!("[law]\n{}", keys.join("\n")).as_bytes());
    let begun = std::time::Instant::now();
    let run = surepose(&["config", "check", &path]);
    assert!(run.code == 2 && run.stderr.contains("20000 problems, of which 20 follow"), "{}", run.stderr);
    assert!(begun.elapsed() < std::time::Duration::from_secs(5), "{:?}", begun.elapsed());
}
