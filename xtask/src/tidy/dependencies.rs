//! Dependencies point inward: each crate may depend on the crates that this table gives it, and on no other of ours.

use std::path::Path;

/// Each crate with its folder and the crates that it may depend on, all of which stand above it.
const CRATES: [(&str, &str, &[&str]); 16] = [
    ("surepose-testdata", "crates/surepose-testdata", &[]),
    ("surepose", "crates/surepose", &[]),
    ("surepose-config", "crates/surepose-config", &["surepose"]),
    ("surepose-io", "crates/surepose-io", &["surepose"]),
    ("surepose-recorder", "crates/surepose-recorder", &["surepose", "surepose-config", "surepose-io"]),
    ("surepose-simd", "crates/surepose-simd", &["surepose"]),
    ("surepose-cert", "crates/surepose-cert", &["surepose"]),
    ("surepose-sim", "crates/surepose-sim", &["surepose", "surepose-config", "surepose-io"]),
    (
        "surepose-mapping",
        "crates/surepose-mapping",
        &["surepose", "surepose-config", "surepose-io", "surepose-sim"],
    ),
    (
        "surepose-replay",
        "crates/surepose-replay",
        &["surepose", "surepose-config", "surepose-io", "surepose-sim", "surepose-mapping"],
    ),
    ("surepose-montecarlo", "crates/surepose-montecarlo", &["surepose", "surepose-sim", "surepose-simd"]),
    (
        "surepose-figures",
        "crates/surepose-figures",
        &[
            "surepose",
            "surepose-io",
            "surepose-cert",
            "surepose-sim",
            "surepose-mapping",
            "surepose-replay",
            "surepose-montecarlo",
        ],
    ),
    (
        "surepose-experiments",
        "experiments",
        &[
            "surepose",
            "surepose-config",
            "surepose-io",
            "surepose-sim",
            "surepose-mapping",
            "surepose-montecarlo",
            "surepose-figures",
        ],
    ),
    (
        "surepose-ros2",
        "crates/surepose-ros2",
        &[
            "surepose",
            "surepose-config",
            "surepose-io",
            "surepose-recorder",
            "surepose-sim",
            "surepose-mapping",
            "surepose-replay",
        ],
    ),
    (
        "surepose-cli",
        "crates/surepose-cli",
        &[
            "surepose",
            "surepose-config",
            "surepose-io",
            "surepose-recorder",
            "surepose-cert",
            "surepose-sim",
            "surepose-mapping",
            "surepose-replay",
            "surepose-montecarlo",
            "surepose-figures",
            "surepose-experiments",
            "surepose-ros2",
        ],
    ),
    (
        "surepose-py",
        "crates/surepose-py",
        &[
            "surepose",
            "surepose-config",
            "surepose-io",
            "surepose-sim",
            "surepose-montecarlo",
            "surepose-cli",
        ],
    ),
];

/// All that the core may depend on.
const CORE_DEPENDENCIES: [&str; 1] = ["libm"];

/// Crates that plot, sweep or prove: no dependency of the ROS 2 node, direct or indirect.
const NOT_IN_ROS2: [&str; 5] =
    ["surepose-simd", "surepose-cert", "surepose-montecarlo", "surepose-figures", "surepose-experiments"];

pub(super) fn check(root: &Path, findings: &mut Vec<String>) -> Result<(), String> {
    for entry in std::fs::read_dir(root.join("crates")).map_err(|e| e.to_string())?.filter_map(Result::ok) {
        let name = entry.file_name().to_string_lossy().into_owned();
        if !CRATES.iter().any(|(known, ..)| *known == name) {
            findings.push(format!("crates/{name}: give it a place in xtask/src/tidy/dependencies.rs"));
        }
    }
    for (position, (name, folder, allowed)) in CRATES.iter().enumerate() {
        check_order(position, findings);
        if !root.join(folder).join("README.md").exists() {
            findings.push(format!("{folder}: README.md is missing"));
        }
        let path = root.join(folder).join("Cargo.toml");
        let text = std::fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
        let manifest: toml::Table = text.parse().map_err(|e| format!("{}: {e}", path.display()))?;
        let dependencies = manifest.get("dependencies").and_then(toml::Value::as_table);
        for dependency in dependencies.into_iter().flat_map(toml::Table::keys).map(String::as_str) {
            if dependency.starts_with("surepose") && !allowed.contains(&dependency) {
                findings
                    .push(format!("{folder}: must not depend on {dependency}; see the table of the check"));
            }
            if *name == "surepose" && !CORE_DEPENDENCIES.contains(&dependency) {
                findings.push(format!("{folder}: the core must not depend on {dependency}"));
            }
        }
    }
    for excluded in NOT_IN_ROS2 {
        if reaches("surepose-ros2", excluded) {
            findings.push(format!("crates/surepose-ros2: {excluded} must not be among its dependencies"));
        }
    }
    Ok(())
}

/// A crate of the table may only depend on those above it: so no circle is possible.
fn check_order(position: usize, findings: &mut Vec<String>) {
    let (name, _, allowed) = CRATES[position];
    let above: Vec<_> = CRATES[..position].iter().map(|(name, ..)| *name).collect();
    for dependency in allowed.iter().filter(|dependency| !above.contains(dependency)) {
        findings.push(format!("xtask/src/tidy/dependencies.rs: {name} stands above {dependency}"));
    }
}

/// Whether `target` is among the dependencies that the table allows `name`, direct or indirect.
fn reaches(name: &str, target: &str) -> bool {
    let row = CRATES.iter().find(|(known, ..)| *known == name);
    row.is_some_and(|(.., allowed)| allowed.iter().any(|next| *next == target || reaches(next, target)))
}
