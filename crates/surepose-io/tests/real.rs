//! Compares the parsers on recordings of real robots with figures computed independently with numpy.
//!
//! The recordings are not part of this repository. The tests read them from `$SUREPOSE_DATA`, else from
//! `../shared/data` beside the workspace, and print a message if they are absent.

mod real {
    mod carmen;
    mod cmu_wean;
    mod maps;
    mod mines_rover;
    mod mrclam;
}

use std::path::PathBuf;

use surepose_io::recording::StampedPose;

/// Returns the path of a recording; `None`, with a message, if it is absent.
fn recording(name: &str) -> Option<PathBuf> {
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

/// Returns the length of the path through `poses` \[m\].
fn path_length(poses: &[StampedPose]) -> f64 {
    poses.windows(2).map(|pair| (pair[1].x - pair[0].x).hypot(pair[1].y - pair[0].y)).sum()
}
