//! Writes MCAP files chunk by chunk: each finished chunk is readable, whatever happens after it.

use std::collections::BTreeMap;
use std::io::Write;

use lz4_flex::frame::FrameEncoder;

use super::{MAGIC, opcode};

/// Chunks are closed at this length \[bytes\].
const CHUNK_LENGTH: usize = 1 << 16;

/// Compression of the chunks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum McapCompression {
    /// No compression.
    None,
    /// Frames of LZ4.
    Lz4,
    /// Frames of Zstandard.
    Zstd,
}

/// Writer of a file, whose bytes the caller appends to it: [`McapWriter::take`] returns those since the last call.
///
/// ```
/// use surepose_io::mcap::{McapCompression, McapWriter};
///
/// let mut writer = McapWriter::new(McapCompression::Lz4);
/// let schema = writer.add_schema("std_msgs/msg/String", "string data");
/// let channel = writer.add_channel(schema, "/said");
/// writer.write(channel, 1_000_000, &[0, 1, 0, 0, 1, 0, 0, 0, 0]);
/// writer.end_chunk();
/// let mut file = writer.take();
/// file.extend(writer.finished());
/// ```
#[derive(Clone, Debug)]
pub struct McapWriter {
    bytes: Vec<u8>,
    /// Length of the file before `bytes`.
    taken: u64,
    chunk: Vec<u8>,
    /// Times and offsets of the messages of the chunk, by channel.
    index: BTreeMap<u16, Vec<(u64, u64)>>,
    compression: McapCompression,
    /// Records of schemas, channels and the index, repeated at the end of the file.
    schemas: Vec<Vec<u8>>,
    channels: Vec<Vec<u8>>,
    chunk_indexes: Vec<Vec<u8>>,
    metadata_indexes: Vec<Vec<u8>>,
    /// Number of messages of each channel.
    counts: BTreeMap<u16, u64>,
    /// Times of the first and the last message.
    times: Option<(u64, u64)>,
}

impl McapWriter {
    /// Starts a file of ROS 2 messages.
    pub fn new(compression: McapCompression) -> Self {
        let mut bytes = MAGIC.to_vec();
        bytes.extend(record(opcode::HEADER, &[text("ros2"), text("surepose")].concat()));
        Self {
            bytes,
            taken: 0,
            chunk: Vec::new(),
            index: BTreeMap::new(),
            compression,
            schemas: Vec::new(),
            channels: Vec::new(),
            chunk_indexes: Vec::new(),
            metadata_indexes: Vec::new(),
            counts: BTreeMap::new(),
            times: None,
        }
    }

    /// Adds a message type with its definition in the language of ROS 2, and returns its number.
    pub fn add_schema(&mut self, name: &str, definition: &str) -> u16 {
        let id = self.schemas.len() as u16 + 1;
        let content = [&id.to_le_bytes()[..], &text(name), &text("ros2msg"), &text(definition)].concat();
        self.schemas.push(record(opcode::SCHEMA, &content));
        self.chunk.extend(record(opcode::SCHEMA, &content));
        id
    }

    /// Adds a topic with messages in CDR, and returns its number.
    pub fn add_channel(&mut self, schema: u16, topic: &str) -> u16 {
        let id = self.channels.len() as u16;
        let ids = [id.to_le_bytes(), schema.to_le_bytes()].concat();
        let content = [&ids[..], &text(topic), &text("cdr"), &0_u32.to_le_bytes()].concat();
        self.channels.push(record(opcode::CHANNEL, &content));
        self.chunk.extend(record(opcode::CHANNEL, &content));
        self.counts.insert(id, 0);
        id
    }

    /// Adds names and values outside the messages.
    pub fn add_metadata(&mut self, name: &str, values: &[(&str, &str)]) {
        self.end_chunk();
        let values: Vec<u8> =
            values.iter().flat_map(|(key, value)| [text(key), text(value)].concat()).collect();
        let content = [text(name), (values.len() as u32).to_le_bytes().to_vec(), values].concat();
        let (offset, record) = (self.length(), record(opcode::METADATA, &content));
        let index = [offset.to_le_bytes(), (record.len() as u64).to_le_bytes()].concat();
        self.metadata_indexes.push(self::record(opcode::METADATA_INDEX, &[index, text(name)].concat()));
        self.bytes.extend(record);
    }

    /// Adds a message, logged and published at `time` \[ns\].
    pub fn write(&mut self, channel: u16, time: u64, data: &[u8]) {
        self.index.entry(channel).or_default().push((time, self.chunk.len() as u64));
        *self.counts.entry(channel).or_default() += 1;
        let (first, last) = self.times.unwrap_or((time, time));
        self.times = Some((first.min(time), last.max(time)));
        let time = time.to_le_bytes();
        let content = [&channel.to_le_bytes()[..], &[0; 4], &time, &time, data].concat();
        self.chunk.extend(record(opcode::MESSAGE, &content));
        if self.chunk.len() > CHUNK_LENGTH {
            self.end_chunk();
        }
    }

    /// Number of messages of each channel.
    pub fn counts(&self) -> &BTreeMap<u16, u64> {
        &self.counts
    }

    /// Times of the first and the last message \[ns\]; `None` without a message.
    pub fn times(&self) -> Option<(u64, u64)> {
        self.times
    }

