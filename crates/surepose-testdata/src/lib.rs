//! Location of the recordings for the tests.
//!
//! The recordings are not part of the repository. Tests that need them pass without them, after a printed line.

use std::path::PathBuf;

/// Returns the folder of the recordings: `$SUREPOSE_DATA`, else `../shared/data` beside the workspace.
///
/// Returns `None`, after a printed line, if it is absent.
pub fn recordings() -> Option<PathBuf> {
    existing("")
}

/// Returns the path of a recording, relative to the folder of [`recordings`].
///
/// Returns `None`, after a printed line, if it is absent.
pub fn recording(name: &str) -> Option<PathBuf> {
    existing(name)
}

fn existing(name: &str) -> Option<PathBuf> {
    let beside = || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data"));
    let folder = std::env::var_os("SUREPOSE_DATA").map_or_else(beside, PathBuf::from);
    let path = folder.join(name);
    if path.exists() {
        return Some(path);
    }
    println!("SKIPPED: {} is absent; set SUREPOSE_DATA to the folder of the recordings", path.display());
    None
}
