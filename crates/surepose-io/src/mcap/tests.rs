//! Tests with complete, truncated, damaged and malicious recordings.

use ruzstd::encoding::{CompressionLevel, compress_to_vec};

use super::writer::{chunk_of, record};
use super::*;

const LIMITS: ReadLimits = ReadLimits { total: 1 << 30 };

/// Messages of a file, each with its channel, and the ending of the file.
type ReadOutcome = (Vec<(u16, Vec<u8>)>, Result<McapEnding, String>);

fn read(bytes: &[u8]) -> ReadOutcome {
    read_within(bytes, LIMITS)
}

fn read_within(bytes: &[u8], limits: ReadLimits) -> ReadOutcome {
    let mut messages = Vec::new();
    let ending = read_records::<String>(bytes, limits, |record| {
        if let McapRecord::Message { channel_id, data, .. } = record {
            messages.push((channel_id, data.to_vec()));
        }
        Ok(())
    });
    let ending = ending.map_err(|error| match error {
        McapReadError::Io(problem) => format!("io: {problem}"),
        McapReadError::Mcap(problem) => problem.to_string(),
        McapReadError::Consumer(problem) => problem,
    });
    (messages, ending)
}

fn file(records: &[Vec<u8>]) -> Vec<u8> {
    [MAGIC.to_vec(), records.concat()].concat()
}

/// Two hundred messages of a kilobyte, in several chunks.
fn recording(packing: McapCompression) -> (Vec<u8>, Vec<(u16, Vec<u8>)>) {
    let mut writer = McapWriter::new(packing);
    let schema = writer.add_schema("std_msgs/msg/String", "string data");
    let channels = [writer.add_channel(schema, "/a"), writer.add_channel(schema, "/b")];
    let data = |i: u32| (i..i + 250).flat_map(u32::to_le_bytes).collect::<Vec<u8>>();
    let messages: Vec<_> = (0..200).map(|i| (channels[i as usize % 2], data(i))).collect();
    for (channel, data) in &messages {
        writer.write(*channel, 7, data);
    }
    (writer.finished(), messages)
}

#[test]
fn all_compressions_give_the_same_messages() {
    for packing in [McapCompression::None, McapCompression::Lz4, McapCompression::Zstd] {
        let (bytes, messages) = recording(packing);
        assert_eq!(read(&bytes), (messages, Ok(McapEnding::Complete)), "{packing:?}");
    }
}

#[test]
fn records_outside_chunks_are_read_and_unknown_ones_skipped() {
    let message = record(opcode::MESSAGE, &[&[3, 0][..], &[0; 20], b"data"].concat());
    let records = [record(0x0c, &[1; 300]), message, record(0xff, b""), record(opcode::FOOTER, &[0; 20])];
    assert_eq!(read(&file(&records)), (vec![(3, b"data".to_vec())], Ok(McapEnding::Complete)));
}

#[test]
fn truncated_file_yields_the_messages_before_the_cut() {
    for packing in [McapCompression::None, McapCompression::Lz4, McapCompression::Zstd] {
        let (bytes, messages) = recording(packing);
        let mut count = 0;
        // The footer gives the start of the summary, which follows the end of the data.
        let (footer, _) = bytes[bytes.len() - MAGIC.len() - 20..].split_first_chunk().unwrap();
        let data_end = u64::from_le_bytes(*footer) as usize - 13;
        for length in (MAGIC.len()..data_end).step_by(997) {
            let (found, ending) = read(&bytes[..length]);
            assert!(matches!(ending, Ok(McapEnding::Truncated { .. })), "{packing:?} {length}: {ending:?}");
            assert!(found.len() >= count && messages.starts_with(&found), "{packing:?} {length}");
            count = found.len();
        }
        assert!(count > 150, "{packing:?}: {count}");
    }
}

#[test]
fn corrupted_bytes_do_not_panic() {
    for packing in [McapCompression::None, McapCompression::Lz4, McapCompression::Zstd] {
        let (bytes, _) = recording(packing);
        let heads = (0..400).chain((400..bytes.len()).step_by(499));
        for place in heads {
            for flip in [0x01, 0x80, 0xff] {
                let mut damaged = bytes.clone();
                damaged[place] ^= flip;
                let _ = read(&damaged);
            }
        }
    }
}

#[test]
fn wrong_checksum_is_an_error() {
    let (mut bytes, _) = recording(McapCompression::None);
    bytes[5000] ^= 1;
    let problem = read(&bytes).1.unwrap_err();
    assert!(problem.contains("wrong CRC"), "{problem}");
}

