//! Writes output files, each complete or not at all.

use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde_json::{Map, Value};
use surepose_figures::{Picture, PlotError};

use crate::error::{CliError, OutputKind};
use crate::parquet;

/// Keys that depend on the machine and the load.
const TIMING: [&str; 2] = ["wall_s", "steps_per_s"];

/// An existing, writable directory.
#[derive(Clone, Debug)]
pub(crate) struct OutputDir(PathBuf);

impl OutputDir {
    /// Creates the directory at `path` if it is absent, and checks that it is writable.
    ///
    /// Commands call this before the computation, so that no result is lost.
    pub(crate) fn at(path: &Path) -> Result<Self, CliError> {
        // The parent of a bare file name is the empty path: the current directory.
        let path = if path.as_os_str().is_empty() { Path::new(".") } else { path };
        let ready = std::fs::create_dir_all(path).and_then(|()| try_out(&path.join(trial_name())));
        ready.map_err(|problem| failed(path, problem.into()))?;
        Ok(Self(path.to_owned()))
    }

    /// Writes `name.svg` and `name.png`.
    pub(crate) fn picture(&self, name: &str, picture: &Picture) -> Result<(), CliError> {
        self.whole(&format!("{name}.svg"), |path| Ok(std::fs::write(path, picture.svg())?))?;
        self.whole(&format!("{name}.png"), |path| Ok(std::fs::write(path, picture.png()?)?))
    }

    /// Writes a CSV table with one line per row and the names of the fields as header.
    pub(crate) fn table<T: Serialize>(
        &self,
        name: &str,
        rows: impl IntoIterator<Item = T>,
    ) -> Result<(), CliError> {
        let write = |path: &Path| -> csv::Result<()> {
            let mut writer = csv::Writer::from_path(path)?;
            for row in rows {
                writer.serialize(row)?;
            }
            Ok(writer.flush()?)
        };
        self.whole(name, |path| Ok(write(path).map_err(std::io::Error::from)?))
    }

    /// Writes a table as Apache Parquet; writes no file if there are no rows.
    pub(crate) fn parquet<T: Serialize>(
        &self,
        name: &str,
        rows: impl IntoIterator<Item = T>,
    ) -> Result<(), CliError> {
        let mut rows = rows.into_iter().peekable();
        if rows.peek().is_none() {
            // The columns are those of the first row.
            return Ok(());
        }
        self.whole(name, |path| Ok(parquet::write(path, rows).map_err(std::io::Error::other)?))
    }

    /// Writes `summary.json`, without the keys in [`TIMING`], so that the same command line gives the same bytes.
    pub(crate) fn summary(&self, found: &Map<String, Value>) -> Result<(), CliError> {
        let lasting = found.iter().filter(|(key, _)| !TIMING.contains(&key.as_str()));
        let lasting = lasting.map(|(key, value)| (key.clone(), value.clone())).collect();
        self.text("summary.json", &format!("{:#}\n", Value::Object(lasting)))
    }

    /// Writes a text file.
    pub(crate) fn text(&self, name: &str, text: &str) -> Result<(), CliError> {
        self.text_of(name, Ok(text.to_owned()))
    }

    /// Writes a text file, or returns the error of its creation.
    pub(crate) fn text_of(&self, name: &str, text: std::io::Result<String>) -> Result<(), CliError> {
        self.whole(name, |path| Ok(std::fs::write(path, text?)?))
    }

    /// Writes a file of this name with `write`, complete or not at all.
    fn whole(&self, name: &str, write: impl FnOnce(&Path) -> Result<(), PlotError>) -> Result<(), CliError> {
        let path = self.0.join(name);
        whole(&path, write).map_err(|problem| failed(&path, problem))
    }
}

/// Checks that a file can be created at `path`; its directory must exist.
pub(crate) fn file_at(path: &Path) -> Result<(), CliError> {
    begin(path).map_err(|problem| no_file(path, problem))
}

/// Like [`file_at`], but creates the directory if it is absent.
pub(crate) fn file_in_folder_at(path: &Path) -> Result<(), CliError> {
    let folder = path.parent().map_or(Ok(()), std::fs::create_dir_all);
    folder.map_err(|problem| no_file(path, problem))?;
    file_at(path)
}

/// Writes a text file at a path from the command line.
pub(crate) fn write_file(path: &Path, text: &str) -> Result<(), CliError> {
    let write = |path: &Path| std::fs::write(path, text);
    whole(path, write).map_err(|problem| no_file(path, problem))
}

