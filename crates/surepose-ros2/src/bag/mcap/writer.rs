//! Writes recordings for the tests.

use std::io::Write;

use lz4_flex::frame::FrameEncoder;

use super::{MAGIC, opcode};

/// Chunks are closed at this length \[bytes\].
const CHUNK_LENGTH: usize = 1 << 16;

/// Compression of the chunks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::bag) enum Packing {
    None,
    Lz4,
    Zstd,
}

/// A recording that is written.
pub(in crate::bag) struct Writer {
    bytes: Vec<u8>,
    chunk: Vec<u8>,
    packing: Packing,
    schemas: u16,
    channels: u16,
}

impl Writer {
    pub(in crate::bag) fn new(packing: Packing) -> Self {
        let mut bytes = MAGIC.to_vec();
        bytes.extend(record(0x01, &[text("ros2"), text("")].concat()));
        Self { bytes, chunk: Vec::new(), packing, schemas: 0, channels: 0 }
    }

    pub(in crate::bag) fn add_schema(&mut self, name: &str) -> u16 {
        self.schemas += 1;
        let id = self.schemas;
        let content = [&id.to_le_bytes()[..], &text(name), &text("ros2msg"), &text("")].concat();
        self.chunk.extend(record(opcode::SCHEMA, &content));
        id
    }

    pub(in crate::bag) fn add_channel(&mut self, schema: u16, topic: &str) -> u16 {
        let id = self.channels;
        self.channels += 1;
        let ids = [id.to_le_bytes(), schema.to_le_bytes()].concat();
        let content = [&ids[..], &text(topic), &text("cdr"), &0_u32.to_le_bytes()].concat();
        self.chunk.extend(record(opcode::CHANNEL, &content));
        id
    }

    /// A message, logged and published at `time` \[ns\].
    pub(in crate::bag) fn write(&mut self, channel: u16, time: u64, data: &[u8]) {
        let time = time.to_le_bytes();
        let content = [&channel.to_le_bytes()[..], &[0; 4], &time, &time, data].concat();
        self.chunk.extend(record(opcode::MESSAGE, &content));
        if self.chunk.len() > CHUNK_LENGTH {
            self.flush();
        }
    }

    pub(in crate::bag) fn finished(mut self) -> Vec<u8> {
        self.flush();
        self.bytes.extend(record(opcode::DATA_END, &[0; 4]));
        self.bytes.extend(record(opcode::FOOTER, &[0; 20]));
        self.bytes.extend(MAGIC);
        self.bytes
    }

    fn flush(&mut self) {
        let records = std::mem::take(&mut self.chunk);
        if !records.is_empty() {
            self.bytes.extend(chunk(&records, self.packing));
        }
    }
}

/// A record with its opcode and length.
pub(in crate::bag) fn record(opcode: u8, content: &[u8]) -> Vec<u8> {
    [&[opcode][..], &(content.len() as u64).to_le_bytes(), content].concat()
}

/// A chunk of `records`.
fn chunk(records: &[u8], packing: Packing) -> Vec<u8> {
    let (name, packed) = match packing {
        Packing::None => ("", records.to_vec()),
        Packing::Lz4 => {
            let mut encoder = FrameEncoder::new(Vec::new());
            encoder.write_all(records).unwrap();
            ("lz4", encoder.finish().unwrap())
        }
        Packing::Zstd => {
            let level = ruzstd::encoding::CompressionLevel::Fastest;
            ("zstd", ruzstd::encoding::compress_to_vec(records, level))
        }
    };
    chunk_of(records.len() as u64, crc32fast::hash(records), name, packed.len() as u64, &packed)
}

/// A chunk with these fields.
pub(in crate::bag) fn chunk_of(size: u64, crc: u32, name: &str, length: u64, packed: &[u8]) -> Vec<u8> {
    let fields = [&[0; 16][..], &size.to_le_bytes(), &crc.to_le_bytes(), &text(name)].concat();
    record(opcode::CHUNK, &[&fields[..], &length.to_le_bytes(), packed].concat())
}

fn text(text: &str) -> Vec<u8> {
    [&(text.len() as u32).to_le_bytes()[..], text.as_bytes()].concat()
}
