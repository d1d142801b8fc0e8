//! The effect of each tuned constant of the control law: the trials with the constant and without it.
//!
//! The constants are compiled into the law. So each is disabled in a copy of the sources, whose program then runs the trials.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value as Json;

/// File of the constants, below the root.
const TABLE: &str = "crates/surepose/src/control/tuning.rs";

/// Value of each constant at which it has no effect, or that of a law without the idea behind it.
const DISABLED: [(&str, &str); 25] = [
    ("K_V_PER_PERIOD", "1.0"),
    ("K_ALPHA_PER_PERIOD", "1.0"),
    ("K_THETA_PER_PERIOD", "SMALL_ERROR_THETA_PER_PERIOD"),
    ("SMALL_ERROR_ALPHA_PER_PERIOD", "K_ALPHA_PER_PERIOD"),
    ("SMALL_ERROR_THETA_PER_PERIOD", "K_THETA_PER_PERIOD"),
    ("MAX_K_V", "1e9"),
    ("SETTLING_DISTANCE", "1e-3"),
    ("APPROACH_WEIGHT", "1.0"),
    ("ACCELERATION_FRACTION", "1.0"),
    ("ENTER_RADIUS", "LEAVE_RADIUS"),
    ("LEAVE_RADIUS", "ENTER_RADIUS"),
    ("SIDESTEP_THRESHOLD", "1e9"),
    ("SIDESTEP_TICKS", "1.0"),
    ("MAX_TRIM_TICKS", "1e9"),
    ("ARRIVED_RADIUS", "1e-6"),
    ("MIN_TURN_FACTOR", "0.0"),
    ("APPROACH_RADIUS", "1e-6"),
    ("FULL_GAIN_ALPHA", "1e-6"),
    ("FULL_GAIN_THETA", "1e-6"),
    ("TRIM_THRESHOLD", "1e-6"),
    ("DEADBAND_STD_DEVS", "0.0"),
    ("MAX_DEADBAND_RADIUS", "1e9"),
    ("REVERSAL_FACTOR", "1.0"),
    ("TURN_HYSTERESIS", "0.0"),
    ("DIRECTION_HYSTERESIS", "0.0"),
];

/// Arguments of the trials, with the words for them; `STARTS` stands for the file of starts beside the goal.
const TRIALS: [(&str, &str); 11] = [
    ("no noise, 0.02 s", "sweep --runs 20000"),
    ("bench noise, 0.02 s", "sweep --runs 20000 --noise bench"),
    ("bench noise, 0.1 s", "sweep --runs 20000 --noise bench --period 0.1"),
    ("noise unknown to the law", "sweep --runs 20000 --noise bench --set law.position_noise_m=0"),
    ("noise overstated", "sweep --runs 5000 --noise bench --set law.position_noise_m=0.02"),
    ("starts beside the goal", "sweep --starts STARTS --noise bench --set law.position_noise_m=0"),
    (
        "0.2 m/s² wheels",
        "sweep --runs 200 --noise bench --set robot.wheel_acceleration_limit_m_s2=0.2 \
         --world robot.wheel_acceleration_limit_m_s2=0.2",
    ),
    (
        "0.1 m/s² wheels, 0.1 s",
        "sweep --runs 300 --period 0.1 --set robot.wheel_acceleration_limit_m_s2=0.1 \
         --world robot.wheel_acceleration_limit_m_s2=0.1",
    ),
    ("certificate, 0.02 s", "certify --period 0.02"),
    ("certificate, 0.1 s", "certify --period 0.1"),
    ("certificate, 20 mm", "certify --period 0.02 --noise-position 0.02 --noise-heading 1.2"),
];

/// Repeats the trials without each constant of `names`, or without each constant.
pub(crate) fn run(root: &Path, names: &[String]) -> Result<(), String> {
    let table = read(&root.join(TABLE))?;
    check(&table)?;
    if let Some(unknown) = names.iter().find(|name| DISABLED.iter().all(|(known, _)| known != name)) {
        let known: Vec<&str> = DISABLED.iter().map(|(name, _)| *name).collect();
        return Err(format!("ablation: unknown constant {unknown}; expected one of {}", known.join(", ")));
    }
    let folder = root.join("target/ablation");
    let copy = folder.join("sources");
    copy_sources(root, &copy)?;
    let starts = folder.join("starts.csv");
    fs::write(&starts, starts_beside_the_goal()).map_err(|error| format!("{}: {error}", starts.display()))?;

    let complete = trials(&copy, &folder, &starts, &table)?;
    for (name, value) in DISABLED {
        if !names.is_empty() && names.iter().all(|wanted| wanted != name) {
            continue;
        }
        println!("\n{name} = {} without: {value}", declared(&table, name).unwrap_or_default());
        match trials(&copy, &folder, &starts, &without(&table, name, value)?) {
            Ok(results) => report(&complete, &results),
            Err(error) => println!("  {error}"),
        }
    }
    write_if_changed(&copy.join(TABLE), &table)
}

/// Fails unless exactly the constants of the table can be disabled.
pub(crate) fn check(table: &str) -> Result<(), String> {
    let names: Vec<&str> = table.lines().filter_map(name_of).collect();
    if names.iter().copied().eq(DISABLED.iter().map(|(name, _)| *name)) {
        Ok(())
    } else {
        Err(format!("ablation: {TABLE} and xtask/src/ablation.rs list different constants"))
    }
}

fn name_of(line: &str) -> Option<&str> {
    line.strip_prefix("pub(super) const ")?.split_once(':').map(|(name, _)| name)
}

fn declared<'a>(table: &'a str, name: &str) -> Option<&'a str> {
    let line = table.lines().find(|line| name_of(line) == Some(name))?;
    line.split_once(" = ").map(|(_, value)| value)
}

