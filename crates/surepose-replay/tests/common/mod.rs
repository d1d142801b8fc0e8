//! Location of the recordings.

use std::path::PathBuf;

/// Returns the path of a recording; `None`, with a printed line, if it is absent.
pub(crate) fn recording(name: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("SUREPOSE_DATA").map_or_else(
        || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data")),
        PathBuf::from,
    );
    let path = folder.join(name);
    if path.exists() {
        return Some(path);
    }
    println!("SKIPPED: {name} is not in {}; set SUREPOSE_DATA to the folder that has it", folder.display());
    None
}