/// Writes a file under a temporary name and renames it when it is complete.
///
/// After a failure, for example a full disk, the previous file remains unchanged.
fn whole<E: From<std::io::Error>>(path: &Path, write: impl FnOnce(&Path) -> Result<(), E>) -> Result<(), E> {
    match way(path) {
        Way::Straight(path) => write(&path),
        Way::Renamed { part, path } => {
            let (_lock, part) = locked(&part)?;
            write(&part).and_then(|()| Ok(std::fs::rename(&part, path)?)).inspect_err(|_| {
                drop(std::fs::remove_file(&part));
            })
        }
    }
}

/// Creates the temporary file `part` and locks it, or the first of `part-1`, `part-2`, … that no other run has locked.
///
/// The leftover of a run that was killed has no lock, and is used again.
fn locked(part: &Path) -> std::io::Result<(File, PathBuf)> {
    let mut number = 0;
    loop {
        let mut name = part.as_os_str().to_owned();
        if number > 0 {
            name.push(format!("-{number}"));
        }
        let name = PathBuf::from(name);
        let file = File::options().create(true).truncate(false).write(true).open(&name)?;
        match file.try_lock() {
            // The other run may have renamed its file between the two calls: then the lock is that of another name.
            Ok(()) if is_at(&file, &name) => return Ok((file, name)),
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => number += 1,
            // A file system without locks.
            Err(TryLockError::Error(_)) => return Ok((file, name)),
        }
    }
}

/// Whether `path` names the open `file`.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let identity = |found: std::fs::Metadata| (found.dev(), found.ino());
    match (file.metadata(), std::fs::metadata(path)) {
        (Ok(file), Ok(path)) => identity(file) == identity(path),
        _ => false,
    }
}

/// Whether `path` names the open `file`; open files are not renamed here.
#[cfg(not(unix))]
fn is_at(_: &File, _: &Path) -> bool {
    true
}

/// Returns a file name that is unique to this process.
fn trial_name() -> String {
    format!("surepose-{}.part", std::process::id())
}

/// Checks that [`whole`] could write this file, and leaves nothing behind.
fn begin(path: &Path) -> std::io::Result<()> {
    match way(path) {
        // Opening a pipe would block until its other end is opened.
        Way::Straight(path) if path.is_file() => open(&path),
        Way::Straight(path) if path.is_dir() => Err(std::io::ErrorKind::IsADirectory.into()),
        Way::Straight(_) => Ok(()),
        Way::Renamed { part, .. } => try_out(&part),
    }
}

/// Creates and removes a file; a leftover of another run is only opened.
fn try_out(part: &Path) -> std::io::Result<()> {
    match File::create_new(part) {
        Err(problem) if problem.kind() == std::io::ErrorKind::AlreadyExists => open(part),
        made => made.map(drop).and_then(|()| std::fs::remove_file(part)),
    }
}

/// Opens an existing file for writing, without changing it.
fn open(path: &Path) -> std::io::Result<()> {
    File::options().append(true).open(path).map(drop)
}

/// The way a file is written.
enum Way {
    /// Directly to its path.
    Straight(PathBuf),
    /// To a temporary file beside its path, renamed when it is complete.
    Renamed { part: PathBuf, path: PathBuf },
}

fn way(path: &Path) -> Way {
    // A link is resolved: the file that it points to is replaced, not the link.
    let path = std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    // Pipes, devices and read-only files are not replaced.
    if std::fs::metadata(&path).is_ok_and(|there| !there.is_file() || there.permissions().readonly()) {
        return Way::Straight(path);
    }
    let mut part = path.clone().into_os_string();
    part.push(".part");
    Way::Renamed { part: part.into(), path }
}

fn no_file(path: &Path, problem: std::io::Error) -> CliError {
    CliError::Output { path: path.to_owned(), problem: problem.into(), wanted: OutputKind::File }
}

fn failed(path: &Path, problem: PlotError) -> CliError {
    CliError::Output { path: path.to_owned(), problem, wanted: OutputKind::Folder }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn concurrent_runs_do_not_share_a_temporary_file() {
        let folder = std::env::temp_dir().join(format!("surepose-parts-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("made");
        let path = folder.join("summary.json");
        // The leftover of a killed run.
        std::fs::write(folder.join("summary.json.part"), "half").expect("written");
        std::thread::scope(|scope| {
            for text in ["a", "b", "c", "d"].map(|letter| letter.repeat(100_000)) {
                let path = &path;
                scope.spawn(move || {
                    for _ in 0..50 {
                        let write = |part: &Path| std::fs::write(part, &text);
                        whole(path, write).expect("written");
                    }
                });
            }
        });
        let text = std::fs::read_to_string(&path).expect("there");
        assert!(
            text.len() == 100_000 && text.chars().all(|letter| text.starts_with(letter)),
            "{}",
            text.len()
        );
        let left = std::fs::read_dir(&folder).expect("there").count();
        assert_eq!(left, 1);
        std::fs::remove_dir_all(&folder).expect("removed");
    }
}
