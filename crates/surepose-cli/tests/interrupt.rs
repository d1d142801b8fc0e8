//! Ctrl-C: exit code 130, completed work is kept, and the result is marked.

#![cfg(unix)]
#![allow(clippy::expect_used, reason = "a failed precondition fails the test")]

mod common;

use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use common::{Run, file, folder, rover, surepose};

/// Runs the program, interrupts it once `when` returns, and returns the time until it ended.
fn interrupted(arguments: &[&str], when: impl FnOnce()) -> (Run, Duration) {
    let (run, took) = signaled("-INT", arguments, when);
    assert_eq!(run.code, 130, "{arguments:?}: {}", run.stderr);
    (run, took)
}

/// Runs the program, sends it `signal` once `when` returns, and returns the time until it ended.
fn signaled(signal: &str, arguments: &[&str], when: impl FnOnce()) -> (Run, Duration) {
    let child = Command::new(env!("CARGO_BIN_EXE_surepose"))
        .args(arguments)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    when();
    // Two signals, as parent programs send them: to the process and to its group.
    let id = child.id().to_string();
    let asked = Command::new("kill").args([signal, &id, &id]).status().expect("kill is there");
    assert!(asked.success(), "{arguments:?} has ended before");
    let asked = Instant::now();
    let output = child.wait_with_output().expect("it ends");
    let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
    let code = output.status.code().expect("the program ends by itself");
    let run = Run { code, stdout: text(output.stdout), stderr: text(output.stderr) };
    (run, asked.elapsed())
}

fn after(milliseconds: u64) -> impl FnOnce() {
    move || sleep(Duration::from_millis(milliseconds))
}

/// Waits until a file exists.
fn written(path: &std::path::Path) -> impl FnOnce() {
    move || {
        let there = (0..12_000).any(|_| {
            sleep(Duration::from_millis(5));
            path.exists()
        });
        assert!(there, "no {} within a minute", path.display());
    }
}

#[test]
fn interrupted_run_keeps_its_results() {
    let out = folder("interrupted");
    // An unreachable tolerance and 500 ticks per second leave time for the interrupt.
    let set = ["goal.position_tolerance_m=0.000000001", "scenario.timeout_s=3600", "loop.period_s=0.002"];
    let set: Vec<&str> = set.into_iter().flat_map(|it| ["--set", it]).collect();
    let arguments = [&["run", "--json", "--out", out.to_str().expect("UTF-8")], &set[..]].concat();
    let json = interrupted(&arguments, after(500)).0.json();
    assert_eq!((&json["outcome"], &json["interrupted"]), (&"interrupted".into(), &true.into()), "{json}");
    assert!(std::fs::read_to_string(out.join("summary.json")).expect("written").contains("interrupted"));
    assert!(out.join("time_series.csv").exists() && out.join("lyapunov.png").exists());
}

/// A termination has its own exit code, with and without partial results.
#[test]
fn termination_exits_with_143() {
    let set = ["goal.position_tolerance_m=0.000000001", "scenario.timeout_s=3600", "loop.period_s=0.002"];
    let set: Vec<&str> = set.into_iter().flat_map(|it| ["--set", it]).collect();
    let (run, _) = signaled("-TERM", &[&["run", "--json"], &set[..]].concat(), after(500));
    assert_eq!((run.code, &run.json()["outcome"]), (143, &"interrupted".into()), "{}", run.stderr);
    let noise = ["certify", "--json", "--noise-position", "0.02", "--noise-heading", "1.2"];
    let (run, _) = signaled("-TERM", &noise, after(300));
    assert_eq!((run.code, run.stdout.as_str()), (143, "{\"interrupted\":true}\n"), "{}", run.stderr);
}

/// The run is complete, but marked because plots are missing.
#[test]
fn run_without_all_plots_is_marked() {
    let out = folder("interrupted-drawing");
    let (config, arguments) =
        (out.join("config.toml"), ["run", "--json", "--out", out.to_str().expect("UTF-8")]);
    let json = interrupted(&arguments, written(&config)).0.json();
    assert_eq!((&json["outcome"], &json["interrupted"]), (&"reached".into(), &true.into()), "{json}");
    assert!(std::fs::read_to_string(out.join("summary.json")).expect("written").contains("interrupted"));
    assert!(!out.join("lyapunov.png").exists());
}

