//! The folder of a recording: one MCAP file and the `metadata.yaml` of rosbag2.

use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use surepose_io::mcap::McapWriter;

use crate::definitions::Topic;

/// Name of the file in the folder.
pub(crate) const FILE: &str = "surepose_0.mcap";

/// Folder that is written.
#[derive(Debug)]
pub(crate) struct RecordingFolder {
    path: PathBuf,
    file: File,
}

impl RecordingFolder {
    /// Creates the folder and its file. An existing recording is not overwritten.
    ///
    /// # Errors
    /// A folder that cannot be written, or that holds a recording.
    pub(crate) fn create(path: &Path) -> io::Result<Self> {
        fs::create_dir_all(path)?;
        let file = File::options().write(true).create_new(true).open(path.join(FILE))?;
        Ok(Self { path: path.to_owned(), file })
    }

    /// Appends complete records, and waits until the disk has them.
    pub(crate) fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.file.write_all(bytes)?;
        self.file.sync_data()
    }

    /// Writes `metadata.yaml`: complete or not at all.
    pub(crate) fn write_metadata(&self, writer: &McapWriter) -> io::Result<()> {
        let (part, path) = (self.path.join("metadata.yaml.part"), self.path.join("metadata.yaml"));
        fs::write(&part, metadata(writer))?;
        fs::rename(part, path)
    }
}

fn metadata(writer: &McapWriter) -> String {
    let (first, last) = writer.times().unwrap_or((0, 0));
    let (duration, count) = (last - first, writer.counts().values().sum::<u64>());
    let mut topics = String::new();
    for (topic, count) in Topic::ALL.iter().zip(writer.counts().values()) {
        let (name, kind) = (topic.name(), topic.kind());
        // Writing to a string does not fail.
        let _ = write!(
            topics,
            "    - topic_metadata:\n        name: {name}\n        type: {kind}\n        serialization_format: cdr\n        \
             offered_qos_profiles: \"\"\n      message_count: {count}\n"
        );
    }
    format!(
        "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: mcap\n  duration:\n    nanoseconds: {duration}\n  \
         starting_time:\n    nanoseconds_since_epoch: {first}\n  message_count: {count}\n  \
         topics_with_message_count:\n{topics}  compression_format: \"\"\n  compression_mode: \"\"\n  \
         relative_file_paths:\n    - {FILE}\n  files:\n    - path: {FILE}\n      starting_time:\n        \
         nanoseconds_since_epoch: {first}\n      duration:\n        nanoseconds: {duration}\n      \
         message_count: {count}\n"
    )
}
