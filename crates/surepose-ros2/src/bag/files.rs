//! Finds the files of a recording: one file, or the parts of a split recording.

use std::path::{Path, PathBuf};

use super::BagError;

/// Files of the recording at `path`, in the order of time.
///
/// `path` is a file, or a folder of rosbag2 with one file or the parts `drive_0.mcap`, `drive_1.mcap` and so on.
///
/// # Errors
/// [`BagError::Unreadable`], and [`BagError::NotOneRecording`] for an ambiguous folder.
pub(super) fn files_of(path: &Path) -> Result<Vec<PathBuf>, BagError> {
    if !path.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let unreadable = |problem| BagError::Unreadable { path: path.to_owned(), problem };
    let found: Vec<PathBuf> = std::fs::read_dir(path)
        .map_err(unreadable)?
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| name_of(path).is_some())
        .collect();
    if found.len() == 1 {
        return Ok(found);
    }
    let count = found.len();
    let mut parts: Vec<_> = found.into_iter().filter_map(|path| Some((part_of(&path)?, path))).collect();
    parts.sort();
    let is_one = parts.windows(2).all(|pair| pair[0].0.0 == pair[1].0.0 && pair[0].0.1 < pair[1].0.1);
    if count == 0 || parts.len() < count || !is_one {
        return Err(BagError::NotOneRecording { count });
    }
    Ok(parts.into_iter().map(|(_, path)| path).collect())
}

/// Name of a recording's file without its extensions, including that of a compression.
fn name_of(path: &Path) -> Option<&str> {
    let name = path.file_name()?.to_str()?;
    let plain = [".zstd", ".zst", ".gz"].iter().find_map(|extension| name.strip_suffix(extension));
    plain.unwrap_or(name).strip_suffix(".mcap")
}

/// Name of the recording and number of the part.
fn part_of(path: &Path) -> Option<(String, u64)> {
    let (name, number) = name_of(path)?.rsplit_once('_')?;
    Some((name.to_owned(), number.parse().ok()?))
}