    /// Ends the chunk, so that its messages are readable if the file ends after it.
    pub fn end_chunk(&mut self) {
        let records = std::mem::take(&mut self.chunk);
        let index = std::mem::take(&mut self.index);
        if records.is_empty() {
            return;
        }
        let start = self.length();
        let times = index.values().flatten().map(|(time, _)| *time);
        let (first, last) = (times.clone().min().unwrap_or(0), times.max().unwrap_or(0));
        let (name, packed) = compressed(&records, self.compression);
        let times = [first.to_le_bytes(), last.to_le_bytes()].concat();
        let sizes = [packed.len() as u64, records.len() as u64].map(u64::to_le_bytes).concat();
        let chunk = chunk_of(
            &times,
            records.len() as u64,
            crc32fast::hash(&records),
            name,
            packed.len() as u64,
            &packed,
        );
        let length = chunk.len() as u64;
        self.bytes.extend(chunk);

        let index_start = self.length();
        let mut offsets = Vec::new();
        for (channel, messages) in &index {
            offsets.extend([&channel.to_le_bytes()[..], &self.length().to_le_bytes()].concat());
            let entries: Vec<u8> = messages
                .iter()
                .flat_map(|(time, at)| [time.to_le_bytes(), at.to_le_bytes()].concat())
                .collect();
            let content =
                [&channel.to_le_bytes()[..], &(entries.len() as u32).to_le_bytes(), &entries].concat();
            self.bytes.extend(record(opcode::MESSAGE_INDEX, &content));
        }
        let content = [
            &times[..],
            &start.to_le_bytes(),
            &length.to_le_bytes(),
            &(offsets.len() as u32).to_le_bytes(),
            &offsets,
            &(self.length() - index_start).to_le_bytes(),
            &text(name),
            &sizes,
        ]
        .concat();
        self.chunk_indexes.push(record(opcode::CHUNK_INDEX, &content));
    }

    /// Takes the bytes that are complete: all but those of the chunk that is not ended.
    pub fn take(&mut self) -> Vec<u8> {
        self.taken = self.length();
        std::mem::take(&mut self.bytes)
    }

    /// Ends the file, and takes the rest of its bytes.
    pub fn finished(mut self) -> Vec<u8> {
        self.end_chunk();
        self.bytes.extend(record(opcode::DATA_END, &[0; 4]));
        let summary = self.length();
        let statistics = record(opcode::STATISTICS, &self.statistics());
        let records = [&self.schemas, &self.channels, &self.chunk_indexes, &self.metadata_indexes];
        let records: Vec<u8> = records.into_iter().flatten().flatten().copied().collect();
        self.bytes.extend([records, statistics].concat());
        let footer = [&summary.to_le_bytes()[..], &[0; 12]].concat();
        self.bytes.extend(record(opcode::FOOTER, &footer));
        self.bytes.extend(MAGIC);
        self.bytes
    }

    fn statistics(&self) -> Vec<u8> {
        let (first, last) = self.times.unwrap_or((0, 0));
        let counts: Vec<u8> = self
            .counts
            .iter()
            .flat_map(|(channel, count)| [&channel.to_le_bytes()[..], &count.to_le_bytes()].concat())
            .collect();
        [
            &self.counts.values().sum::<u64>().to_le_bytes()[..],
            &(self.schemas.len() as u16).to_le_bytes(),
            &(self.channels.len() as u32).to_le_bytes(),
            &0_u32.to_le_bytes(),
            &(self.metadata_indexes.len() as u32).to_le_bytes(),
            &(self.chunk_indexes.len() as u32).to_le_bytes(),
            &first.to_le_bytes(),
            &last.to_le_bytes(),
            &(counts.len() as u32).to_le_bytes(),
            &counts,
        ]
        .concat()
    }

    /// Length of the file up to here.
    fn length(&self) -> u64 {
        self.taken + self.bytes.len() as u64
    }
}

/// A record with its opcode and length.
pub(super) fn record(opcode: u8, content: &[u8]) -> Vec<u8> {
    [&[opcode][..], &(content.len() as u64).to_le_bytes(), content].concat()
}

/// A chunk with these fields; `times` are those of its first and last message.
pub(super) fn chunk_of(times: &[u8], size: u64, crc: u32, name: &str, length: u64, packed: &[u8]) -> Vec<u8> {
    let fields = [times, &size.to_le_bytes(), &crc.to_le_bytes(), &text(name)].concat();
    record(opcode::CHUNK, &[&fields[..], &length.to_le_bytes(), packed].concat())
}

/// Name of a compression, and the compressed bytes; as they are, where they cannot be compressed.
fn compressed(records: &[u8], compression: McapCompression) -> (&'static str, Vec<u8>) {
    match compression {
        McapCompression::None => {}
        McapCompression::Lz4 => {
            let mut encoder = FrameEncoder::new(Vec::new());
            if encoder.write_all(records).is_ok()
                && let Ok(packed) = encoder.finish()
            {
                return ("lz4", packed);
            }
        }
        McapCompression::Zstd => {
            let level = ruzstd::encoding::CompressionLevel::Fastest;
            return ("zstd", ruzstd::encoding::compress_to_vec(records, level));
        }
    }
    ("", records.to_vec())
}

fn text(text: &str) -> Vec<u8> {
    [&(text.len() as u32).to_le_bytes()[..], text.as_bytes()].concat()
}
