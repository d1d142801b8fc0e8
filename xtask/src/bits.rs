//! Records hashes of the program's results and compares two records.
//!
//! A refactoring must not change any result. `record` runs the program, the firmware on the host, and the
//! instruction counts. `compare` lists the differences between two records.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Usage text.
pub(crate) const USAGE: &str = "\
cargo xtask bits record FILE [--program PATH] [--tree DIR] [--data DIR]
    --program  program to run; default: a release build of the tree
    --tree     checkout for firmware and instruction counts; default: this one
    --data     folder of recordings; default: $SUREPOSE_DATA, or ../shared/data relative to the tree
cargo xtask bits compare FILE FILE    exit code 1 if any result differs";

/// Number of seeds of the single-run command.
const DRIVES: u32 = 20;

/// Commands without recordings.
const COMPUTED: [&str; 5] = [
    "sweep --runs 20000 --seed 1 --noise none --period 0.02",
    "sweep --runs 20000 --seed 1 --noise bench --period 0.1",
    "sweep --runs 2000 --seed 1 --loop ekf",
    "certify --period 0.02",
    "certify --period 0.1",
];

/// Commands on recordings; `@` denotes the data folder.
const REPLAYS: [&str; 12] = [
    "replay mrclam @mrclam7 --robot 1",
    "replay mrclam @mrclam7 --robot 2",
    "replay mrclam @mrclam7 --robot 3",
    "replay mrclam @mrclam7 --robot 4",
    "replay mrclam @mrclam7 --robot 5",
    "replay carmen @carmen/freiburg-101-corrected.log.gz",
    "replay carmen @carmen/belgioioso-corrected.log.gz",
    "replay ticks @mines_rover/exp1.dat.gz",
    "replay ticks @mines_rover/exp2.dat.gz",
    "replay wean @cmu_wean/robotdata1.log.gz --map @cmu_wean/wean.dat.gz",
    "replay wean @cmu_wean/robotdata1.log.gz --map @cmu_wean/wean.dat.gz --start 40,41.4,-96",
    "replay wean @cmu_wean/robotdata3.log.gz --map @cmu_wean/wean.dat.gz",
];

/// JSON keys of computing times, which vary between runs.
const TIMING_KEYS: [&str; 2] = ["wall_s", "steps_per_s"];

/// Prefix of the names of results that are counts, not hashes.
const COUNT: &str = "instructions ";

/// Largest relative difference between instruction counts that compare as equal.
const MAX_COUNT_DIFFERENCE: f64 = 0.005;

/// Result of a check that is unavailable on this machine.
const SKIPPED: &str = "skipped";

/// Runs `record` or `compare`.
pub(crate) fn run(root: &Path, arguments: &[String]) -> Result<(), String> {
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words[..] {
        ["record", file, ref options @ ..] => {
            let record = Settings::read(root, options)?.record()?;
            fs::write(file, record).map_err(|error| format!("{file}: write failed: {error}"))
        }
        ["compare", first, second] => {
            let read = |file| fs::read_to_string(file).map_err(|error| format!("{file}: {error}"));
            compare(&read(first)?, &read(second)?)
        }
        _ => Err(USAGE.to_owned()),
    }
}

/// Program, checkout, and data folder of a recording.
struct Settings {
    program: Option<PathBuf>,
    tree: PathBuf,
    data: PathBuf,
}

impl Settings {
    fn read(root: &Path, options: &[&str]) -> Result<Self, String> {
        let (mut program, mut tree, mut data) = (None, root.to_owned(), None);
        for option in options.chunks(2) {
            match *option {
                ["--program", path] => program = Some(existing(path)?),
                ["--tree", path] => tree = existing(path)?,
                ["--data", path] => data = Some(existing(path)?),
                _ => return Err(USAGE.to_owned()),
            }
        }
        let data = data.or_else(|| std::env::var_os("SUREPOSE_DATA").map(PathBuf::from));
        let data = data.unwrap_or_else(|| tree.join("../shared/data"));
        Ok(Self { program, tree, data })
    }

    /// Returns one line per check: its name, a tab, and its result.
    fn record(&self) -> Result<String, String> {
        let program = match &self.program {
            Some(program) => program.clone(),
            None => self.built()?,
        };
        let mut record = String::new();
        let mut note = |name: &str, result: &str| {
            eprintln!("{result:>16}  {name}");
            record.extend([name, "\t", result, "\n"]);
        };
        let drives = (1..=DRIVES).map(|seed| format!("run --seed {seed}"));
        let commands = drives.chain(COMPUTED.iter().chain(&REPLAYS).map(|&command| command.to_owned()));
        for command in commands {
            note(&command, &self.hash_of_run(&program, &command)?);
        }
        note("firmware on the host", &crate::microcontroller::host_hash(&self.tree)?);
        match crate::instructions::measure(&self.tree)? {
            Some(counts) => {
                for it in counts {
                    note(&format!("{COUNT}{}", it.work), &it.count.to_string());
                }
            }
            None => note(&format!("{COUNT}(all)"), SKIPPED),
        }
        Ok(record)
    }

