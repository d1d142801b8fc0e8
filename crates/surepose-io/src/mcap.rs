//! Reads the MCAP records of ROS 2 messages sequentially, and writes them.
//!
//! The format is MCAP version 0, <https://mcap.dev/spec>. A file is a magic number and records of opcode, length and
//! content; a chunk is a record that holds records, compressed or not. Every length is checked before its use, memory is
//! bounded by two records of the longest length, and the work by [`ReadLimits`].

mod chunk;
mod content;
mod error;
#[cfg(test)]
mod tests;
mod writer;

use std::io::{ErrorKind, Read};

pub use content::McapRecord;
pub use error::McapError;
pub use writer::{McapCompression, McapWriter};

use chunk::{Chunk, MAX_RECORD_LENGTH};
use content::Content;

/// First and last bytes of a file.
const MAGIC: [u8; 8] = *b"\x89MCAP0\r\n";

/// Longest record that is skipped, such as an attachment \[bytes\].
const MAX_SKIPPED_LENGTH: u64 = 1 << 40;

/// Opcodes, by the names of the specification.
mod opcode {
    pub(super) const HEADER: u8 = 0x01;
    pub(super) const FOOTER: u8 = 0x02;
    pub(super) const SCHEMA: u8 = 0x03;
    pub(super) const CHANNEL: u8 = 0x04;
    pub(super) const MESSAGE: u8 = 0x05;
    pub(super) const CHUNK: u8 = 0x06;
    pub(super) const MESSAGE_INDEX: u8 = 0x07;
    pub(super) const CHUNK_INDEX: u8 = 0x08;
    pub(super) const STATISTICS: u8 = 0x0b;
    pub(super) const METADATA: u8 = 0x0c;
    pub(super) const METADATA_INDEX: u8 = 0x0d;
    pub(super) const DATA_END: u8 = 0x0f;
}

/// End of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum McapEnding {
    /// After its data.
    Complete,
    /// Before the end of its data, at this offset \[bytes, decompressed file\].
    Truncated {
        /// Start of the truncated record.
        offset: u64,
    },
}

/// Reason for which reading stopped: an unreadable file, damaged records, or an error of the consumer of the records.
#[derive(Debug)]
pub enum McapReadError<E> {
    /// The file cannot be read.
    Io(std::io::Error),
    /// Its records are damaged.
    Mcap(McapError),
    /// The consumer of the records returned an error.
    Consumer(E),
}

impl<E> From<McapError> for McapReadError<E> {
    fn from(problem: McapError) -> Self {
        Self::Mcap(problem)
    }
}

/// ReadLimits on the decompressed size of a file.
#[derive(Clone, Copy, Debug)]
pub struct ReadLimits {
    /// Most bytes that are read and decompressed, together \[bytes\].
    pub total: u64,
}

impl ReadLimits {
    /// Those of a file of this length: 256 times as much, and 1 GiB. Laser scans compress to a tenth at best.
    pub fn of_file(length: u64) -> Self {
        Self { total: length.saturating_mul(256).saturating_add(1 << 30) }
    }
}

