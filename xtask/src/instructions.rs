//! How many instructions the hot paths take: steady where times are not.

use std::path::Path;
use std::process::Command;

/// Work of the example `instructions` of a package, and the most instructions it may take in f64 on x86-64-v3.
///
/// The budgets of `law` and `cycle` are those of hand-written C++ with Eigen, those of `extract181` and `extract361` a
/// thirtieth of what a widely used ROS package takes; the others hold what was reached.
const BUDGETS: [(&str, &[(&str, u64)]); 2] = [
    (
        "surepose",
        &[("law", 450), ("predict", 500), ("compass", 220), ("wall", 420), ("cycle", 2355), ("step", 800)],
    ),
    ("surepose-sim", &[("extract181", 75_000), ("extract361", 150_000), ("match181", 30_000)]),
];

/// Instructions that one work takes.
pub(crate) struct Measured {
    /// Name of the work.
    pub(crate) work: &'static str,
    /// Instructions of one execution.
    pub(crate) count: u64,
    budget: u64,
}

/// Measures every work and fails where one is over its budget.
pub(crate) fn check(root: &Path) -> Result<(), String> {
    let mut over = Vec::new();
    for Measured { work, count, budget } in measure(root)?.unwrap_or_default() {
        println!("{work:>10} {count:>6} instructions, budget {budget}");
        if count > budget {
            over.push(work);
        }
    }
    if over.is_empty() { Ok(()) } else { Err(format!("over budget: {}", over.join(", "))) }
}

/// Measures every work; `None` without valgrind or on another processor.
pub(crate) fn measure(root: &Path) -> Result<Option<Vec<Measured>>, String> {
    if cfg!(not(target_arch = "x86_64")) || Command::new("valgrind").arg("--version").output().is_err() {
        eprintln!("instructions: skipped, this needs valgrind on x86-64");
        return Ok(None);
    }
    let mut measured = Vec::new();
    for (package, budgets) in BUDGETS {
        // A target directory each: the two examples have one name.
        let target = root.join("target/x86-64-v3").join(package);
        let build = ["build", "--release", "-p", package, "--example", "instructions", "--target-dir"];
        let arguments: Vec<&str> = build.into_iter().chain(target.to_str()).collect();
        crate::run::cargo(root, &arguments, &[("RUSTFLAGS", "-C target-cpu=x86-64-v3")])?;
        let program = target.join("release/examples/instructions");
        for &(work, budget) in budgets {
            // The difference of two lengths leaves start-up out; 600 scans are one round of the loop world.
            let (short, long) = (count(&program, work, 600)?, count(&program, work, 1800)?);
            measured.push(Measured { work, count: long.saturating_sub(short) / 1200, budget });
        }
    }
    Ok(Some(measured))
}

fn count(program: &Path, work: &str, times: u32) -> Result<u64, String> {
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(program)
        .args([work, &times.to_string()])
        .output()
        .map_err(|error| format!("valgrind does not start: {error}"))?;
    let text = String::from_utf8_lossy(&output.stderr);
    // Valgrind does not know every instruction; what it gave up on would otherwise count as free.
    if !output.status.success() {
        return Err(format!("{work} does not end well under valgrind:\n{text}"));
    }
    text.lines()
        .filter_map(|line| line.split_once("Collected :"))
        .find_map(|(_, count)| count.trim().parse().ok())
        .ok_or_else(|| format!("valgrind gives no count for {work}:\n{text}"))
}
