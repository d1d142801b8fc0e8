//! Replays MCAP recordings of rosbag2 with the driver, and reads them for calibration.

mod bag_index;
mod calibration;
mod files;

mod reader;
mod replay;
#[cfg(test)]
#[cfg(feature = "simulate")]
mod tests;

use std::fmt;
use std::path::PathBuf;

pub use calibration::{Recorded, recorded};
pub use replay::replay;
pub use surepose_io::mcap::McapError;

/// Truncated file of a recording, as after an interrupted recorder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Truncation {
    /// The file.
    pub file: PathBuf,
    /// Start of the truncated record \[bytes, decompressed file\].
    pub offset: u64,
}

impl fmt::Display for Truncation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (file, offset) = (self.file.file_name().unwrap_or_default().to_string_lossy(), self.offset);
        write!(
            f,
            "{}: truncated in the record at byte {offset}; the messages before it are used",
            file.escape_debug()
        )
    }
}

/// Notice of a replay.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Notice {
    /// Pose of the laser on the body, and its source.
    LaserMount(String),
    /// Truncated file.
    Truncated(Truncation),
}

impl fmt::Display for Notice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::LaserMount(line) => f.write_str(line),
            Self::Truncated(truncation) => truncation.fmt(f),
        }
    }
}

/// Error of a recording.
#[derive(Debug, thiserror::Error)]
pub enum BagError {
    /// The file cannot be read.
    #[error("cannot be read: {problem}")]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The problem.
        problem: std::io::Error,
    },
    /// The folder does not hold exactly one recording.
    #[error("{}", not_one(*.count))]
    NotOneRecording {
        /// Number of files.
        count: usize,
    },
    /// The file is not MCAP.
    #[error("not an MCAP recording; convert other formats of rosbag2 with `ros2 bag convert`")]
    NoMcap,
    /// The recording is damaged.
    #[error("damaged recording: {problem}; repair a truncated file with `mcap recover`")]
    Damaged {
        /// The problem.
        problem: McapError,
    },
    /// A file of the recording cannot be used.
    #[error("in {file}: {problem}")]
    Part {
        /// The file.
        file: String,
        /// The problem.
        problem: Box<Self>,
    },
    /// A required topic is missing.
    #[error("no topic {name} of type {kind} (got {present}); name it with --remap")]
    NoTopic {
        /// Expected name.
        name: String,
        /// Expected type.
        kind: String,
        /// Topics of the recording.
        present: String,
    },
    /// Several topics match.
    #[error("{own}: ambiguous topic (got {candidates}); select one, such as --remap {own}:={first}")]
    Ambiguous {
        /// Name of the topic in the node.
        own: &'static str,
        /// Matching topics.
        candidates: String,
        /// First of them.
        first: String,
    },
    /// A message does not match its type.
    #[error("message {number} of {topic}: not a {kind}: {problem}")]
    Message {
        /// Number of the message, from 1.
        number: u64,
        /// Topic.
        topic: String,
        /// Expected type.
        kind: String,
        /// The problem.
        problem: String,
    },
}

fn not_one(count: usize) -> String {
    if count == 0 {
        return "no .mcap file in the folder; convert other formats with `ros2 bag convert`".to_owned();
    }
    format!(
        "ambiguous folder (got {count} .mcap files, expected the parts NAME_0.mcap, NAME_1.mcap, … of one recording); name one file"
    )
}
