//! Where bytes come from: a file or memory, plain, gzip or zstd, never more than a stated number of them.

mod zstd;

use std::fs::File;
use std::io::{BufRead, BufReader, Error, Read};
use std::path::Path;

use flate2::bufread::MultiGzDecoder;

use crate::error::{DataError, Problem};

pub use zstd::ZstdReader;

/// Longest YAML or TOML document that is read \[bytes\].
pub(crate) const MAX_DOCUMENT_BYTES: u64 = 1 << 24;

const GZIP_MAGIC: [u8; 2] = [0x1f, 0x8b];
const BUFFER: usize = 1 << 16;

/// How a stream is compressed, by its first bytes.
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

/// A stream of bytes, decompressed if its first bytes are those of gzip or zstd.
pub(crate) struct Source<'a> {
    pub(crate) input: Box<dyn BufRead + 'a>,
    compression: Compression,
}

/// The bytes of a file, decompressed if its first bytes are those of gzip or zstd: for a format that another crate reads.
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

    /// A failed read: the disk's fault for a plain file, the stream's for a compressed one.
    pub(crate) fn unreadable(&self, error: Error) -> Problem {
        match self.compression {
            Compression::None => Problem::Unreadable(error),
            Compression::Gzip | Compression::Zstd => Problem::Compression(error),
        }
    }

    /// The whole content, if it is not longer than `limit`.
    fn read_all(mut self, limit: u64) -> Result<Vec<u8>, Problem> {
        let mut bytes = Vec::new();
        let result = (&mut self.input).take(limit + 1).read_to_end(&mut bytes);
        let read = result.map_err(|error| self.unreadable(error))? as u64;
        if read > limit { Err(Problem::TooLarge { limit }) } else { Ok(bytes) }
    }
}

/// The whole content of a file, plain or compressed, if it is not longer than `limit`.
pub(crate) fn read_all(path: &Path, limit: u64) -> Result<Vec<u8>, DataError> {
    let content = Source::open(path).and_then(|source| source.read_all(limit));
    content.map_err(|problem| DataError::in_file(path, problem))
}
