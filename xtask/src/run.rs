//! Subprocesses, and the sequence of CI checks.

use std::path::Path;
use std::process::Command;

/// Runs all CI checks, cheapest first.
pub(crate) fn ci(root: &Path) -> Result<(), String> {
    cargo(root, &["fmt", "--all", "--check"], &[])?;
    crate::tidy::check(root)?;
    cargo(root, &["clippy", "--release", "--workspace", "--all-targets", "--", "-D", "warnings"], &[])?;
    cargo(root, &["doc", "--workspace", "--no-deps"], &[("RUSTDOCFLAGS", "-D warnings")])?;
    cargo(root, &["check", "--manifest-path", "fuzz/Cargo.toml", "--target-dir", "target/fuzz"], &[])?;
    cargo(root, &["test", "--workspace", "--release"], &[])?;
    crate::instructions::check(root)?;
    crate::microcontroller::check(root)?;
    crate::ros2::check(root)
}

/// Runs cargo in the root folder with inherited output.
pub(crate) fn cargo(root: &Path, arguments: &[&str], environment: &[(&str, &str)]) -> Result<(), String> {
    eprintln!("== cargo {}", arguments.join(" "));
    let mut command = Command::new(env!("CARGO"));
    command.current_dir(root).args(arguments).envs(environment.iter().copied());
    let status = command.status().map_err(|error| format!("cargo: start failed: {error}"))?;
    if status.success() { Ok(()) } else { Err(format!("cargo {}: failed", arguments.join(" "))) }
}