/// Partial results are kept and marked.
#[test]
fn interrupted_result_is_marked() {
    let out = folder("interrupted-figures");
    let figures = ["reproduce", "fig4", "--runs", "1000000", "--json", "--out", out.to_str().expect("UTF-8")];
    for arguments in [
        &["sweep", "--runs", "5000000", "--threads", "1", "--json"][..],
        &["tune", "--rounds", "1000", "--threads", "1", "--period", "0.1", "--json"],
        &figures,
    ] {
        let (run, took) = interrupted(arguments, after(5000));
        assert_eq!(run.json()["interrupted"], true, "{}", run.stdout);
        assert_eq!(run.stderr.matches("warning: interrupted").count(), 1, "{}", run.stderr);
        // Running certificates are abandoned: each takes about 1 s, and several may run besides these tests.
        assert!(arguments[0] != "tune" || took < Duration::from_secs(3), "{took:?}");
        if arguments[0] == "reproduce" {
            // Every set of sensors has the same runs.
            let json = run.json();
            let runs = |set: &str| json["fig4"][set]["runs"].as_u64();
            assert!(runs("odometry").is_some_and(|runs| (1..1_000_000).contains(&runs)), "{json}");
            for set in ["odometry+compass", "odometry+laser", "odometry+laser+compass"] {
                assert_eq!(runs(set), runs("odometry"), "{json}");
            }
            assert!(json["fig4"]["extraction"].is_object(), "{json}");
            let kept = std::fs::read_to_string(out.join("figures.json")).expect("written");
            assert!(kept.contains("interrupted"), "{kept}");
        }
    }
    let whole = surepose(&["sweep", "--runs", "10", "--json"]);
    assert!(
        whole.json()["interrupted"].is_null() && !whole.stderr.contains("interrupted"),
        "{}",
        whole.stderr
    );
}

/// Without a finished trial the output directory is still written.
#[test]
fn interrupted_sweep_without_trials_is_written() {
    let out = folder("interrupted-sweep");
    let hard = ["--loop", "ekf", "--period", "0.001", "--threads", "1", "--set", "law.k_v=0.01"];
    let arguments = [&["sweep", "--json", "--out", out.to_str().expect("UTF-8")], &hard[..]].concat();
    let json = interrupted(&arguments, after(700)).0.json();
    assert_eq!((&json["runs"], &json["interrupted"]), (&0.into(), &true.into()), "{json}");
    assert!(out.join("summary.json").exists() && !out.join("trials.parquet").exists());
}

/// The certificate is complete, but marked because plots are missing.
#[test]
fn certificate_without_plots_is_marked() {
    let out = folder("interrupted-margin");
    let summary = out.join("summary.json");
    let arguments = ["certify", "--json", "--out", out.to_str().expect("UTF-8")];
    // The summary is written before the plots, which take about half a minute.
    let begun = || {
        written(&summary)();
        sleep(Duration::from_millis(500));
    };
    let json = interrupted(&arguments, begun).0.json();
    assert_eq!((&json["certified"], &json["interrupted"]), (&true.into(), &true.into()), "{json}");
    assert!(std::fs::read_to_string(&summary).expect("written").contains("interrupted"));
    assert!(!out.join("margin.png").exists());
}

/// A map is always written together with its plot.
#[test]
fn interrupt_does_not_separate_map_and_plot() {
    let folder = folder("interrupted-map");
    // One wall in every eighth row of a 900 × 900 grid: drawing them takes seconds.
    let cell = |k: usize| if k / 900 % 8 == 4 && k % 45 > 3 { 0 } else { 254 };
    let image = [b"P5\n900 900\n255\n".to_vec(), (0..900 * 900).map(cell).collect()].concat();
    file(&folder, "hall.pgm", &image);
    let grid = file(
        &folder,
        "hall.yaml",
        b"image: hall.pgm\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.2\n",
    );
    let out = folder.join("walls.toml");
    let arguments = ["map", "from-grid", &grid, "--json", "--out", out.to_str().expect("UTF-8")];
    let json = interrupted(&arguments, written(&out)).0.json();
    assert!(json["walls"].is_number() && json["interrupted"].is_null(), "{json}");
    assert!(folder.join("walls.png").exists());
}

/// Commands without partial results still print one JSON object.
#[test]
fn interrupted_command_without_results_prints_json() {
    let nothing = "{\"interrupted\":true}\n";
    // A certificate for this noise takes about 1 s.
    let noise = ["--noise-position", "0.02", "--noise-heading", "1.2"];
    for (command, result) in
        [(&["certify"][..], ""), (&["certify", "--json"], nothing), (&["tune", "--json"], nothing)]
    {
        let arguments = [command, &noise[..]].concat();
        let run = interrupted(&arguments, after(300)).0;
        assert_eq!(run.stdout, result, "{arguments:?}");
        assert!(run.stderr.contains("nothing was completed"), "{arguments:?}: {}", run.stderr);
    }
}

/// Canceled work prints its JSON, too.
#[test]
fn interrupted_calibration_prints_json() {
    let log = file(&folder("interrupted-calibration"), "rover.dat", &rover(2000, 100_000));
    for (json, result) in [(&["--json"][..], "{\"interrupted\":true}\n"), (&[], "")] {
        let arguments = [&["calibrate", "ticks", &log], json].concat();
        let run = interrupted(&arguments, after(700)).0;
        assert_eq!(run.stdout, result, "{}", run.stderr);
        assert_eq!(
            run.stderr.matches("warning: interrupted: nothing was completed").count(),
            1,
            "{}",
            run.stderr
        );
    }
}
