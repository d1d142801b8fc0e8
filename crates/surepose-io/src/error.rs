//! Defines the error of this crate: file, line, problem and remedy.

use std::fmt;
use std::path::{Path, PathBuf};

/// An unusable recording or map, with the location of the problem.
///
/// It prints as `path:line: problem`, so that an editor can open the location.
#[derive(Debug, thiserror::Error)]
#[error("{}: {problem}", ErrorLocation { file, line: *line })]
pub struct DataError {
    /// The file or directory.
    pub file: PathBuf,
    /// The line in the *decompressed* text, counted from 1; `None` if the problem has no line.
    pub line: Option<u64>,
    /// The problem.
    pub problem: Problem,
}

/// The problem of a file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// The file is absent or not readable.
    #[error("cannot be read: {0}{remedy}", remedy = remedy(.0))]
    Unreadable(std::io::Error),
    /// The file begins like gzip or zstd, but its stream is damaged.
    #[error("compressed stream: damaged or truncated ({0}); copy or download the file again")]
    Compression(std::io::Error),
    /// A line that is too long, most likely in a binary file.
    #[error("line: too long (expected at most {limit} bytes); check that this is a text recording")]
    LineTooLong {
        /// Maximum length of a line \[bytes].
        limit: usize,
    },
    /// A text that exceeds the memory limit.
    #[error("text: too long (expected at most {limit} bytes); split the recording")]
    TooLarge {
        /// Maximum length after decompression \[bytes].
        limit: u64,
    },
    /// A line has too few or too many columns.
    #[error("columns: wrong number (got {found}, expected {expected}: {layout})")]
    Columns {
        /// Number of columns in the format.
        expected: usize,
        /// Number of columns on the line.
        found: usize,
        /// The names of the columns, in order.
        layout: &'static str,
    },
    /// A declared count that differs from the content.
    #[error("{what}: wrong count (got {found}, expected {declared} as declared)")]
    Count {
        /// The counted items.
        what: &'static str,
        /// The declared count.
        declared: u64,
        /// The actual count.
        found: u64,
    },
    /// A column that is not a number, or not an integer where one is required.
    #[error("column {column} ({name}): not {expected} (got '{value}')")]
    NotANumber {
        /// Column, counted from 1.
        column: usize,
        /// The name of the column.
        name: &'static str,
        /// `a number` or `an integer`.
        expected: &'static str,
        /// The text of the column, shortened.
        value: String,
    },
    /// A column that is NaN, infinite or too large for a float.
    #[error("column {column} ({name}): not finite (got '{value}'); remove the line or correct the value")]
    NotFinite {
        /// Column, counted from 1.
        column: usize,
        /// The name of the column.
        name: &'static str,
        /// The text of the column, shortened.
        value: String,
    },
    /// A number outside the bounds of its quantity.
    #[error("column {column} ({name}): out of range (got '{value}', expected {bounds}); check its unit")]
    OutOfBounds {
        /// Column, counted from 1.
        column: usize,
        /// The name of the column.
        name: &'static str,
        /// The text of the column, shortened.
        value: String,
        /// The bounds with their unit, in SI.
        bounds: String,
    },
    /// A time stamp earlier than the previous one.
    #[error("time: decreases (got {found} s after {previous} s); sort the file by time")]
    TimeDecreases {
        /// Stamp of the previous record \[s\].
        previous: f64,
        /// Stamp of this record \[s\].
        found: f64,
    },
    /// Two records with the same id.
    #[error("{what} {id}: duplicate; keep one of the two lines")]
    Duplicate {
        /// The kind of record.
        what: &'static str,
        /// The id.
        id: u64,
    },
    /// A file without any record of a required kind.
    #[error("no {what} found; check that this is the right file")]
    Empty {
        /// The missing kind of record.
        what: &'static str,
    },
    /// A record that the format does not define.
    #[error("record: unknown (got '{found}', expected {expected})")]
    UnknownRecord {
        /// The text of the record, shortened.
        found: String,
        /// The valid records.
        expected: &'static str,
    },
    /// A malformed structured document (YAML, TOML).
    #[error("{message}")]
    Document {
        /// The problem and the remedy.
        message: String,
    },
    /// A recording without the requested robot.
    #[error("robot: not in this data set (got {expected}, expected one of {present})")]
    UnknownRobot {
        /// The requested robot.
        expected: u32,
        /// The robots of the data set, separated by commas.
        present: String,
    },
}

impl DataError {
    /// Creates an error for the file as a whole.
    pub fn in_file(file: &Path, problem: Problem) -> Self {
        Self { file: file.to_owned(), line: None, problem }
    }

    /// Creates an error for one line.
    pub fn at_line(file: &Path, line: u64, problem: Problem) -> Self {
        Self { file: file.to_owned(), line: Some(line), problem }
    }
}

/// Returns the remedy for an unreadable file; empty if there is none.
fn remedy(problem: &std::io::Error) -> &'static str {
    use std::io::ErrorKind;
    match problem.kind() {
        ErrorKind::NotFound => "; check the path, which is relative to the current directory",
        ErrorKind::IsADirectory => "; give the path of a file in this directory",
        ErrorKind::NotADirectory => "; give the path of the directory",
        ErrorKind::PermissionDenied => "; obtain read permission from the owner",
        _ => "",
    }
}

/// Displays `path` or `path:line`.
struct ErrorLocation<'a> {
    file: &'a Path,
    line: Option<u64>,
}

impl fmt::Display for ErrorLocation<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file.display())?;
        self.line.map_or(Ok(()), |line| write!(f, ":{line}"))
    }
}

/// Shortens text from a file for a message and escapes control characters.
pub(crate) fn excerpt(text: &[u8]) -> String {
    const MAX_SHOWN: usize = 32;
    let head = &text[..text.len().min(MAX_SHOWN)];
    let mut shown: String = String::from_utf8_lossy(head).escape_debug().collect();
    if text.len() > MAX_SHOWN {
        shown.push('…');
    }
    shown
}
