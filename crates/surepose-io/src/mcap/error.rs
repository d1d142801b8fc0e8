//! Errors of the records of an MCAP file.

/// Error of the records of a file. Offsets count the bytes of the decompressed file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum McapError {
    /// The file does not start with the magic number.
    #[error("the MCAP magic number is missing")]
    NoMagic,
    /// A record is longer than any that is read.
    #[error("record at byte {offset}: too long (got {length} bytes, expected at most {limit})")]
    RecordTooLong {
        /// Start of the record.
        offset: u64,
        /// Its declared length \[bytes\].
        length: u64,
        /// Longest that is read \[bytes\].
        limit: u64,
    },
    /// A record is shorter than its fields, or a text in it is not UTF-8.
    #[error("record at byte {offset}: its fields do not fit its length, or a text in it is not UTF-8")]
    Malformed {
        /// Start of the record, or of its chunk.
        offset: u64,
    },
    /// A chunk is compressed by an unknown method.
    #[error("chunk at byte {offset}: unknown compression '{name}' (expected zstd, lz4 or none)")]
    UnknownCompression {
        /// Start of the chunk.
        offset: u64,
        /// The method.
        name: String,
    },
    /// A chunk cannot be decompressed.
    #[error("chunk at byte {offset}: cannot be decompressed: {problem}")]
    Decompression {
        /// Start of the chunk.
        offset: u64,
        /// The problem.
        problem: std::io::Error,
    },
    /// A chunk does not hold as many bytes as it declares.
    #[error("chunk at byte {offset}: wrong size (expected {declared} bytes, got {}{found})", if .found > .declared { "at least " } else { "" })]
    ChunkSize {
        /// Start of the chunk.
        offset: u64,
        /// Declared size of its records \[bytes\].
        declared: u64,
        /// Bytes that were decompressed; one more than declared, if there are more.
        found: u64,
    },
    /// The checksum of a chunk is wrong.
    #[error("chunk at byte {offset}: wrong CRC (got {found:08x}, expected {declared:08x})")]
    Checksum {
        /// Start of the chunk.
        offset: u64,
        /// Declared CRC-32.
        declared: u32,
        /// CRC-32 of its records.
        found: u32,
    },
    /// The file expands to more than any recording of its length.
    #[error("the recording expands to more than {limit} bytes, which its length does not justify")]
    TooLarge {
        /// Most bytes that are read \[bytes\].
        limit: u64,
    },
}
