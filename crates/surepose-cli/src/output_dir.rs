//! The folder that results are written to.

use std::fs::File;
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde_json::{Map, Value};
use surepose_figures::{Picture, PlotError};

use crate::error::{CliError, OutputKind};
use crate::parquet;

/// Keys of what is of this machine and this moment.
const TIMING: [&str; 2] = ["wall_s", "steps_per_s"];

/// A folder that exists, and that can be written to.
#[derive(Clone, Debug)]
pub(crate) struct OutputDir(PathBuf);

impl OutputDir {
    /// The folder at `path`, made where it is absent. One that cannot be written to is better found before the work than after it.
    pub(crate) fn at(path: &Path) -> Result<Self, CliError> {
        // The parent of a bare file name is the empty path: the folder that one is in.
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

    /// Writes a table, one line for each row, under the names of its fields.
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

    /// Writes the same table in columns, as Apache Parquet.
    pub(crate) fn parquet<T: Serialize>(
        &self,
        name: &str,
        rows: impl IntoIterator<Item = T>,
    ) -> Result<(), CliError> {
        let mut rows = rows.into_iter().peekable();
        if rows.peek().is_none() {
            // Without a row there are no columns, and no file.
            return Ok(());
        }
        self.whole(name, |path| Ok(parquet::write(path, rows).map_err(std::io::Error::other)?))
    }

    /// Writes `summary.json`: what the command found, without what is of this machine and this moment, so that the same
    /// command line gives the same bytes.
    pub(crate) fn summary(&self, found: &Map<String, Value>) -> Result<(), CliError> {
        let lasting = found.iter().filter(|(key, _)| !TIMING.contains(&key.as_str()));
        let lasting = lasting.map(|(key, value)| (key.clone(), value.clone())).collect();
        self.text("summary.json", &format!("{:#}\n", Value::Object(lasting)))
    }

    /// Writes a text.
    pub(crate) fn text(&self, name: &str, text: &str) -> Result<(), CliError> {
        self.text_of(name, Ok(text.to_owned()))
    }

    /// Writes a text that something may have been wrong with.
    pub(crate) fn text_of(&self, name: &str, text: std::io::Result<String>) -> Result<(), CliError> {
        self.whole(name, |path| Ok(std::fs::write(path, text?)?))
    }

    /// Lets `write` write the file of this name.
    fn whole(&self, name: &str, write: impl FnOnce(&Path) -> Result<(), PlotError>) -> Result<(), CliError> {
        let path = self.0.join(name);
        whole(&path, write).map_err(|problem| failed(&path, problem))
    }
}

/// Fails where a file could not be written: better before the work than after it. Its folder has to be there.
pub(crate) fn file_at(path: &Path) -> Result<(), CliError> {
    begin(path).map_err(|problem| no_file(path, problem))
}

/// The same, and makes its folder where that is absent.
pub(crate) fn file_in_folder_at(path: &Path) -> Result<(), CliError> {
    let folder = path.parent().map_or(Ok(()), std::fs::create_dir_all);
    folder.map_err(|problem| no_file(path, problem))?;
    file_at(path)
}

/// Writes a file that the user named.
pub(crate) fn write_file(path: &Path, text: &str) -> Result<(), CliError> {
    let write = |path: &Path| std::fs::write(path, text);
    whole(path, write).map_err(|problem| no_file(path, problem))
}

/// Lets `write` write a file, which has its name once it is whole: a full disk leaves no half of it, and what was there before
/// stays.
fn whole<E: From<std::io::Error>>(path: &Path, write: impl FnOnce(&Path) -> Result<(), E>) -> Result<(), E> {
    match way(path) {
        Way::Straight(path) => write(&path),
        Way::Renamed { part, path } => {
            write(&part).and_then(|()| Ok(std::fs::rename(&part, path)?)).inspect_err(|_| {
                drop(std::fs::remove_file(&part));
            })
        }
    }
}

/// A name that no other run of the program, and nobody else, gives a file.
fn trial_name() -> String {
    format!("surepose-{}.part", std::process::id())
}

/// Begins a file as [`whole`] does, and leaves nothing of it.
fn begin(path: &Path) -> std::io::Result<()> {
    match way(path) {
        // Whoever opens a pipe waits for its other end.
        Way::Straight(path) if path.is_file() => open(&path),
        Way::Straight(path) if path.is_dir() => Err(std::io::ErrorKind::IsADirectory.into()),
        Way::Straight(_) => Ok(()),
        Way::Renamed { part, .. } => try_out(&part),
    }
}

/// Makes a file and takes it away again; what another run left of it stays.
fn try_out(part: &Path) -> std::io::Result<()> {
    match File::create_new(part) {
        Err(problem) if problem.kind() == std::io::ErrorKind::AlreadyExists => open(part),
        made => made.map(drop).and_then(|()| std::fs::remove_file(part)),
    }
}

/// Opens a file that is there for writing, and writes nothing.
fn open(path: &Path) -> std::io::Result<()> {
    File::options().append(true).open(path).map(drop)
}

/// How a file is written.
enum Way {
    /// To where it is.
    Straight(PathBuf),
    /// Beside its name, which it is given once it is whole.
    Renamed { part: PathBuf, path: PathBuf },
}

fn way(path: &Path) -> Way {
    // Where the name is a link, the file that it leads to is replaced, and not the link.
    let path = std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    // A pipe or a device is not replaced, nor a file that is not to be written to.
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
