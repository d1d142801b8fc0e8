//! The Python package: built, installed, tested, its types checked and its notebooks executed.

use std::path::{Path, PathBuf};
use std::process::Command;

/// Interpreters that can run the package, the preferred one first.
const INTERPRETERS: [&str; 4] = ["python3.11", "python3.12", "python3.13", "python3"];

/// Packages of the tests.
const PACKAGES: [&str; 10] =
    ["pip", "maturin", "pytest", "mypy", "numpy", "pandas", "matplotlib", "ray", "nbconvert", "ipykernel"];

/// Oldest Python of the package.
const OLDEST: &str = "import sys; sys.exit(sys.version_info < (3, 10))";

/// Installs the package into an environment of its own and runs its checks.
pub(crate) fn check(root: &Path) -> Result<(), String> {
    let is_usable = |name: &&&str| {
        let asked = Command::new(name).args(["-c", OLDEST]).status();
        asked.is_ok_and(|status| status.success())
    };
    let Some(interpreter) = INTERPRETERS.iter().find(is_usable) else {
        eprintln!("python: skipped (needs Python 3.10 or later)");
        return Ok(());
    };
    let target = crate::run::target(root);
    let venv = root.join("target/python/venv");
    crate::run::program(Command::new(interpreter).args(["-m", "venv"]).arg(&venv))?;
    let python = venv.join("bin/python");
    let pip = |arguments: &[&str]| {
        let mut command = Command::new(&python);
        command.args(["-m", "pip", "install", "--quiet", "--upgrade"]).args(arguments).current_dir(root);
        // The compiled libraries of the other checks are used again.
        crate::run::program(command.env("CARGO_TARGET_DIR", &target))
    };
    pip(&PACKAGES)?;
    pip(&["--force-reinstall", "--no-deps", "."])?;
    crate::run::cargo(root, &["build", "--release"], &[])?;

    let package = root.join("crates/surepose-py");
    crate::run::program(
        Command::new(&python)
            .args(["-m", "pytest", "--quiet", "-W", "ignore"])
            .args([package.join("tests"), package.join("README.md")])
            .env("SUREPOSE_PROGRAM", target.join("release/surepose"))
            .current_dir(root),
    )?;
    crate::run::program(
        Command::new(&python)
            .args(["-m", "mypy", "--strict"])
            .args([package.join("python/surepose"), package.join("tests")])
            .current_dir(root),
    )?;
    crate::run::program(
        Command::new(&python)
            .args([
                "-m",
                "nbconvert",
                "--to",
                "notebook",
                "--execute",
                "--log-level",
                "ERROR",
                "--output-dir",
            ])
            .arg(root.join("target/python/notebooks"))
            .args(notebooks(root)?),
    )
}

fn notebooks(root: &Path) -> Result<Vec<PathBuf>, String> {
    let folder = root.join("notebooks");
    let entries = std::fs::read_dir(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let mut found: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    found.retain(|path| path.extension().is_some_and(|extension| extension == "ipynb"));
    found.sort();
    Ok(found)
}
