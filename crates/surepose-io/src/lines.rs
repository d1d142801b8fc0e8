//! Reads text recordings line by line, plain or compressed, and parses their columns.
//!
//! Memory is bounded: one line is held at a time. A line has at most [`MAX_LINE_BYTES`] bytes, a text at most
//! [`MAX_TEXT_BYTES`] bytes after decompression, so that neither binary files nor gzip bombs exhaust the memory.

use std::collections::BTreeMap;
use std::io::{BufRead, Read};
use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::error::{DataError, Problem, excerpt};
use crate::quantity::{Quantity, RANGE, SIGNED_TIME, TIME};
use crate::source::Source;

/// Maximum length of a line \[bytes\], enough for a scan of 100 000 ranges.
pub const MAX_LINE_BYTES: usize = 1 << 20;

/// Maximum length of a text after decompression \[bytes\].
pub const MAX_TEXT_BYTES: u64 = 1 << 28;

/// U+FEFF in UTF-8.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// Reads a text file line by line.
pub struct LineReader<'a> {
    file: PathBuf,
    source: Source<'a>,
    line: Vec<u8>,
    number: u64,
    bytes_left: u64,
}

impl LineReader<'static> {
    /// Opens a file, plain or compressed, as its first bytes indicate.
    ///
    /// # Errors
    /// [`Problem::Unreadable`] if the file is absent or not readable.
    pub fn open(path: &Path) -> Result<Self, DataError> {
        let source = Source::open(path).map_err(|problem| DataError::in_file(path, problem))?;
        Ok(Self::new(path, source))
    }
}

impl<'a> LineReader<'a> {
    /// Creates a reader for text in memory, plain or compressed; `file` is the file name in errors.
    pub fn from_bytes(file: &Path, bytes: &'a [u8]) -> Self {
        Self::new(file, Source::from_bytes(bytes))
    }

    fn new(file: &Path, source: Source<'a>) -> Self {
        Self { file: file.to_owned(), source, line: Vec::new(), number: 0, bytes_left: MAX_TEXT_BYTES }
    }

    /// Returns the file name in errors.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// Creates an error for the file as a whole.
    pub(crate) fn error(&self, problem: Problem) -> DataError {
        DataError::in_file(&self.file, problem)
    }

    /// Returns the next line that is not blank; `None` at the end of the text.
    ///
    /// # Errors
    /// A damaged compressed stream, an I/O error, or a line or text that is too long.
    pub fn next_line(&mut self) -> Result<Option<TextLine<'_>>, DataError> {
        while self.advance()? {
            if !self.current().text.is_empty() {
                return Ok(Some(self.current()));
            }
        }
        Ok(None)
    }

    /// Returns the next line that is neither blank nor a `#` comment; `None` at the end of the text.
    pub(crate) fn next_record(&mut self) -> Result<Option<TextLine<'_>>, DataError> {
        while self.advance()? {
            if !matches!(self.current().text, [] | [b'#', ..]) {
                return Ok(Some(self.current()));
            }
        }
        Ok(None)
    }

    /// Reads one line; returns `false` at the end of the text.
    fn advance(&mut self) -> Result<bool, DataError> {
        self.line.clear();
        self.number += 1;
        let limit = self.bytes_left.min(MAX_LINE_BYTES as u64) + 1;
        let result = (&mut self.source.input).take(limit).read_until(b'\n', &mut self.line);
        let read = result.map_err(|error| self.line_error(self.source.unreadable(error)))? as u64;
        if read > self.bytes_left {
            return Err(self.line_error(Problem::TooLarge { limit: MAX_TEXT_BYTES }));
        }
        if read > MAX_LINE_BYTES as u64 {
            return Err(self.line_error(Problem::LineTooLong { limit: MAX_LINE_BYTES }));
        }
        self.bytes_left -= read;
        Ok(read > 0)
    }

    /// Returns the current line, without a byte-order mark at the start of the text.
    fn current(&self) -> TextLine<'_> {
        let marked = if self.number == 1 { self.line.strip_prefix(BYTE_ORDER_MARK) } else { None };
        let text = marked.unwrap_or(&self.line).trim_ascii();
        TextLine { file: &self.file, number: self.number, text }
    }

    fn line_error(&self, problem: Problem) -> DataError {
        DataError::at_line(&self.file, self.number, problem)
    }
}

/// One line of a file, without surrounding whitespace.
#[derive(Clone, Copy, Debug)]
pub struct TextLine<'l> {
    file: &'l Path,
    number: u64,
    text: &'l [u8],
}

impl<'l> TextLine<'l> {
    /// Returns the text of the line.
    pub fn text(&self) -> &'l [u8] {
        self.text
    }

    /// Creates an error for this line.
    pub(crate) fn error(&self, problem: Problem) -> DataError {
        DataError::at_line(self.file, self.number, problem)
    }

    /// Returns the columns, separated by whitespace.
    pub(crate) fn columns(self) -> impl Iterator<Item = Field<'l>> {
        let words = self.text.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        words.enumerate().map(move |(before, text)| Field { line: self, number: before + 1, text })
    }

    /// Returns all columns; their number is at most half of [`MAX_LINE_BYTES`].
    pub(crate) fn all_columns(self) -> Vec<Field<'l>> {
        self.columns().collect()
    }

    /// Returns exactly `N` columns separated by whitespace; `layout` names them in the error.
    pub(crate) fn split<const N: usize>(self, layout: &'static str) -> Result<[Field<'l>; N], DataError> {
        self.exactly(self.columns(), layout)
    }

    /// Returns exactly `N` columns separated by commas; `layout` names them in the error.
    pub(crate) fn split_at_commas<const N: usize>(
        self,
        layout: &'static str,
    ) -> Result<[Field<'l>; N], DataError> {
        let cells = self.text.split(|&byte| byte == b',').map(<[u8]>::trim_ascii).enumerate();
        self.exactly(cells.map(|(before, text)| Field { line: self, number: before + 1, text }), layout)
    }

    fn exactly<const N: usize>(
        self,
        mut columns: impl Iterator<Item = Field<'l>>,
        layout: &'static str,
    ) -> Result<[Field<'l>; N], DataError> {
        let mut exact = [Field { line: self, number: 0, text: &[] }; N];
        let mut found = 0;
        for (place, column) in exact.iter_mut().zip(&mut columns) {
            *place = column;
            found += 1;
        }
        found += columns.count();
        if found == N { Ok(exact) } else { Err(self.error(Problem::Columns { expected: N, found, layout })) }
    }
}