/// 49 bytes: magic and an attachment of 32 zeros, of which the fields contradict each other.
#[test]
fn attachments_are_skipped() {
    let bytes = file(&[record(0x09, &[0; 32])]);
    assert_eq!(bytes.len(), 49);
    assert_eq!(read(&bytes), (Vec::new(), Ok(McapEnding::Truncated { offset: 49 })));
}

#[test]
fn invalid_lengths_are_errors() {
    let problem = |bytes: &[u8]| read(bytes).1.unwrap_err();
    for opcode in 0..=0xff_u8 {
        if matches!(opcode, opcode::FOOTER | opcode::DATA_END) {
            continue;
        }
        let longest = [&[opcode][..], &u64::MAX.to_le_bytes(), &[0; 40]].concat();
        let problem = problem(&file(&[longest]));
        assert!(problem.starts_with("record at byte 8: too long (got 18446744073709551615 "), "{problem}");
    }
    // The compressed records of a chunk are longer than the chunk.
    for length in [5, u64::MAX] {
        let problem = problem(&file(&[chunk_of(&[0; 16], 4, 0, "", length, &[0; 4])]));
        assert!(problem.starts_with("record at byte 8: its fields"), "{problem}");
    }
    // A record in a chunk is longer than the chunk; a chunk lies in a chunk.
    for inner in
        [[&[opcode::MESSAGE][..], &u64::MAX.to_le_bytes()].concat(), chunk_of(&[0; 16], 0, 0, "", 0, &[])]
    {
        let length = inner.len() as u64;
        let problem = problem(&file(&[chunk_of(&[0; 16], length, 0, "", length, &inner)]));
        assert!(problem.starts_with("record at byte 8: its fields"), "{problem}");
    }
    // A text is longer than its record; a record is shorter than its fields.
    for content in [&[1, 0, 0xff, 0xff, 0xff, 0xff, b'a'][..], &[1], &[]] {
        let problem = problem(&file(&[record(opcode::SCHEMA, content)]));
        assert!(problem.starts_with("record at byte 8: its fields"), "{problem}");
    }
    let other = problem(&file(&[chunk_of(&[0; 16], 1, 0, "brotli\n", 1, &[0])]));
    assert!(other.contains("unknown compression 'brotli\\n'"), "{other}");
    let wrong = problem(&file(&[chunk_of(&[0; 16], 9, 0, "", 4, &[0; 4])]));
    assert_eq!(wrong, "chunk at byte 8: wrong size (expected 9 bytes, got 4)");
}

/// A frame of zstd that stands for 1.6 GB of zeros: blocks of one repeated byte.
fn bomb() -> Vec<u8> {
    // Magic; a window of 1 MiB; then blocks of type 1 of 128 KiB, the last of which is marked.
    let mut bytes = vec![0x28, 0xb5, 0x2f, 0xfd, 0x00, 0x50];
    for block in 0..12_500_u32 {
        let head = (128 << 10) << 3 | 1 << 1 | u32::from(block == 12_499);
        bytes.extend(&head.to_le_bytes()[..3]);
        bytes.push(0);
    }
    bytes
}

#[test]
fn decompression_stops_at_the_declared_size() {
    let bomb = bomb();
    let length = bomb.len() as u64;
    let problem = |size| read(&file(&[chunk_of(&[0; 16], size, 0, "zstd", length, &bomb)])).1.unwrap_err();
    assert_eq!(
        problem(1_638_400_000),
        "record at byte 8: too long (got 1638400000 bytes, expected at most 268435456)"
    );
    assert_eq!(problem(1000), "chunk at byte 8: wrong size (expected 1000 bytes, got at least 1001)");
}

/// Many chunks, each within its limit.
#[test]
fn the_sum_of_all_chunks_is_bounded() {
    let zeros = vec![0; 1 << 20];
    let packed = compress_to_vec(&record(0x80, &zeros)[..], CompressionLevel::Fastest);
    let chunk = chunk_of(&[0; 16], zeros.len() as u64 + 9, 0, "zstd", packed.len() as u64, &packed);
    let bytes = file(&vec![chunk; 20]);
    let limits = ReadLimits { total: 10 << 20 };
    let problem = read_within(&bytes, limits).1.unwrap_err();
    assert!(problem.starts_with("the recording expands to more than 10485760 bytes"), "{problem}");
    assert!(read(&bytes).1.is_ok());
}

#[test]
fn missing_magic_number_is_an_error() {
    for bytes in [&b""[..], b"\x89MCAP", b"not a recording at all"] {
        assert_eq!(read(bytes).1, Err("the MCAP magic number is missing".to_owned()));
    }
}
