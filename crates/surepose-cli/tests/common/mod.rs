//! Runs the program and creates input files.

#![allow(dead_code, reason = "each test file uses its own part")]
#![allow(clippy::expect_used, reason = "a failed precondition fails the test")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Exit code and output of the program.
pub(crate) struct Run {
    pub(crate) code: i32,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Run {
    /// Parses the one JSON object on standard output.
    pub(crate) fn json(&self) -> serde_json::Value {
        let value: serde_json::Value = serde_json::from_str(&self.stdout).expect("one JSON value");
        assert!(value.is_object(), "{value}");
        assert!(!self.stdout.contains("NaN"), "{value}");
        value
    }
}

/// Runs `surepose` with these arguments.
pub(crate) fn surepose(arguments: &[&str]) -> Run {
    let output: Output = Command::new(env!("CARGO_BIN_EXE_surepose"))
        .args(arguments)
        .env("NO_COLOR", "1")
        .output()
        .expect("the program starts");
    let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
    let run = Run {
        code: output.status.code().expect("the program ends by itself"),
        stdout: text(output.stdout),
        stderr: text(output.stderr),
    };
    assert!(!run.stderr.contains("panicked"), "{arguments:?}: {}", run.stderr);
    run
}

/// Runs `surepose` with standard output redirected to `device`; returns exit code and standard error.
pub(crate) fn surepose_into(device: &str, arguments: &[&str]) -> (i32, String) {
    let device = std::fs::OpenOptions::new().write(true).open(device).expect("the device is there");
    let output = Command::new(env!("CARGO_BIN_EXE_surepose"))
        .args(arguments)
        .env("NO_COLOR", "1")
        .stdout(device)
        .output()
        .expect("the program starts");
    let stderr = String::from_utf8(output.stderr).expect("UTF-8");
    (output.status.code().expect("the program ends by itself"), stderr)
}

/// Creates an empty directory for one test.
pub(crate) fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("the target folder can be written to");
    folder
}

/// Writes a file and returns its path.
pub(crate) fn file(folder: &Path, name: &str, bytes: &[u8]) -> String {
    let path = folder.join(name);
    std::fs::write(&path, bytes).expect("the folder can be written to");
    path.to_str().expect("UTF-8").to_owned()
}

/// Returns a recording of the mines rover turning in place in a 4 × 3 m room: `lines` lines, `step_us` apart.
pub(crate) fn rover(lines: u32, step_us: u32) -> Vec<u8> {
    use std::f64::consts::TAU;
    use std::fmt::Write as _;
    let (turn_rate, ahead, rim) = (0.3, 0.145, 0.33 / 2.0 / 0.077 * 2000.0 / TAU);
    let mut text = String::new();
    for line in 0..lines {
        let heading = turn_rate * f64::from(line) * 0.1;
        let ticks = (rim * heading).round();
        let _ = write!(text, "{} 0 {} {ticks}{}", line * step_us, -ticks, " 0".repeat(20));
        let (y, x) = heading.sin_cos();
        for beam in 0..682 {
            let (sin, cos) = (heading + (44.0 + f64::from(beam) - 384.0) * TAU / 1024.0).sin_cos();
            let to_wall =
                |at: f64, along: f64, wall: f64| (wall - at * along.signum()) / along.abs().max(1e-9);
            let range = to_wall(ahead * x, cos, 2.0).min(to_wall(ahead * y, sin, 1.5));
            let _ = write!(text, " {:.0}", 1e3 * range);
        }
        text.push('\n');
    }
    text.into_bytes()
}
