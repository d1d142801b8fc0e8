//! The folder that results are written to.

use std::path::{Path, PathBuf};

use serde::Serialize;
use surepose_lab::picture::{Picture, PlotError};

use crate::columns;
use crate::failure::Failure;

/// A folder that exists.
#[derive(Clone, Debug)]
pub(crate) struct Folder(PathBuf);

impl Folder {
    /// The folder at `path`, made where it is absent.
    pub(crate) fn at(path: &Path) -> Result<Self, Failure> {
        // The parent of a bare file name is the empty path: the folder that one is in.
        let path = if path.as_os_str().is_empty() { Path::new(".") } else { path };
        std::fs::create_dir_all(path).map_err(|problem| failed(path, problem.into()))?;
        Ok(Self(path.to_owned()))
    }

    /// Writes `name.svg` and `name.png`.
    pub(crate) fn picture(&self, name: &str, picture: &Picture) -> Result<(), Failure> {
        picture.save(&self.0, name).map_err(|problem| failed(&self.0.join(name), problem))
    }

    /// Writes a table, one line for each row, under the names of its fields.
    pub(crate) fn table<T: Serialize>(
        &self,
        name: &str,
        rows: impl IntoIterator<Item = T>,
    ) -> Result<(), Failure> {
        let path = self.0.join(name);
        let write = || -> csv::Result<()> {
            let mut writer = csv::Writer::from_path(&path)?;
            for row in rows {
                writer.serialize(row)?;
            }
            Ok(writer.flush()?)
        };
        write().map_err(|problem| failed(&path, std::io::Error::from(problem).into()))
    }

    /// Writes the same table in columns, as Apache Parquet.
    pub(crate) fn columns<T: Serialize>(
        &self,
        name: &str,
        rows: impl IntoIterator<Item = T>,
    ) -> Result<(), Failure> {
        let path = self.0.join(name);
        columns::write(&path, rows).map_err(|problem| failed(&path, std::io::Error::other(problem).into()))
    }

    /// Writes a text.
    pub(crate) fn text(&self, name: &str, text: &str) -> Result<(), Failure> {
        let path = self.0.join(name);
        std::fs::write(&path, text).map_err(|problem| failed(&path, problem.into()))
    }
}

fn failed(path: &Path, problem: PlotError) -> Failure {
    Failure::Output { path: path.to_owned(), problem }
}
