//! `surepose run` and `reproduce`: JSON keys, exit codes, files, and reproducibility for a given seed.

#![allow(clippy::expect_used, reason = "a failed precondition fails the test")]

mod common;

use std::collections::BTreeMap;
use std::path::Path;

use common::{file, folder, surepose};

/// Reads every file of a directory, by name.
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries =
        std::fs::read_dir(folder).expect("the folder is there").map(|entry| entry.expect("readable"));
    entries
        .map(|entry| {
            let bytes = std::fs::read(entry.path()).expect("readable");
            (entry.file_name().to_string_lossy().into_owned(), bytes)
        })
        .collect()
}

#[test]
fn default_run_reaches_the_goal() {
    let run = surepose(&["--json"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let json = run.json();
    for key in [
        "outcome",
        "time_s",
        "final_position_error_m",
        "final_heading_error_deg",
        "final_speed_m_s",
        "position_rmse_m",
        "heading_rmse_deg",
        "nees_mean",
        "path_length_m",
        "optimal_time_s",
        "seed",
    ] {
        assert!(!json[key].is_null(), "{key} in {json}");
    }
    assert_eq!(json["outcome"], "reached");
    assert!(json["final_position_error_m"].as_f64().is_some_and(|error| error <= 0.01), "{json}");
    assert!(json["final_heading_error_deg"].as_f64().is_some_and(|error| error <= 1.0), "{json}");
    assert_eq!(json, surepose(&["run", "--seed", "1", "--json"]).json());
}

#[test]
fn same_seed_gives_the_same_bytes_in_every_file() {
    let [first, second, other] = ["run-first", "run-second", "run-other"].map(folder);
    for (out, seed) in [(&first, "5"), (&second, "5"), (&other, "6")] {
        let run = surepose(&["run", "--seed", seed, "--out", out.to_str().expect("UTF-8")]);
        assert_eq!(run.code, 0, "{}", run.stderr);
        assert_eq!(run.stdout, "", "tables go to standard error");
    }
    let (first, second, other) = (contents(&first), contents(&second), contents(&other));
    let pictures = ["overview", "trajectory", "velocities", "heading_error", "lyapunov"];
    let pictures = pictures.iter().flat_map(|name| [format!("{name}.svg"), format!("{name}.png")]);
    let data = ["time_series.csv", "summary.json", "config.toml"].map(str::to_owned);
    for name in pictures.chain(data) {
        assert!(first.contains_key(&name), "{name} in {:?}", first.keys());
    }
    for (name, bytes) in &first {
        assert!(second.get(name) == Some(bytes), "{name} differs from run to run");
    }
    assert_ne!(first["time_series.csv"], other["time_series.csv"]);
}

#[test]
fn written_configuration_repeats_the_run() {
    let out = folder("run-again");
    let goal = ["--goal", "1,-0.5,-90", "--seed", "3", "--json"];
    let out_text = out.to_str().expect("UTF-8");
    let first = surepose(&[&["run", "--out", out_text][..], &goal[..]].concat());
    let config = out.join("config.toml");
    let again = surepose(&["run", "--scenario", config.to_str().expect("UTF-8"), "--seed", "3", "--json"]);
    assert_eq!(first.code, 0, "{}", first.stderr);
    assert_eq!(first.json(), again.json());
}

/// If a file cannot be written completely, here because its temporary name is a directory, the previous file remains.
#[test]
fn files_are_written_completely_or_not_at_all() {
    let out = folder("run-part");
    std::fs::write(out.join("summary.json"), "before").expect("written");
    std::fs::create_dir(out.join("summary.json.part")).expect("made");
    let run = surepose(&["run", "--out", out.to_str().expect("UTF-8")]);
    assert!(run.code == 2 && run.stderr.contains("summary.json: cannot be written"), "{}", run.stderr);
    assert_eq!(std::fs::read_to_string(out.join("summary.json")).expect("kept"), "before");
    // The result is not lost.
    let run = surepose(&["run", "--json", "--out", out.to_str().expect("UTF-8")]);
    assert_eq!((run.code, run.json()["outcome"].as_str()), (2, Some("reached")), "{}", run.stderr);
    std::fs::remove_dir(out.join("summary.json.part")).expect("removed");
    assert!(contents(&out).keys().all(|name| !name.contains(".part")));
}

#[test]
fn timeout_exits_with_1() {
    let run = surepose(&["run", "--set", "scenario.timeout_s=1", "--json"]);
    assert_eq!(run.code, 1, "{}", run.stderr);
    assert_eq!(run.json()["outcome"], "timeout");
}

#[test]
fn goal_reached_only_by_the_estimate_exits_with_1() {
    let blind = ["run", "--seed", "1", "--set", "laser.beams=5", "--set", "compass.std_deg=180"];
    let run = surepose(&[&blind[..], &["--json"]].concat());
    assert_eq!(run.code, 1, "{}", run.stderr);
    let json = run.json();
    assert_eq!(json["outcome"], "missed", "{json}");
    assert!(json["final_position_error_m"].as_f64().is_some_and(|error| error > 0.01), "{json}");
    assert!(surepose(&blind).stderr.contains("outside the tolerance"));
}

/// A start or goal in a wall or outside the arena is a usage error; a goal behind a plate is only out of reach.
#[test]
fn walls_and_plates_restrict_start_and_goal() {
    for (option, named) in [
        ("--goal=3.6,1,0", "too close to the wall from (3.60, 0.40) to (3.60, 1.60)"),
        ("--goal=4.42,2,90", "0.00 m to the footprint"),
        ("--goal=-3,0,0", "outside the arena"),
        ("--start=3.6,1,0", "(3.6, 0.4) to (3.6, 1.6)"),
        ("--start=-1,1,0", "(-1, 0.8) to (-1, 2)"),
    ] {
        let run = surepose(&["run", option, "--json"]);
        assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{option}: {}", run.stderr);
        let flag = option.split('=').next().expect("its name");
        assert!(run.stderr.contains(named) && run.stderr.contains(flag), "{option}: {}", run.stderr);
    }
    let run = surepose(&["run", "--goal", "4.1,1,0", "--json"]);
    assert_eq!(run.code, 4, "{}", run.stderr);
    let json = run.json();
    assert_eq!((&json["outcome"], &json["stop_reason"]), (&"stopped".into(), &"wall".into()), "{json}");
    assert!(json["closest_wall_m"].as_f64().is_some_and(|nearest| nearest > 0.0), "{json}");
    assert_eq!(json["final_speed_m_s"], 0.0, "{json}");
    assert!(run.stderr.contains("does not plan around"), "{}", run.stderr);
    assert_eq!(surepose(&["run", "--scenario", "loop", "--json"]).code, 0);
}

#[test]
fn invalid_command_line_exits_with_2() {
    let folder = folder("run-wrong");
    let not_a_folder = file(&folder, "file", b"");
    let damaged = file(&folder, "damaged.toml", b"[scenario]\narena = \"mars\"\n");
    for arguments in [
        &["run", "--scenario", "mars"][..],
        &["run", "--scenario", "no/such/file.toml"],
        &["run", "--scenario", &damaged],
        &["run", "--start", "1,2"],
        &["run", "--start", "1,2,nan"],
        &["run", "--goal", "1,inf,0"],
        &["run", "--seed", "-1"],
        &["run", "--out", &not_a_folder],
        &["reproduce"],
        &["reproduce", "fig1", "--out", "x"],
        &["reproduce", "--out", &not_a_folder],
    ] {
        let run = surepose(arguments);
        assert_eq!(run.code, 2, "{arguments:?}: {}", run.stderr);
        assert_eq!(run.stdout, "", "{arguments:?}");
    }
    assert!(surepose(&["run", "--scenario", &damaged]).stderr.contains(&format!("{damaged}:2")));
}

#[test]
fn figures_have_the_documented_keys() {
    let out = folder("figures");
    let run = surepose(&["reproduce", "fig3", "fig7", "--out", out.to_str().expect("UTF-8"), "--json"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let json = run.json();
    for figure in ["fig3", "fig7"] {
        let goals = json[figure].as_array().expect("a list");
        assert_eq!(goals.len(), 3);
        for goal in goals {
            assert_eq!(goal["reached"], true, "{goal}");
            assert!(goal["final_position_error_m"].as_f64().is_some_and(|error| error <= 0.01), "{goal}");
            assert!(goal["final_heading_error_deg"].as_f64().is_some_and(|error| error <= 1.0), "{goal}");
        }
        assert!(out.join(format!("{figure}.svg")).exists() && out.join(format!("{figure}.png")).exists());
    }
    for key in ["final_speed_m_s", "final_turn_rate_deg_s"] {
        assert_eq!(json["fig7"][0][key], 0.0, "{json}");
    }
}

#[test]
fn fig6_compares_runs_with_and_without_the_filter() {
    let out = folder("figure6");
    let run =
        surepose(&["reproduce", "fig6", "--out", out.to_str().expect("UTF-8"), "--runs", "10", "--json"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let json = run.json();
    for path in ["rounded_rectangle", "rounded_triangle"] {
        let rmse = |with: &str| json["fig6"][path][with]["path_rmse_m"].as_f64().expect("a number");
        assert!(rmse("without_ekf") > rmse("with_ekf"), "{json}");
    }
}

#[test]
fn closed_pipe_keeps_the_exit_code() {
    use std::process::{Command, Stdio};
    for (arguments, code) in [(&["run"][..], 0), (&["run", "--scenario", "nowhere"], 2)] {
        let mut child = Command::new(env!("CARGO_BIN_EXE_surepose"))
            .args(arguments)
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts");
        drop(child.stderr.take());
        assert_eq!(child.wait().expect("it ends").code(), Some(code), "{arguments:?}");
    }
}

#[test]
fn fig4_compares_four_sensor_sets() {
    let out = folder("figure4");
    let path = out.to_str().expect("UTF-8");
    let run = surepose(&["reproduce", "fig4", "fig5", "--out", path, "--runs", "3", "--json"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let json = run.json();
    for configuration in ["odometry", "odometry+compass", "odometry+laser", "odometry+laser+compass"] {
        for key in
            ["position_rmse_m", "heading_rmse_deg", "nees_mean", "max_deviation_x_m", "max_deviation_y_m"]
        {
            assert!(json["fig4"][configuration][key].is_number(), "{configuration} {key} in {json}");
        }
    }
    assert_eq!(json["fig4"], json["fig5"]);
    let rmse =
        |configuration: &str| json["fig4"][configuration]["position_rmse_m"].as_f64().expect("a number");
    assert!(rmse("odometry") > 3.0 * rmse("odometry+compass"), "{json}");
    assert!(rmse("odometry+compass") > 3.0 * rmse("odometry+laser+compass"), "{json}");
    assert!(out.join("fig4.png").exists() && out.join("fig5.svg").exists());
    for key in ["walls_found_share", "line_nees_mean", "wrong_match_share"] {
        assert!(json["fig4"]["extraction"][key].is_number(), "{key} in {json}");
    }
    let finer =
        surepose(&["reproduce", "fig4", "--out", path, "--runs", "3", "--json", "--set", "laser.beams=361"]);
    let finer = finer.json()["fig4"]["odometry+laser+compass"]["position_rmse_m"].as_f64().expect("a number");
    assert!(finer < 0.9 * rmse("odometry+laser+compass"), "twice the beams: {finer} in {json}");
}

/// Plots and the HTML page are downsampled; the table holds every sample.
#[test]
fn plots_of_a_long_run_are_downsampled() {
    let out = folder("run-long");
    let set = ["loop.period_s=0.001", "law.k_v=0.000001", "scenario.timeout_s=10"];
    let set: Vec<&str> = set.into_iter().flat_map(|it| ["--set", it]).collect();
    let run = surepose(&[&["run", "--out", out.to_str().expect("UTF-8")], &set[..]].concat());
    assert_eq!(run.code, 1, "{}", run.stderr);
    let text = |name: &str| std::fs::read_to_string(out.join(name)).expect("written");
    assert!(text("time_series.csv").lines().count() >= 10_000);
    let shown = text("drive.html").matches("\"time_s\":").count();
    assert!((1000..=4000).contains(&shown), "{shown} samples");
}

/// Two beams form no line, so that compass and odometry alone remain, with a warning.
#[test]
fn missing_walls_are_reported() {
    let saw_none = "laser: no wall was observed";
    let usual = surepose(&["run", "--json"]);
    assert!(usual.json()["walls"].as_u64().is_some_and(|walls| walls > 100), "{}", usual.stdout);
    assert!(!usual.stderr.contains(saw_none), "{}", usual.stderr);
    let blind = surepose(&["run", "--json", "--set", "laser.beams=2"]);
    assert_eq!(blind.json()["walls"], 0);
    assert!(blind.stderr.contains(saw_none), "{}", blind.stderr);
}

#[test]
fn fig3_warns_that_it_ignores_the_configuration() {
    let out = folder("figure3");
    let path = out.to_str().expect("UTF-8");
    let run = surepose(&["reproduce", "fig3", "--out", path, "--json", "--set", "law.k_v=1"]);
    assert!(run.code == 0 && run.stderr.contains("the configuration is ignored"), "{}", run.stderr);
}

/// The true track differs from the configured one: the run changes, and the configuration does not.
#[test]
fn world_differs_from_the_configuration() {
    let (told, world) = (folder("run-told"), folder("run-world"));
    let run = |out: &Path, different: &[&str]| {
        let usual = ["run", "--seed", "2", "--json", "--out", out.to_str().expect("UTF-8")];
        surepose(&[&usual[..], different].concat())
    };
    let (usual, different) = (run(&told, &[]), run(&world, &["--world", "robot.track_m=0.57"]));
    assert_eq!(different.json()["world"]["robot.track_m"], 0.57, "{}", different.stdout);
    assert!(usual.json()["world"].is_null() && usual.json()["nees_mean"] != different.json()["nees_mean"]);
    let config = |out: &Path| std::fs::read_to_string(out.join("config.toml")).expect("written");
    assert_eq!(config(&told), config(&world));
    // A value as told changes nothing.
    let same = surepose(&["run", "--seed", "2", "--json", "--world", "robot.track_m=0.6"]).json();
    assert_eq!(same["nees_mean"], usual.json()["nees_mean"]);
}

#[test]
fn invalid_world_exits_with_2_and_proposes_a_key() {
    for (options, named) in [
        (&["--world", "robot.trak_m=0.6"][..], "did you mean `track_m`?"),
        (&["--world", "law.k_v=3"], "`law.k_v`: not a property of the simulated world"),
        (&["--world", "robot.track_m=wide"], "`track_m`: expected a number"),
        (&["--world", "motor.breakaway_speed_m_s=-1"], "negative value"),
        (&["--world", "robot.track_m=0.5", "--world", "robot.track_m=0.7"], "two values (got 0.5 and 0.7)"),
        (&["--world", "gyroscope.bias_deg_s=1"], "without effect"),
        (&["--world", "scenario.start_x_m=-3"], "outside the arena"),
    ] {
        let run = surepose(&[&["run", "--json"], options].concat());
        assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{options:?}: {}", run.stderr);
        assert!(run.stderr.contains(named), "{options:?}: {}", run.stderr);
    }
}

/// The help lists every key, and `config explain` explains those that only a world has.
#[test]
fn world_help_lists_every_key() {
    let help = surepose(&["run", "--world", "help"]);
    assert_eq!(help.code, 0, "{}", help.stderr);
    let json = surepose(&["run", "--world", "help", "--json"]).json();
    assert!(json["motor.model"]["meaning"].is_string() && json["law.k_v"].is_null(), "{json}");
    for key in json.as_object().expect("an object").keys() {
        assert!(help.stdout.contains(&format!("\n{key}\n")), "{key} in {}", help.stdout);
        assert_eq!(surepose(&["config", "explain", key]).code, 0, "{key}");
    }
}

/// Wheels that are held stop the robot; a reason is named, and rejections are counted by reason.
#[test]
fn held_wheels_stop_the_robot() {
    let held = ["--world", "fault.held_wheels=both", "--world", "fault.held_from_s=3"];
    let run = surepose(&[&["run", "--json"], &held[..]].concat());
    let json = run.json();
    assert!(run.code != 0 && json["outcome"] != "reached", "{json}");
    assert_eq!(json["final_speed_m_s"], 0.0, "{json}");
    assert!(json["rejected"]["outlier"].is_u64() && json["rejected"]["stale"].is_u64(), "{json}");
}

/// The robot takes its walls from a file; the walls of the world may differ.
#[test]
fn maps_of_robot_and_world_are_files() {
    let folder = folder("run-map");
    let room = |width: f64| {
        let corners = [[-1.0, -1.5], [width - 1.0, -1.5], [width - 1.0, 2.0], [-1.0, 2.0]];
        let wall =
            |k: usize| format!("[[wall]]\nfrom_m = {:?}\nto_m = {:?}\n", corners[k], corners[(k + 1) % 4]);
        file(&folder, &format!("room-{width}.toml"), (0..4).map(wall).collect::<String>().as_bytes())
    };
    let (map, wider) = (room(4.0), room(4.06));
    let world = format!("map={wider}");
    let run = |options: &[&str]| {
        let common = ["run", "--map", &map, "--goal", "2,1,90", "--json"];
        surepose(&[&common, options].concat())
    };
    let same = run(&[]);
    assert_eq!(same.code, 0, "{}", same.stderr);
    assert!(same.json()["position_rmse_m"].as_f64().is_some_and(|error| error < 0.01), "{}", same.json());
    assert!(same.json()["world"].is_null(), "{}", same.json());
    // The estimate follows a wall that is 6 cm away from its place.
    let different = run(&["--world", &world]).json();
    assert_eq!(different["world"]["map"], wider.as_str());
    assert!(different["position_rmse_m"].as_f64().is_some_and(|error| error > 0.01), "{different}");
    for options in
        [["--world", &world, "--world", &world], ["--world", &world, "--world", "scenario.arena=loop"]]
    {
        let twice = run(&options);
        assert_eq!(twice.code, 2);
        assert!(twice.stderr.contains("two sources of the walls"), "{}", twice.stderr);
    }
}
