//! Instruction counts of the hot paths, which are reproducible, unlike execution times.

use std::path::Path;
use std::process::Command;

/// Operations of the benchmark `instructions` per package, with their budgets for f64 on x86-64-v3.
///
/// The budgets are 5 % above the counts reached; hand-written C++ with Eigen takes 450 for `law` and 2355 for `cycle`. Those of
/// `extract181` and `extract361` are a thirtieth of the count of a widely used ROS package.
const BUDGETS: [(&str, &[(&str, u64)]); 2] = [
    (
        "surepose",
        &[
            ("law", 262),
            ("predict", 417),
            ("compass", 154),
            ("wall", 310),
            ("cycle", 1612),
            ("delayed", 7_344),
            ("considered", 15_986),
            ("step", 670),
        ],
    ),
    ("surepose-sim", &[("extract181", 75_000), ("extract361", 150_000), ("match181", 11_340)]),
];

/// Instruction count of one operation.
pub(crate) struct Measured {
    /// Name of the operation.
    pub(crate) work: &'static str,
    /// Instructions per execution.
    pub(crate) count: u64,
    budget: u64,
}

/// Measures all operations and compares them with their budgets.
pub(crate) fn check(root: &Path) -> Result<(), String> {
    let mut over = Vec::new();
    for Measured { work, count, budget } in measure(root)?.unwrap_or_default() {
        println!("{work:>10} {count:>6} instructions, budget {budget}");
        if count > budget {
            over.push(work);
        }
    }
    if over.is_empty() { Ok(()) } else { Err(format!("instructions: over budget: {}", over.join(", "))) }
}

/// Measures all operations. `None`: no valgrind, or another processor.
pub(crate) fn measure(root: &Path) -> Result<Option<Vec<Measured>>, String> {
    if cfg!(not(target_arch = "x86_64")) || Command::new("valgrind").arg("--version").output().is_err() {
        eprintln!("instructions: skipped (needs valgrind on x86-64)");
        return Ok(None);
    }
    let mut measured = Vec::new();
    for (package, budgets) in BUDGETS {
        let target = root.join("target/x86-64-v3").join(package);
        let flags = [("RUSTFLAGS", "-C target-cpu=x86-64-v3")];
        let program = crate::run::build_bench(root, package, "instructions", &target, &flags)?;
        for &(work, budget) in budgets {
            // The difference of two run lengths excludes start-up; 600 scans are one lap of the loop world.
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
        .map_err(|error| format!("valgrind: start failed: {error}"))?;
    let text = String::from_utf8_lossy(&output.stderr);
    // Valgrind does not support every instruction; a failed run would give too low a count.
    if !output.status.success() {
        return Err(format!("{work}: failed under valgrind:\n{text}"));
    }
    text.lines()
        .filter_map(|line| line.split_once("Collected :"))
        .find_map(|(_, count)| count.trim().parse().ok())
        .ok_or_else(|| format!("{work}: no instruction count in valgrind's output:\n{text}"))
}