    fn built(&self) -> Result<PathBuf, String> {
        let target = self.tree.join("target");
        let build = ["build", "--release", "-p", "surepose-cli", "--target-dir"];
        let arguments: Vec<&str> = build.into_iter().chain(target.to_str()).collect();
        crate::run::cargo(&self.tree, &arguments, &[])?;
        Ok(target.join("release/surepose"))
    }

    /// Hash of the exit code and the JSON output of one command; `skipped` if its recording is missing.
    fn hash_of_run(&self, program: &Path, command: &str) -> Result<String, String> {
        let mut arguments = Vec::new();
        for word in command.split(' ') {
            let Some(file) = word.strip_prefix('@') else {
                arguments.push(word.into());
                continue;
            };
            let path = self.data.join(file);
            if !path.exists() {
                eprintln!("{file}: not found in {}; set --data or SUREPOSE_DATA", self.data.display());
                return Ok(SKIPPED.to_owned());
            }
            arguments.push(path.into_os_string());
        }
        let output = Command::new(program).args(arguments).arg("--json").output();
        let output = output.map_err(|error| format!("{}: start failed: {error}", program.display()))?;
        // Exit codes 0 and 1 are results. Other codes are failures, whose empty outputs would compare as
        // equal.
        let code = match output.status.code() {
            Some(code @ (0 | 1)) if !output.stdout.is_empty() => code,
            _ => return Err(format!("{command}: failed:\n{}", String::from_utf8_lossy(&output.stderr))),
        };
        let json = without_timing(&String::from_utf8_lossy(&output.stdout));
        Ok(format!("{:016x}", fnv_1a(format!("{code} {json}").as_bytes())))
    }
}

fn existing(path: &str) -> Result<PathBuf, String> {
    fs::canonicalize(path).map_err(|error| format!("{path}: {error}"))
}

/// Removes the values of the timing keys, which are numbers, from the JSON text.
fn without_timing(json: &str) -> String {
    let mut kept = json.to_owned();
    for key in TIMING_KEYS.map(|key| format!("\"{key}\":")) {
        while let Some(start) = kept.find(&key) {
            let value = &kept[start + key.len()..];
            let end = start + key.len() + value.find([',', '}', '\n']).unwrap_or(value.len());
            kept.replace_range(start..end, "");
        }
    }
    kept
}

/// 64-bit FNV-1a hash.
fn fnv_1a(bytes: &[u8]) -> u64 {
    bytes
        .iter()
        .fold(0xcbf2_9ce4_8422_2325, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

/// Prints the checks whose results differ or are missing in one record.
fn compare(first: &str, second: &str) -> Result<(), String> {
    let (first, second) = (results(first)?, results(second)?);
    let names: BTreeSet<&str> = first.keys().chain(second.keys()).copied().collect();
    let result = |record: &BTreeMap<&str, &str>, name| record.get(name).map_or("absent", |it| *it).to_owned();
    let (mut differing, mut skipped) = (0, 0);
    for &name in &names {
        let (before, after) = (result(&first, name), result(&second, name));
        if !same(name, &before, &after) {
            println!("{name}: {before} {after}");
            differing += 1;
        } else if before == SKIPPED {
            println!("{name}: skipped in both");
            skipped += 1;
        }
    }
    let summary = format!("bits: {} checks, {differing} differ, {skipped} skipped", names.len());
    if differing > 0 || names.len() == skipped {
        return Err(summary);
    }
    println!("{summary}");
    Ok(())
}

fn results(record: &str) -> Result<BTreeMap<&str, &str>, String> {
    let parted = |line| {
        str::split_once(line, '\t')
            .ok_or_else(|| format!("`{line}`: invalid record line (expected name, tab, result)"))
    };
    record.lines().map(parted).collect()
}

fn same(name: &str, before: &str, after: &str) -> bool {
    match (name.strip_prefix(COUNT), before.parse::<f64>(), after.parse::<f64>()) {
        (Some(_), Ok(before), Ok(after)) => (after - before).abs() <= MAX_COUNT_DIFFERENCE * before,
        _ => before == after,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn timing_values_are_removed() {
        let json = r#"{"steps":3,"steps_per_s":1.5e6,"wall_s":0.25}"#;
        assert_eq!(without_timing(json), r#"{"steps":3,,}"#);
    }

    #[test]
    fn fnv_1a_matches_published_values() {
        assert_eq!([fnv_1a(b""), fnv_1a(b"foobar")], [0xcbf2_9ce4_8422_2325, 0x8594_4171_f739_67e8]);
    }

    #[test]
    fn hashes_compare_exactly_and_counts_with_a_tolerance() {
        let record = "run --seed 1\t1000000000000000\ninstructions law\t1000\n";
        assert_eq!(compare(record, &record.replace("\t1000\n", "\t1005\n")), Ok(()));
        assert!(compare(record, &record.replace("\t1000\n", "\t1006\n")).is_err());
        assert!(compare(record, &record.replace("0000\ni", "0001\ni")).is_err());
        assert!(compare(record, "run --seed 1\t1000000000000000\n").is_err());
    }
}