/// The table with another value of one constant.
fn without(table: &str, name: &str, value: &str) -> Result<String, String> {
    let declared = declared(table, name).ok_or_else(|| format!("ablation: {TABLE} has no {name}"))?;
    // A value may be another constant, whose number it takes: that one may refer to this one.
    let value = self::declared(table, value).map_or_else(|| format!("{value};"), str::to_owned);
    let declaration = |value: &str| format!("const {name}: f64 = {value}");
    Ok(table.replace(&declaration(declared), &declaration(&value)))
}

/// Builds the program with this table and returns the result of each trial.
fn trials(copy: &Path, folder: &Path, starts: &Path, table: &str) -> Result<Vec<Json>, String> {
    write_if_changed(&copy.join(TABLE), table)?;
    crate::run::cargo(copy, &["build", "--quiet", "--release", "--target-dir", "../build"], &[])?;
    let program = folder.join("build/release/surepose");
    TRIALS.iter().map(|(_, arguments)| result(&program, arguments, starts)).collect()
}

fn result(program: &Path, arguments: &str, starts: &Path) -> Result<Json, String> {
    let arguments = arguments.split_whitespace().map(|word| match word {
        "STARTS" => starts.as_os_str(),
        word => word.as_ref(),
    });
    let output = Command::new(program).args(arguments).arg("--json").output();
    let output = output.map_err(|error| format!("{}: {error}", program.display()))?;
    serde_json::from_slice(&output.stdout).map_err(|_| String::from_utf8_lossy(&output.stderr).into_owned())
}

/// Prints the figures that differ, with and without the constant.
fn report(complete: &[Json], without: &[Json]) {
    let mut has_effect = false;
    for (((words, _), complete), without) in TRIALS.iter().zip(complete).zip(without) {
        let (complete, without) = (figures(complete), figures(without));
        if complete != without {
            has_effect = true;
            println!("  {words:<26} with    {complete}\n  {:<26} without {without}", "");
        }
    }
    if !has_effect {
        println!("  no figure differs");
    }
}

/// The figures of a result, rounded.
fn figures(result: &Json) -> String {
    let number = |pointer: &str| result.pointer(pointer).and_then(Json::as_f64);
    let shown = |pointer: &str, scale: f64, digits: usize| {
        number(pointer).map_or_else(|| "–".to_owned(), |value| format!("{:.digits$}", value * scale))
    };
    if result.get("certified").is_some() {
        return format!(
            "certified {} · within {} cm · stays {} cm · heading {}°",
            result["certified"],
            shown("/capture_radius_m", 100.0, 2),
            shown("/final_position_bound_m", 100.0, 2),
            shown("/final_heading_bound_deg", 1.0, 2),
        );
    }
    format!(
        "{:>7} % · {} × optimal, 95 % {} · slowest {} s · {} reversals · error 95 % {} mm, {}°",
        shown("/success_rate", 100.0, 3),
        shown("/time_ratio/p50", 1.0, 3),
        shown("/time_ratio/p95", 1.0, 3),
        shown("/time_s/max", 1.0, 1),
        shown("/cusps_mean", 1.0, 2),
        shown("/final_position_error_m/p95", 1000.0, 2),
        shown("/final_heading_error_deg/p95", 1.0, 3),
    )
}

/// 2000 starts 1 to 4 cm from the goal, in all directions, with headings within ±10°.
fn starts_beside_the_goal() -> String {
    let mut rows = vec!["x_m,y_m,heading_deg".to_owned()];
    for index in 0..2000_u32 {
        // The golden angle and the plastic number spread the starts evenly.
        let (turn, part) = (f64::from(index) * 2.399_963, f64::from(index) * 0.754_878 % 1.0);
        let radius = 0.01 + 0.03 * f64::from(index) / 2000.0;
        rows.push(format!("{},{},{}", radius * turn.cos(), radius * turn.sin(), 20.0 * part - 10.0));
    }
    rows.join("\n")
}

/// Copies the files under version control; an unchanged file keeps its time, so that it is not compiled again.
fn copy_sources(root: &Path, copy: &Path) -> Result<(), String> {
    let listed = Command::new("git").current_dir(root).args(["ls-files", "-z"]).output();
    let listed = listed.map_err(|error| format!("git: start failed: {error}"))?;
    for file in String::from_utf8_lossy(&listed.stdout).split('\0').filter(|file| !file.is_empty()) {
        let (from, to) = (root.join(file), copy.join(file));
        let Ok(content) = fs::read(&from) else { continue };
        if fs::read(&to).is_ok_and(|present| present == content) {
            continue;
        }
        let parent = to.parent().map(PathBuf::from).unwrap_or_default();
        fs::create_dir_all(parent)
            .and_then(|()| fs::write(&to, content))
            .map_err(|error| format!("{file}: {error}"))?;
    }
    Ok(())
}

fn read(path: &Path) -> Result<String, String> {
    fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))
}

fn write_if_changed(path: &Path, content: &str) -> Result<(), String> {
    if fs::read_to_string(path).is_ok_and(|present| present == content) {
        return Ok(());
    }
    fs::write(path, content).map_err(|error| format!("{}: {error}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_constant_can_be_disabled() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let table = read(&root.join(TABLE)).unwrap_or_default();
        assert_eq!(check(&table), Ok(()));
        for (name, value) in DISABLED {
            let changed = without(&table, name, value).unwrap_or_default();
            assert_eq!(
                table.lines().zip(changed.lines()).filter(|(before, after)| before != after).count(),
                1,
                "{name}"
            );
        }
    }
}
