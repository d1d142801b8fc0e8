//! Check that dependencies point inward: cli, ros2 → lab → sim, data, cert → surepose.

use std::path::Path;

/// Layer of each crate; a crate may depend on crates of lower layers only.
const RINGS: [(&str, u8); 10] = [
    ("surepose", 0),
    ("surepose-sim", 1),
    ("surepose-data", 1),
    ("surepose-cert", 1),
    ("surepose-lanes", 1),
    ("surepose-plot", 1),
    ("surepose-lab", 2),
    ("surepose-ros2", 3),
    ("surepose-cli", 4),
    ("xtask", 5),
];

/// Permitted dependencies of the core.
const CORE_NEEDS: [&str; 1] = ["libm"];

pub(super) fn check(root: &Path, findings: &mut Vec<String>) -> Result<(), String> {
    for entry in std::fs::read_dir(root.join("crates")).map_err(|e| e.to_string())?.filter_map(Result::ok) {
        let name = entry.file_name().to_string_lossy().into_owned();
        let path = entry.path().join("Cargo.toml");
        let text = std::fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
        let manifest: toml::Table = text.parse().map_err(|e| format!("{}: {e}", path.display()))?;
        let Some(ring) = ring(&name) else {
            findings
                .push(format!("crates/{name}: no layer; add the crate to xtask/src/tidy/dependencies.rs"));
            continue;
        };
        let dependencies = manifest.get("dependencies").and_then(toml::Value::as_table);
        for needed in dependencies.into_iter().flat_map(toml::Table::keys) {
            if self::ring(needed).is_some_and(|inner| inner >= ring) {
                findings.push(format!(
                    "crates/{name}: must not depend on {needed}, which is not in a lower layer"
                ));
            }
            if name == "surepose" && !CORE_NEEDS.contains(&needed.as_str()) {
                findings.push(format!("crates/surepose: the core must not depend on {needed}"));
            }
        }
    }
    Ok(())
}

fn ring(name: &str) -> Option<u8> {
    RINGS.iter().find(|(known, _)| *known == name).map(|(_, ring)| *ring)
}
