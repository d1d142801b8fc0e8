//! Opens byte sources: files or memory, plain, gzip or zstd, with a bounded length.

mod zstd;

use std::fs::File;
use std::io::{BufRead, BufReader, Error, Read};
use std::path::Path;

use flate2::bufread::MultiGzDecoder;

use crate::error::{DataError, Problem};

pub use zstd::ZstdReader;

/// Maximum length of a YAML or TOML document \[bytes\].
pub(crate) const MAX_DOCUMENT_BYTES: u64 = 1 << 24;

const GZIP_MAGIC: [u8; 2] = [0x1f, 0x8b];
const BUFFER: usize = 1 << 16;

/// The compression of a stream, detected by its first bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Compression {
    None,
    Gzip,
    Zstd,
}

impl Compression {
    fn of(head: &[u8]) -> Self {
        match head {
            head if head.starts_with(&GZIP_MAGIC) => Self::Gzip,
            head if head.starts_with(&zstd::MAGIC) => Self::Zstd,
            _ => Self::None,
        }
    }
}

/// A byte stream, decompressed if it begins like gzip or zstd.
pub(crate) struct Source<'a> {
    pub(crate) input: Box<dyn BufRead + 'a>,
    compression: Compression,
}

/// Opens a file for a reader outside this crate, decompressed if it begins like gzip or zstd.
///
/// # Errors
/// I/O errors of opening or reading.
pub fn read_plain(path: &Path) -> std::io::Result<impl BufRead> {
    Ok(Source::file(path)?.input)
}

impl Source<'static> {
    pub(crate) fn open(path: &Path) -> Result<Self, Problem> {
        Self::file(path).map_err(Problem::Unreadable)
    }

    fn file(path: &Path) -> std::io::Result<Self> {
        let mut file = BufReader::with_capacity(BUFFER, File::open(path)?);
        let compression = Compression::of(file.fill_buf()?);
        Ok(Self::new(file, compression))
    }
}

impl<'a> Source<'a> {
    pub(crate) fn from_bytes(bytes: &'a [u8]) -> Self {
        Self::new(bytes, Compression::of(bytes))
    }

    fn new(input: impl BufRead + 'a, compression: Compression) -> Self {
        let input: Box<dyn BufRead + 'a> = match compression {
            Compression::None => Box::new(input),
            Compression::Gzip => Box::new(BufReader::with_capacity(BUFFER, MultiGzDecoder::new(input))),
            Compression::Zstd => Box::new(BufReader::with_capacity(BUFFER, ZstdReader::new(input))),
        };
        Self { input, compression }
    }

    /// Converts a read error: an I/O problem for a plain source, else a damaged compressed stream.
    pub(crate) fn unreadable(&self, error: Error) -> Problem {
        match self.compression {
            Compression::None => Problem::Unreadable(error),
            Compression::Gzip | Compression::Zstd => Problem::Compression(error),
        }
    }

    /// Reads the whole content, at most `limit` bytes.
    fn read_all(mut self, limit: u64) -> Result<Vec<u8>, Problem> {
        let mut bytes = Vec::new();
        let result = (&mut self.input).take(limit + 1).read_to_end(&mut bytes);
        let read = result.map_err(|error| self.unreadable(error))? as u64;
        if read > limit { Err(Problem::TooLarge { limit }) } else { Ok(bytes) }
    }
}

/// Reads the whole content of a file, plain or compressed, at most `limit` bytes.
pub(crate) fn read_all(path: &Path, limit: u64) -> Result<Vec<u8>, DataError> {
    let content = Source::open(path).and_then(|source| source.read_all(limit));
    content.map_err(|problem| DataError::in_file(path, problem))
}
