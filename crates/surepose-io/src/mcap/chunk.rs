//! Chunks: records that are compressed together.

use std::borrow::Cow;
use std::io::Read;

use crate::ZstdReader;
use lz4_flex::frame::FrameDecoder;

use super::content::Content;
use super::error::McapError;

/// Longest record that is held in memory, compressed or not \[bytes\].
pub(super) const MAX_RECORD_LENGTH: u64 = 1 << 28;

/// The fields of a chunk.
pub(super) struct Chunk<'a> {
    offset: u64,
    size: u64,
    crc: u32,
    compression: &'a str,
    compressed: &'a [u8],
    is_complete: bool,
}

impl<'a> Chunk<'a> {
    /// The chunk at `offset`, of which the content starts with `body`. `None`: the cut lies within its first fields.
    ///
    /// # Errors
    /// Lengths that contradict each other, or more records than are held in memory.
    pub(super) fn parse(offset: u64, body: &'a [u8], is_complete: bool) -> Result<Option<Self>, McapError> {
        let mut fields = Content::new(body);
        let head = (|| {
            // Times of the first and the last message.
            fields.take(8 + 8)?;
            Some((fields.u64()?, fields.u32()?, fields.text()?, fields.u64()?))
        })();
        let Some((size, crc, compression, length)) = head else {
            return if is_complete { Err(McapError::Malformed { offset }) } else { Ok(None) };
        };
        if size > MAX_RECORD_LENGTH {
            return Err(McapError::RecordTooLong { offset, length: size, limit: MAX_RECORD_LENGTH });
        }
        let compressed = match fields.take(length) {
            Some(compressed) => compressed,
            None if is_complete => return Err(McapError::Malformed { offset }),
            None => fields.rest(),
        };
        Ok(Some(Self { offset, size, crc, compression, compressed, is_complete }))
    }

    /// The bytes of its records; of a truncated chunk, those before the cut.
    ///
    /// # Errors
    /// An unknown or damaged compression, another size than is declared, or a wrong checksum.
    pub(super) fn records(&self) -> Result<Cow<'a, [u8]>, McapError> {
        let records = match self.compression {
            "" => Cow::Borrowed(self.compressed),
            "zstd" => Cow::Owned(self.decompressed(ZstdReader::new(self.compressed))?),
            "lz4" => Cow::Owned(self.decompressed(FrameDecoder::new(self.compressed))?),
            name => {
                let name = name.chars().take(32).flat_map(char::escape_debug).collect();
                return Err(McapError::UnknownCompression { offset: self.offset, name });
            }
        };
        let (offset, declared, found) = (self.offset, self.size, records.len() as u64);
        if found > declared || self.is_complete && found < declared {
            return Err(McapError::ChunkSize { offset, declared, found });
        }
        // Zero stands for a checksum that was not computed.
        if self.is_complete && self.crc != 0 {
            let (declared, found) = (self.crc, crc32fast::hash(&records));
            if declared != found {
                return Err(McapError::Checksum { offset, declared, found });
            }
        }
        Ok(records)
    }

    /// At most one byte more than is declared.
    fn decompressed(&self, decoder: impl Read) -> Result<Vec<u8>, McapError> {
        let mut records = Vec::new();
        match decoder.take(self.size + 1).read_to_end(&mut records) {
            Err(problem) if self.is_complete => {
                Err(McapError::Decompression { offset: self.offset, problem })
            }
            _ => Ok(records),
        }
    }
}
