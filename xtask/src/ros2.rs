//! Interoperability test: the node against rclpy, from wheels on PyPI.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::run::{program as run, target};

/// Python version of the wheels.
const PYTHON: &str = "python3.11";

/// ROS 2 Kilted: middleware, messages, and build dependencies of interfaces.
const WHEELS: [&str; 12] = [
    "ros-rclpy==9.1.2",
    "ros-rmw-fastrtps-cpp==9.3.3",
    "ros-rmw-implementation==3.0.4",
    "ros-rcl-interfaces==2.3.0",
    "ros-geometry-msgs==5.5.1",
    "ros-nav-msgs==5.5.1",
    "ros-sensor-msgs==5.5.1",
    "ros-std-srvs==5.5.1",
    "ros-diagnostic-msgs==5.5.1",
    "ros-visualization-msgs==5.5.1",
    "catkin_pkg==1.1.1",
    "numpy==2.4.6",
];

/// Build script for interfaces without a wheel; optional, relative to the checkout.
const BUILDER: &str = "../shared/ros2/build_interface.py";

/// Interfaces of Nav2's action and of tf2: package and file.
const INTERFACES: [(&str, &str); 2] =
    [("nav2_msgs", "action/NavigateToPose.action"), ("tf2_msgs", "msg/TFMessage.msg")];

/// Runs the rclpy tests with the node and a simulated robot.
pub(crate) fn check(root: &Path) -> Result<(), String> {
    if Command::new(PYTHON).arg("--version").output().is_err() {
        eprintln!("ros2: skipped (needs {PYTHON}, the version of the ROS 2 wheels)");
        return Ok(());
    }
    let folder = root.join("target/ros2");
    let venv = folder.join("venv");
    run(Command::new(PYTHON).arg("-m").arg("venv").arg(&venv))?;
    let python = venv.join("bin/python");
    run(Command::new(&python).args(["-m", "pip", "install", "--quiet"]).args(WHEELS))?;
    // Same build as for the tests; after them, nothing is recompiled.
    crate::run::cargo(root, &["test", "--release", "--workspace", "--test", "ros2", "--no-run"], &[])?;

    let tests = root.join("crates/surepose-ros2/tests/rclpy");
    let mut libraries = vec![venv.join("lib")];
    let mut modules = Vec::new();
    for built in interfaces(root, &python, &tests, &folder)? {
        libraries.push(built.clone());
        modules.push(built);
    }
    let program = target(root).join("release/surepose");
    run(Command::new(&python)
        .arg(tests.join("conversation.py"))
        .arg(program)
        .env("VIRTUAL_ENV", &venv)
        .env("PYTHONPATH", joined(&modules)?)
        .env("LD_LIBRARY_PATH", joined(&libraries)?))
}

/// Builds the interfaces without a wheel for Python, if the build script exists.
fn interfaces(root: &Path, python: &Path, tests: &Path, folder: &Path) -> Result<Vec<PathBuf>, String> {
    let builder = root.join(BUILDER);
    if !builder.exists() {
        eprintln!("ros2: {BUILDER} not found; the action and /tf are not tested");
        return Ok(Vec::new());
    }
    INTERFACES
        .iter()
        .map(|(package, file)| {
            let out = folder.join(package);
            let file = tests.join(package).join(file);
            let mut build = Command::new(python);
            build.arg(tests.join("build.py")).arg(&builder).arg(package).arg(file).arg("--out").arg(&out);
            run(&mut build)?;
            Ok(out)
        })
        .collect()
}

fn joined(paths: &[PathBuf]) -> Result<std::ffi::OsString, String> {
    std::env::join_paths(paths).map_err(|error| error.to_string())
}
