//! Where bytes come from: a file or memory, plain or gzip, never more than a stated number of them.

use std::fs::File;
use std::io::{BufRead, BufReader, Error, Read};
use std::path::Path;

use flate2::bufread::MultiGzDecoder;

use crate::error::{DataError, Problem};

/// Longest YAML or TOML document that is read \[bytes\].
pub(crate) const LONGEST_DOCUMENT: u64 = 1 << 24;

const GZIP_MAGIC: [u8; 2] = [0x1f, 0x8b];
const BUFFER: usize = 1 << 16;

/// A stream of bytes, decompressed where its first two say that it is gzip.
pub(crate) struct Source<'a> {
    pub(crate) input: Box<dyn BufRead + 'a>,
    compressed: bool,
}

/// The bytes of a file, decompressed where its first two say that it is gzip: for a format that another crate reads.
///
/// # Errors
/// Where it cannot be opened or read.
pub fn read_plain(path: &Path) -> std::io::Result<impl BufRead> {
    Ok(Source::file(path)?.input)
}

impl Source<'static> {
    pub(crate) fn open(path: &Path) -> Result<Self, Problem> {
        Self::file(path).map_err(Problem::Unreadable)
    }

    fn file(path: &Path) -> std::io::Result<Self> {
        let mut file = BufReader::with_capacity(BUFFER, File::open(path)?);
        let compressed = file.fill_buf()?.starts_with(&GZIP_MAGIC);
        Ok(Self::new(file, compressed))
    }
}

impl<'a> Source<'a> {
    pub(crate) fn from_bytes(bytes: &'a [u8]) -> Self {
        Self::new(bytes, bytes.starts_with(&GZIP_MAGIC))
    }

    fn new(input: impl BufRead + 'a, compressed: bool) -> Self {
        let input: Box<dyn BufRead + 'a> = if compressed {
            Box::new(BufReader::with_capacity(BUFFER, MultiGzDecoder::new(input)))
        } else {
            Box::new(input)
        };
        Self { input, compressed }
    }

    /// A failed read: the disk's fault for a plain file, the stream's for a compressed one.
    pub(crate) fn unreadable(&self, error: Error) -> Problem {
        if self.compressed { Problem::Compression(error) } else { Problem::Unreadable(error) }
    }

    /// The whole content, if it is not longer than `limit`.
    fn read_all(mut self, limit: u64) -> Result<Vec<u8>, Problem> {
        let mut bytes = Vec::new();
        let result = (&mut self.input).take(limit + 1).read_to_end(&mut bytes);
        let read = result.map_err(|error| self.unreadable(error))? as u64;
        if read > limit { Err(Problem::TooLarge { limit }) } else { Ok(bytes) }
    }
}

/// The whole content of a file, plain or gzip, if it is not longer than `limit`.
pub(crate) fn read_all(path: &Path, limit: u64) -> Result<Vec<u8>, DataError> {
    let content = Source::open(path).and_then(|source| source.read_all(limit));
    content.map_err(|problem| DataError::in_file(path, problem))
}
