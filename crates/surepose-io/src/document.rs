//! What the YAML and the TOML reader share: text that is UTF-8, and errors that know their line.

use std::path::Path;

use crate::error::{DataError, Problem};

/// The text of a document, without the mark that some editors put at its start.
pub(crate) fn utf8<'a>(file: &Path, bytes: &'a [u8]) -> Result<&'a str, DataError> {
    match std::str::from_utf8(bytes) {
        Ok(text) => Ok(text.strip_prefix('\u{feff}').unwrap_or(text)),
        Err(error) => {
            let line = line_of(bytes, error.valid_up_to());
            Err(wrong(file, Some(line), "is not UTF-8 text; is this the right file?"))
        }
    }
}

/// A document that does not have the form it should have.
pub(crate) fn wrong(file: &Path, line: Option<u64>, message: impl Into<String>) -> DataError {
    DataError { file: file.to_owned(), line, problem: Problem::Document { message: message.into() } }
}

/// The line, counted from 1, on which the byte at `offset` lies.
pub(crate) fn line_of(bytes: &[u8], offset: usize) -> u64 {
    let before = &bytes[..offset.min(bytes.len())];
    before.split(|&byte| byte == b'\n').count() as u64
}