/// Reads the records of `input` up to the end of its data, those in chunks as well, and passes them to `consume`.
///
/// A truncated file yields the records before the cut.
///
/// # Errors
/// [`McapReadError`].
pub fn read_records<E>(
    input: impl Read,
    limits: ReadLimits,
    consume: impl FnMut(McapRecord<'_>) -> Result<(), E>,
) -> Result<McapEnding, McapReadError<E>> {
    let mut reader = Reader { input, offset: 0, expanded: 0, limits, consume };
    let mut magic = Vec::new();
    if reader.fill(&mut magic, MAGIC.len() as u64)? && magic == MAGIC {
        return reader.records();
    }
    Err(McapError::NoMagic.into())
}

struct Reader<R, F> {
    input: R,
    offset: u64,
    /// Bytes that chunks were decompressed to.
    expanded: u64,
    limits: ReadLimits,
    consume: F,
}

impl<R: Read, E, F: FnMut(McapRecord<'_>) -> Result<(), E>> Reader<R, F> {
    fn records(&mut self) -> Result<McapEnding, McapReadError<E>> {
        let (mut head, mut body) = (Vec::new(), Vec::new());
        loop {
            let offset = self.offset;
            let truncated = McapEnding::Truncated { offset };
            if !self.fill(&mut head, HEAD_LENGTH as u64)? {
                return Ok(truncated);
            }
            let mut fields = Content::new(&head);
            let (Some(opcode), Some(length)) = (fields.u8(), fields.u64()) else { return Ok(truncated) };
            let limit = match opcode {
                opcode::FOOTER | opcode::DATA_END => return Ok(McapEnding::Complete),
                opcode::SCHEMA | opcode::CHANNEL | opcode::MESSAGE | opcode::CHUNK => MAX_RECORD_LENGTH,
                _ => MAX_SKIPPED_LENGTH,
            };
            if length > limit {
                return Err(McapError::RecordTooLong { offset, length, limit }.into());
            }
            if limit == MAX_SKIPPED_LENGTH {
                if !self.skip(length)? {
                    return Ok(truncated);
                }
                continue;
            }
            let is_complete = self.fill(&mut body, length)?;
            if opcode == opcode::CHUNK {
                self.chunk(offset, &body, is_complete)?;
            } else if is_complete {
                self.record(offset, opcode, &body)?;
            }
            if !is_complete {
                return Ok(truncated);
            }
        }
    }

    /// The records of a chunk at `offset`, of which the content starts with `body`.
    fn chunk(&mut self, offset: u64, body: &[u8], is_complete: bool) -> Result<(), McapReadError<E>> {
        let malformed = || McapError::Malformed { offset };
        let Some(chunk) = Chunk::parse(offset, body, is_complete)? else { return Ok(()) };
        let records = chunk.records()?;
        self.expanded = self.expanded.saturating_add(records.len() as u64);
        self.check_total()?;
        let mut rest = Content::new(&records);
        while !rest.is_empty() {
            let record = (|| Some((rest.u8()?, rest.u64().and_then(|length| rest.take(length))?)))();
            let Some((opcode, content)) = record else {
                // The cut may lie within a record of the chunk.
                return if is_complete { Err(malformed().into()) } else { Ok(()) };
            };
            if opcode == opcode::CHUNK {
                return Err(malformed().into());
            }
            self.record(offset, opcode, content)?;
        }
        Ok(())
    }

    fn record(&mut self, offset: u64, opcode: u8, content: &[u8]) -> Result<(), McapReadError<E>> {
        let mut fields = Content::new(content);
        let record = match opcode {
            opcode::SCHEMA => fields.schema(),
            opcode::CHANNEL => fields.channel(),
            opcode::MESSAGE => fields.message(),
            _ => return Ok(()),
        };
        let record = record.ok_or(McapError::Malformed { offset })?;
        (self.consume)(record).map_err(McapReadError::Consumer)
    }

    /// Reads `length` bytes. `false`: the file ends before, and `bytes` holds what there is.
    fn fill(&mut self, bytes: &mut Vec<u8>, length: u64) -> Result<bool, McapReadError<E>> {
        bytes.clear();
        let result = self.input.by_ref().take(length).read_to_end(bytes);
        let read = bytes.len() as u64;
        self.advance(read, length, result.map(|_| ()))
    }

    /// Skips `length` bytes. `false`: the file ends before.
    fn skip(&mut self, length: u64) -> Result<bool, McapReadError<E>> {
        let mut left = length;
        while left > 0 {
            let piece = left.min(1 << 20);
            let (read, result) =
                match std::io::copy(&mut self.input.by_ref().take(piece), &mut std::io::sink()) {
                    Ok(read) => (read, Ok(())),
                    Err(problem) => (0, Err(problem)),
                };
            if !self.advance(read, piece, result)? {
                return Ok(false);
            }
            left -= piece;
        }
        Ok(true)
    }

    /// Counts what was `read` of the bytes that were `required`. A truncated compressed file ends at the cut.
    fn advance(
        &mut self,
        read: u64,
        required: u64,
        result: std::io::Result<()>,
    ) -> Result<bool, McapReadError<E>> {
        self.offset = self.offset.saturating_add(read);
        self.check_total()?;
        match result {
            Err(problem) if problem.kind() != ErrorKind::UnexpectedEof => Err(McapReadError::Io(problem)),
            _ => Ok(read == required),
        }
    }

    fn check_total(&self) -> Result<(), McapError> {
        let limit = self.limits.total;
        if self.offset.saturating_add(self.expanded) > limit {
            return Err(McapError::TooLarge { limit });
        }
        Ok(())
    }
}

/// Opcode and length of a record \[bytes\].
const HEAD_LENGTH: usize = 9;
