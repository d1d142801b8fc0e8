//! Project tasks: `cargo xtask ci`, `cargo xtask tidy`, `cargo xtask instructions`, `cargo xtask
//! microcontroller`, `cargo xtask ros2`, `cargo xtask python`, `cargo xtask long`, `cargo xtask ablation`, `cargo xtask bits`.

mod ablation;
mod bits;
mod instructions;
mod microcontroller;
mod python;
mod ros2;
mod run;
mod tidy;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

const USAGE: &str = "\
cargo xtask ci              run all CI checks: format, lints, tidy, documentation, tests, and the checks below
cargo xtask tidy            check the consistency of documents and code
cargo xtask instructions    check instruction counts against their budgets (needs valgrind on x86-64)
cargo xtask microcontroller check that an emulated Cortex-M4F computes the same bits (needs its target and qemu-system-arm)
cargo xtask ros2            test the node against rclpy of ROS 2 (needs python3.11 and the network)
cargo xtask python          test the Python package and its notebooks (needs Python 3.10 and the network)
cargo xtask long            run the long measurements: every cell of the actuator bench with 150 trials
cargo xtask ablation [NAME] show what each tuned constant of the control law is for: repeat the trials without it
cargo xtask bits            compare the results of two versions of the program: `record` and `compare`";

fn main() -> ExitCode {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("..");
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let outcome = match arguments.first().map(String::as_str) {
        Some("ci") => ci(&root),
        Some("tidy") => tidy::check(&root),
        Some("instructions") => instructions::check(&root),
        Some("microcontroller") => microcontroller::check(&root),
        Some("ros2") => ros2::check(&root),
        Some("python") => python::check(&root),
        Some("long") => long(&root),
        Some("ablation") => ablation::run(&root, &arguments[1..]),
        Some("bits") => bits::run(&root, &arguments[1..]),
        _ => Err(USAGE.to_owned()),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}

/// Runs the measurements that take too long for the gate, which has a reduced version of each.
fn long(root: &Path) -> Result<(), String> {
    run::cargo(root, &["run", "--release", "-p", "surepose-experiments", "--example", "actuators"], &[])
}

/// Runs every check; the first that fails ends the gate.
fn ci(root: &Path) -> Result<(), String> {
    run::cargo(root, &["fmt", "--all", "--check"], &[])?;
    tidy::check(root)?;
    run::cargo(root, &["clippy", "--release", "--workspace", "--all-targets", "--", "-D", "warnings"], &[])?;
    run::cargo(root, &["doc", "--workspace", "--no-deps"], &[("RUSTDOCFLAGS", "-D warnings")])?;
    run::cargo(root, &["check", "--manifest-path", "fuzz/Cargo.toml", "--target-dir", "target/fuzz"], &[])?;
    run::cargo(root, &["test", "--workspace", "--release"], &[])?;
    instructions::check(root)?;
    microcontroller::check(root)?;
    ros2::check(root)?;
    python::check(root)
}
