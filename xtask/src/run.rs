//! Subprocesses, and the sequence of CI checks.

use std::path::Path;
use std::process::Command;

/// Runs cargo at the root and passes on what it prints.
pub(crate) fn cargo(root: &Path, arguments: &[&str], environment: &[(&str, &str)]) -> Result<(), String> {
    eprintln!("== cargo {}", arguments.join(" "));
    let mut command = Command::new(env!("CARGO"));
    command.current_dir(root).args(arguments).envs(environment.iter().copied());
    let status = command.status().map_err(|error| format!("cargo: start failed: {error}"))?;
    if status.success() { Ok(()) } else { Err(format!("cargo {}: failed", arguments.join(" "))) }
}
