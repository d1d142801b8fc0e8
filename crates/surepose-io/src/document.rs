//! Helpers of the YAML and TOML readers: UTF-8 text, and errors with a line number.

use std::path::Path;

use crate::error::{DataError, Problem};

/// Returns the text of a document without a byte-order mark.
pub(crate) fn utf8<'a>(file: &Path, bytes: &'a [u8]) -> Result<&'a str, DataError> {
    match std::str::from_utf8(bytes) {
        Ok(text) => Ok(text.strip_prefix('\u{feff}').unwrap_or(text)),
        Err(error) => {
            let line = line_of(bytes, error.valid_up_to());
            Err(wrong(file, Some(line), "not UTF-8 text; check that this is the right file"))
        }
    }
}

/// Creates an error for a malformed document.
pub(crate) fn wrong(file: &Path, line: Option<u64>, message: impl Into<String>) -> DataError {
    DataError { file: file.to_owned(), line, problem: Problem::Document { message: message.into() } }
}

/// Returns the line, counted from 1, of the byte at `offset`.
pub(crate) fn line_of(bytes: &[u8], offset: usize) -> u64 {
    let before = &bytes[..offset.min(bytes.len())];
    before.split(|&byte| byte == b'\n').count() as u64
}