/// One column of a line.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Field<'l> {
    line: TextLine<'l>,
    number: usize,
    text: &'l [u8],
}

impl<'l> Field<'l> {
    /// Returns the text of the column.
    pub(crate) fn text(&self) -> &'l [u8] {
        self.text
    }

    /// Parses a finite number within the bounds of its quantity.
    pub(crate) fn read(&self, name: &'static str, quantity: &Quantity) -> Result<f64, DataError> {
        self.read_in(name, quantity, 1.0)
    }

    /// Parses a finite number in a unit of the file, converts it by the factor `unit` to SI, and checks its bounds.
    pub(crate) fn read_in(
        &self,
        name: &'static str,
        quantity: &Quantity,
        unit: f64,
    ) -> Result<f64, DataError> {
        let value = self.finite(name)? * unit;
        if quantity.admits(value) {
            return Ok(value);
        }
        let (column, value, bounds) = (self.number, excerpt(self.text), quantity.to_string());
        Err(self.line.error(Problem::OutOfBounds { column, name, value, bounds }))
    }

    /// Parses a range in units of `unit` meters, in \[m\]; a value outside `returns` is no return and gives infinity.
    pub(crate) fn laser_range(&self, unit: f64, returns: &Range<f64>) -> Result<f64, DataError> {
        let value = self.finite("range")? * unit;
        if value < 0.0 {
            return self.read_in("range", &RANGE, unit);
        }
        Ok(if returns.contains(&value) { value } else { f64::INFINITY })
    }

    /// Parses a finite number.
    pub(crate) fn finite(&self, name: &'static str) -> Result<f64, DataError> {
        let (column, expected) = (self.number, "a number");
        match fast_float2::parse::<f64, _>(self.text) {
            Ok(value) if value.is_finite() => Ok(value),
            Ok(_) => Err(self.line.error(Problem::NotFinite { column, name, value: excerpt(self.text) })),
            Err(_) => Err(self.line.error(Problem::NotANumber {
                column,
                name,
                expected,
                value: excerpt(self.text),
            })),
        }
    }

    /// Parses an integer.
    pub(crate) fn whole<N: std::str::FromStr>(&self, name: &'static str) -> Result<N, DataError> {
        let parsed = std::str::from_utf8(self.text).ok().and_then(|text| text.parse().ok());
        let (column, expected) = (self.number, "an integer");
        parsed.ok_or_else(|| {
            self.line.error(Problem::NotANumber { column, name, expected, value: excerpt(self.text) })
        })
    }
}

/// Checks that the stamps of a file do not decrease.
#[derive(Debug, Default)]
pub(crate) struct Clock {
    previous: Option<f64>,
}

impl Clock {
    /// Parses the stamp in `column`, in units of `unit` seconds.
    pub(crate) fn stamp(&mut self, column: Field<'_>, unit: f64) -> Result<f64, DataError> {
        let found = column.read_in("time", &TIME, unit)?;
        match self.previous.replace(found) {
            Some(previous) if found < previous => {
                Err(column.line.error(Problem::TimeDecreases { previous, found }))
            }
            _ => Ok(found),
        }
    }
}

/// Converts stamps to times that do not decrease, where the order of the lines counts.
///
/// A single stamp that steps back, or an absent one, takes the time of the record before it. Where the stamps stay back, the
/// clock was set back: it continues from there. Such stamps, and those below 0, are counted.
#[derive(Debug, Default)]
pub(crate) struct LineClock {
    /// Time of the last record \[s\].
    time: Option<f64>,
    /// Added to the stamps \[s\].
    offset: f64,
    /// Stamp of the last record, if it stepped back.
    stepped_back: Option<f64>,
}

impl LineClock {
    /// Returns the time of a record with the stamp in `column`; counts what is irregular.
    pub(crate) fn stamp(
        &mut self,
        column: Option<Field<'_>>,
        irregular: &mut BTreeMap<&'static str, u32>,
    ) -> Result<f64, DataError> {
        let mut count = |what| *irregular.entry(what).or_default() += 1;
        let Some(column) = column else {
            count("stamp_absent");
            return Ok(*self.time.get_or_insert(0.0));
        };
        let found = column.read("time", &SIGNED_TIME)?;
        if found < 0.0 {
            count("stamp_below_zero");
        }
        let last = self.time.unwrap_or(f64::NEG_INFINITY);
        let before = self.stepped_back.take();
        let mut time = found + self.offset;
        if time < last {
            match before {
                Some(before) if found >= before => {
                    self.offset = last - before;
                    time = found + self.offset;
                }
                _ => {
                    count("stamp_stepped_back");
                    (self.stepped_back, time) = (Some(found), last);
                }
            }
        }
        self.time = Some(time);
        Ok(time)
    }
}

#[cfg(test)]
mod tests;
