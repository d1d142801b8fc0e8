//! Where a wall map and its picture go: to where they can be written, and over nothing that is read.

use std::path::{Path, PathBuf};

use crate::error::CliError;
use crate::output_dir::{OutputDir, file_in_folder_at};

/// The endings of its picture, which no map can have.
const ENDINGS: [&str; 2] = ["svg", "png"];

/// A wall map that is to be written, and its picture.
pub(super) struct MapOutput {
    /// The wall map.
    pub(super) map: PathBuf,
    /// The folder of its picture.
    pub(super) pictures: OutputDir,
}

impl MapOutput {
    /// The map, and its picture in the folder `pictures`, or beside it; refused before any work, where it cannot be written, or
    /// would be over one of `inputs`.
    pub(super) fn new(map: PathBuf, pictures: Option<PathBuf>, inputs: &[&Path]) -> Result<Self, CliError> {
        no_picture(&map)?;
        let beside = || map.with_file_name("");
        let pictures = pictures.unwrap_or_else(beside);
        let written = pictures_of(&map, &pictures).into_iter().chain([map.clone()]);
        keep(inputs, written, "give --out another name, or --picture another folder")?;
        file_in_folder_at(&map)?;
        Ok(Self { pictures: OutputDir::at(&pictures)?, map })
    }
}

/// Fails where the map would have the name of a picture.
fn no_picture(map: &Path) -> Result<(), CliError> {
    let ending = map.extension().unwrap_or_default();
    if !ENDINGS.iter().any(|picture| ending.eq_ignore_ascii_case(picture)) {
        return Ok(());
    }
    let what = format!("{}: a wall map is text, and its picture has this ending", map.display());
    Err(CliError::Usage { what, help: "give --out a name that ends in .toml".to_owned() })
}

/// The files of a map's picture in a folder.
pub(super) fn pictures_of(map: &Path, folder: &Path) -> [PathBuf; 2] {
    ENDINGS.map(|ending| folder.join(format!("{}.{ending}", name_of(map))))
}

/// What a map's picture is called.
pub(super) fn name_of(map: &Path) -> String {
    map.file_stem().map_or_else(|| "map".to_owned(), |name| name.to_string_lossy().into_owned())
}

/// Fails where one of `inputs` would be `written` over, by whatever name; `help` says what would be right.
pub(super) fn keep(
    inputs: &[&Path],
    written: impl IntoIterator<Item = PathBuf>,
    help: &str,
) -> Result<(), CliError> {
    // What is not there yet has no such path, and is no input.
    let read: Vec<_> = inputs.iter().filter_map(|input| std::fs::canonicalize(input).ok()).collect();
    let is_read = |path: &PathBuf| std::fs::canonicalize(path).is_ok_and(|path| read.contains(&path));
    written.into_iter().find(is_read).map_or(Ok(()), |path| {
        let what = format!("{}: it is read, and would be written over", path.display());
        Err(CliError::Usage { what, help: help.to_owned() })
    })
}
