//! Recordings in MCAP, as rosbag2 writes them: the driver hears them as the node would have, and calibration reads them.

mod bag_index;
mod calibration;
mod files;
mod mcap;
mod reader;
mod replay;
#[cfg(all(test, feature = "simulate"))]
mod tests;

use std::fmt;
use std::path::PathBuf;

pub use calibration::{Recorded, recorded};
pub use mcap::McapError;
pub use replay::replay;

/// A file of a recording that ends before its data do, as when the recorder was interrupted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Truncation {
    /// Which file.
    pub file: PathBuf,
    /// Where the record starts that is cut short \[bytes, decompressed file\].
    pub offset: u64,
}

impl fmt::Display for Truncation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (file, offset) = (self.file.file_name().unwrap_or_default().to_string_lossy(), self.offset);
        write!(
            f,
            "{}: the recording is cut short in the record at byte {offset}; the messages before the cut are used",
            file.escape_debug()
        )
    }
}

/// What is to be known of a replay besides its figures.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Notice {
    /// Where the laser sits, and which source says so.
    LaserMount(String),
    /// A file is cut short.
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

/// Why a recording cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum BagError {
    /// It cannot be read.
    #[error("cannot be read: {problem}")]
    Unreadable {
        /// Which file.
        path: PathBuf,
        /// Why.
        problem: std::io::Error,
    },
    /// It is a folder, and which files in it are meant is not plain.
    #[error("{}", not_one(*.count))]
    NotOneRecording {
        /// How many files.
        count: usize,
    },
    /// It is no MCAP.
    #[error("this is no MCAP recording; other formats of rosbag2 become one by `ros2 bag convert`")]
    NoMcap,
    /// It is a damaged one.
    #[error("this recording is damaged: {problem}; what was cut short can be mended by `mcap recover`")]
    Damaged {
        /// What is wrong with it.
        problem: McapError,
    },
    /// One of its files cannot be used.
    #[error("in {file}: {problem}")]
    Part {
        /// Which one.
        file: String,
        /// Why.
        problem: Box<Self>,
    },
    /// The topic that is asked for is not there.
    #[error("no topic {name} of type {kind}; there are: {present}")]
    NoTopic {
        /// What it should be called.
        name: String,
        /// What it should be.
        kind: String,
        /// What there is.
        present: String,
    },
    /// Several topics could be meant.
    #[error("which topic is {own}? There are {candidates}: say --remap {own}:={first}")]
    Ambiguous {
        /// What the node calls it.
        own: &'static str,
        /// What could be meant.
        candidates: String,
        /// The first of them.
        first: String,
    },
    /// A message is not what its type says.
    #[error("message {number} of {topic} is no {kind}: {problem}")]
    Message {
        /// Counted from 1.
        number: u64,
        /// Where.
        topic: String,
        /// What it should be.
        kind: String,
        /// What is wrong.
        problem: String,
    },
}

fn not_one(count: usize) -> String {
    if count == 0 {
        return "there is no .mcap file in the folder; other formats become MCAP by `ros2 bag convert`"
            .to_owned();
    }
    format!(
        "there are {count} .mcap files in the folder, which are not the parts NAME_0.mcap, NAME_1.mcap, … of one: name one of them"
    )
}
