//! The one error of this crate: which file, which line, what is wrong, and what would be right.

use std::fmt;
use std::path::{Path, PathBuf};

/// A recording or map that cannot be used, with the place that is to blame.
///
/// It prints as `path:line: problem`, so that an editor can jump to the place.
#[derive(Debug, thiserror::Error)]
#[error("{}: {problem}", Place { file, line: *line })]
pub struct DataError {
    /// File (or folder) that is to blame.
    pub file: PathBuf,
    /// Line in the *decompressed* text, counted from 1; absent where no line is to blame.
    pub line: Option<u64>,
    /// What is wrong there.
    pub problem: Problem,
}

/// What is wrong with a file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// The file is absent, or the system refuses to read it.
    #[error("cannot be read: {0}{remedy}", remedy = remedy(.0))]
    Unreadable(std::io::Error),
    /// The file starts as gzip or zstd does, but its stream is damaged.
    #[error("the compressed stream is damaged or cut short ({0}); copy or download the file again")]
    Compression(std::io::Error),
    /// A line without an end: a binary file, most likely.
    #[error("the line is longer than {limit} bytes; this is not a text recording")]
    LineTooLong {
        /// Longest line that is read.
        limit: usize,
    },
    /// More text than this crate is willing to hold in memory.
    #[error("the text is longer than {limit} bytes; split the recording")]
    TooLarge {
        /// Most bytes that are read, after decompression.
        limit: u64,
    },
    /// A line has too few or too many columns.
    #[error("expected {expected} columns ({layout}), found {found}")]
    Columns {
        /// Columns that the format has.
        expected: usize,
        /// Columns on the line.
        found: usize,
        /// The names of the columns, in order.
        layout: &'static str,
    },
    /// A declared count differs from what the line or file holds.
    #[error("declares {declared} {what}, but holds {found}")]
    Count {
        /// What is counted.
        what: &'static str,
        /// The count the file states.
        declared: u64,
        /// The count the file has.
        found: u64,
    },
    /// A column holds no number (or no whole number where one is needed).
    #[error("column {column} ({name}) is not {expected}: '{value}'")]
    NotANumber {
        /// Column, counted from 1.
        column: usize,
        /// What the column holds.
        name: &'static str,
        /// `a number` or `a whole number`.
        expected: &'static str,
        /// The text found there, shortened.
        value: String,
    },
    /// A column holds NaN, an infinity, or a number too large for a float.
    #[error("column {column} ({name}) is not finite: '{value}'; remove the line or repair the value")]
    NotFinite {
        /// Column, counted from 1.
        column: usize,
        /// What the column holds.
        name: &'static str,
        /// The text found there, shortened.
        value: String,
    },
    /// A number outside the bounds of its quantity.
    #[error("column {column} ({name}) is '{value}', outside {bounds}; is it in another unit?")]
    OutOfBounds {
        /// Column, counted from 1.
        column: usize,
        /// What the column holds.
        name: &'static str,
        /// The text found there, shortened.
        value: String,
        /// The bounds with their unit, after conversion to SI.
        bounds: String,
    },
    /// A time stamp before the one that precedes it.
    #[error("time goes back from {previous} s to {found} s; sort the file by time")]
    TimeDecreases {
        /// Stamp of the record before \[s\].
        previous: f64,
        /// Stamp of this record \[s\].
        found: f64,
    },
    /// Two records for a thing of which there is one.
    #[error("{what} {id} appears twice; keep one of the two lines")]
    Duplicate {
        /// What appears twice.
        what: &'static str,
        /// Its number.
        id: u64,
    },
    /// A file without a single record of a kind that the format needs.
    #[error("holds no {what}; is this the right file?")]
    Empty {
        /// What is missing.
        what: &'static str,
    },
    /// A record that the format does not have.
    #[error("'{found}' is not a record of this format; expected {expected}")]
    UnknownRecord {
        /// The word found, shortened.
        found: String,
        /// What may stand there.
        expected: &'static str,
    },
    /// A structured document (YAML, TOML) that does not have the form it should have.
    #[error("{message}")]
    Document {
        /// What is wrong, and what would be right.
        message: String,
    },
    /// A recording without the robot that was asked for.
    #[error("robot {expected} is not in this data set; it has robots {present}")]
    UnknownRobot {
        /// The robot that was asked for.
        expected: u32,
        /// The robots there are, separated by commas.
        present: String,
    },
}

impl DataError {
    /// A problem of the file as a whole.
    pub fn in_file(file: &Path, problem: Problem) -> Self {
        Self { file: file.to_owned(), line: None, problem }
    }

    /// A problem of one line.
    pub fn at_line(file: &Path, line: u64, problem: Problem) -> Self {
        Self { file: file.to_owned(), line: Some(line), problem }
    }
}

/// What would be right where a file cannot be read.
fn remedy(problem: &std::io::Error) -> &'static str {
    use std::io::ErrorKind;
    match problem.kind() {
        ErrorKind::NotFound => "; is the path right, from the folder that you are in?",
        ErrorKind::IsADirectory => "; name the file in it that is meant",
        ErrorKind::NotADirectory => "; name the folder that the files are in",
        ErrorKind::PermissionDenied => "; ask whoever owns it for the right to read it",
        _ => "",
    }
}

/// `path` or `path:line`.
struct Place<'a> {
    file: &'a Path,
    line: Option<u64>,
}

impl fmt::Display for Place<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file.display())?;
        self.line.map_or(Ok(()), |line| write!(f, ":{line}"))
    }
}

/// Text from a file made fit for a message: short, and without control characters.
pub(crate) fn excerpt(text: &[u8]) -> String {
    const MAX_SHOWN: usize = 32;
    let head = &text[..text.len().min(MAX_SHOWN)];
    let mut shown: String = String::from_utf8_lossy(head).escape_debug().collect();
    if text.len() > MAX_SHOWN {
        shown.push('…');
    }
    shown
}
