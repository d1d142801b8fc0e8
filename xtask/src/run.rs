//! Subprocesses, and the sequence of CI checks.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Runs cargo at the root and passes on what it prints.
pub(crate) fn cargo(root: &Path, arguments: &[&str], environment: &[(&str, &str)]) -> Result<(), String> {
    eprintln!("== cargo {}", arguments.join(" "));
    let mut command = Command::new(env!("CARGO"));
    command.current_dir(root).args(arguments).envs(environment.iter().copied());
    let status = command.status().map_err(|error| format!("cargo: start failed: {error}"))?;
    if status.success() { Ok(()) } else { Err(format!("cargo {}: failed", arguments.join(" "))) }
}

/// Runs a program and passes on what it prints.
pub(crate) fn program(command: &mut Command) -> Result<(), String> {
    let name = format!("{command:?}");
    let status = command.status().map_err(|error| format!("{name}: start failed: {error}"))?;
    if status.success() { Ok(()) } else { Err(format!("{name}: failed")) }
}

/// Folder of the compiled files.
pub(crate) fn target(root: &Path) -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from)
}

/// Builds the benchmark `name` of `package` in release mode; returns the path of the program.
pub(crate) fn build_bench(
    root: &Path,
    package: &str,
    name: &str,
    target: &Path,
    environment: &[(&str, &str)],
) -> Result<PathBuf, String> {
    eprintln!("== cargo build --release -p {package} --bench {name}");
    let output = Command::new(env!("CARGO"))
        .current_dir(root)
        .args(["build", "--release", "-p", package, "--bench", name])
        .args(["--message-format", "json-render-diagnostics", "--target-dir"])
        .arg(target)
        .envs(environment.iter().copied())
        .stderr(Stdio::inherit())
        .output()
        .map_err(|error| format!("cargo: start failed: {error}"))?;
    let text = String::from_utf8_lossy(&output.stdout);
    // The file name has a hash, which only this message contains. Paths with quotes or backslashes are not supported.
    let path = text.lines().filter_map(|line| line.split_once("\"executable\":\"")).next_back();
    match path.and_then(|(_, rest)| rest.split_once('"')) {
        Some((path, _)) if output.status.success() => Ok(PathBuf::from(path)),
        _ => Err(format!("cargo build -p {package} --bench {name}: failed")),
    }
}
