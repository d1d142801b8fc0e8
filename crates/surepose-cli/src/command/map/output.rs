//! Output paths of a wall map and its plot: checked to be writable and not to overwrite an input.

use std::path::{Path, PathBuf};

use crate::error::CliError;
use crate::output_dir::{OutputDir, file_in_folder_at};

/// File extensions of the plot, which a map may not have.
const ENDINGS: [&str; 2] = ["svg", "png"];

/// The output paths of a wall map and its plot.
pub(super) struct MapOutput {
    /// The file of the wall map.
    pub(super) map: PathBuf,
    /// The directory of the plot.
    pub(super) pictures: OutputDir,
}

impl MapOutput {
    /// Checks the output paths: the map at `map`, the plot in `pictures` (`None`: the directory of the map).
    ///
    /// # Errors
    /// Usage error if a file is not writable or would overwrite one of `inputs`.
    pub(super) fn new(map: PathBuf, pictures: Option<PathBuf>, inputs: &[&Path]) -> Result<Self, CliError> {
        no_picture(&map)?;
        let beside = || map.with_file_name("");
        let pictures = pictures.unwrap_or_else(beside);
        let written = pictures_of(&map, &pictures).into_iter().chain([map.clone()]);
        keep(inputs, written, "give --out another name, or --picture another directory")?;
        file_in_folder_at(&map)?;
        Ok(Self { pictures: OutputDir::at(&pictures)?, map })
    }
}

/// Rejects a map path with the file extension of a plot.
fn no_picture(map: &Path) -> Result<(), CliError> {
    let ending = map.extension().unwrap_or_default();
    if !ENDINGS.iter().any(|picture| ending.eq_ignore_ascii_case(picture)) {
        return Ok(());
    }
    let what =
        format!("{}: not a valid name for a wall map, because its plot has this extension", map.display());
    Err(CliError::Usage { what, help: "give --out a name that ends in .toml".to_owned() })
}

/// Returns the files of the plot in a directory.
pub(super) fn pictures_of(map: &Path, folder: &Path) -> [PathBuf; 2] {
    ENDINGS.map(|ending| folder.join(format!("{}.{ending}", name_of(map))))
}

/// Returns the name of the plot, without extension.
pub(super) fn name_of(map: &Path) -> String {
    map.file_stem().map_or_else(|| "map".to_owned(), |name| name.to_string_lossy().into_owned())
}

/// Rejects output paths that would overwrite one of `inputs`, also through links; `help` is the remedy in the error.
pub(super) fn keep(
    inputs: &[&Path],
    written: impl IntoIterator<Item = PathBuf>,
    help: &str,
) -> Result<(), CliError> {
    // A file that does not exist yet has no canonical path and is no input.
    let read: Vec<_> = inputs.iter().filter_map(|input| std::fs::canonicalize(input).ok()).collect();
    let is_read = |path: &PathBuf| std::fs::canonicalize(path).is_ok_and(|path| read.contains(&path));
    written.into_iter().find(is_read).map_or(Ok(()), |path| {
        let what = format!("{}: an input file would be overwritten", path.display());
        Err(CliError::Usage { what, help: help.to_owned() })
    })
}
