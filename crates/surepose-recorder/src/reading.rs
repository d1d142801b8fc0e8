//! Reads a recording: its session and its events.

use std::path::{Path, PathBuf};

use surepose_io::mcap::{McapEnding, McapError, McapReadError, McapRecord, ReadLimits, read_records};
use surepose_io::read_plain;

use crate::definitions::Topic;
use crate::event::Event;
use crate::files::FILE;
use crate::session::Session;
use crate::{event_cdr, session_cdr};

/// Facts of a recording that was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReadRecording {
    /// Number of events.
    pub events: u64,
    /// Whether the file has its end; a power cut truncates it.
    pub is_complete: bool,
}

/// Error of a recording.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// The file cannot be read.
    #[error("cannot be read: {0}")]
    Io(#[from] std::io::Error),
    /// The records of the file are damaged.
    #[error("damaged recording: {0}")]
    Damaged(McapError),
    /// The file was not written by the flight recorder.
    #[error("no session of the flight recorder (got no message on /surepose/session)")]
    NoSession,
    /// A message of the recorder is malformed.
    #[error("event {0}: malformed message; was the file written by another version?")]
    Malformed(u64),
}

/// Passes the session of the recording at `path` to `start`, and each event, with what `start` returned, to `each`.
///
/// `path` is a folder or its file. A truncated file yields the events before the cut. `Ok(None)` stands for a file without a
/// session: a recording of another program.
///
/// # Errors
/// [`RecordingError`].
pub fn read<T>(
    path: &Path,
    start: impl FnOnce(Session) -> T,
    mut each: impl FnMut(&mut T, Event),
) -> Result<Option<(T, ReadRecording)>, RecordingError> {
    let path = file_in(path);
    let limits = ReadLimits::of_file(std::fs::metadata(&path)?.len());
    let mut state = None;
    let (mut start, mut events) = (Some(start), 0);
    let mut topics: Vec<(u16, Topic)> = Vec::new();
    let ending = read_records(read_plain(&path)?, limits, |record| {
        match record {
            McapRecord::Channel { id, topic, .. } => {
                let known = Topic::ALL.into_iter().find(|known| known.name() == topic);
                topics.extend(known.map(|known| (id, known)));
            }
            McapRecord::Message { channel_id, data, .. } => {
                match topics.iter().find(|(id, _)| *id == channel_id).map(|(_, topic)| *topic) {
                    Some(Topic::Session) => {
                        let session = session_cdr::decoded(data).ok_or(RecordingError::Malformed(0))?;
                        state = start.take().map(|start| start(session)).or(state.take());
                    }
                    Some(Topic::Event) => {
                        let event = event_cdr::decoded(data).ok_or(RecordingError::Malformed(events))?;
                        each(state.as_mut().ok_or(RecordingError::NoSession)?, event);
                        events += 1;
                    }
                    _ => {}
                }
            }
            McapRecord::Schema { .. } => {}
        }
        Ok(())
    });
    let is_complete = match ending {
        Ok(ending) => ending == McapEnding::Complete,
        Err(McapReadError::Io(problem)) => return Err(problem.into()),
        Err(McapReadError::Mcap(problem)) => return Err(RecordingError::Damaged(problem)),
        Err(McapReadError::Consumer(problem)) => return Err(problem),
    };
    Ok(state.map(|state| (state, ReadRecording { events, is_complete })))
}

/// The file of a recording.
pub(crate) fn file_in(path: &Path) -> PathBuf {
    if path.is_dir() { path.join(FILE) } else { path.to_owned() }
}

/// Whether `path` is a folder of the flight recorder, or a file that starts with its session; not for a file that cannot be read.
pub fn is_recording(path: &Path) -> bool {
    if path.is_dir() {
        return path.join(FILE).is_file();
    }
    // A pipe can be read only once.
    if !path.is_file() {
        return false;
    }
    // The session is in the first chunk: reading stops there.
    let Ok(file) = read_plain(path) else { return false };
    let mut is_found = false;
    let stopped = read_records(file, ReadLimits::of_file(0), |record| match record {
        McapRecord::Channel { topic, .. } => {
            is_found |= topic == Topic::Session.name();
            Ok(())
        }
        McapRecord::Message { .. } => Err(()),
        McapRecord::Schema { .. } => Ok(()),
    });
    drop(stopped);
    is_found
}
