//! The thread that writes, and its bounded queue.

use std::io;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use surepose::localization::SensorInput;
use surepose::navigator::StepReport;
use surepose::time::Stamp;
use surepose_io::mcap::{McapCompression, McapWriter};

use crate::definitions::Topic;
use crate::event::{Event, EventInput, StepOutcome};
use crate::files::RecordingFolder;
use crate::session::{Session, text_of};
use crate::session_cdr;
use crate::topics::StandardMessages;

/// Events that wait for the disk; more are dropped and counted.
const QUEUE: usize = 1024;

/// Time after which a chunk is ended, so that a power cut loses less than a second.
const CHUNK_TIME: Duration = Duration::from_millis(500);

/// Recorder that writes to a folder.
#[derive(Debug)]
pub struct FlightRecorder {
    handle: RecorderHandle,
    thread: JoinHandle<io::Result<(u64, u64)>>,
    is_ended: Arc<AtomicBool>,
}

/// Sender of events, which the loop keeps.
#[derive(Clone, Debug)]
pub struct RecorderHandle {
    queue: SyncSender<Event>,
    next: Arc<AtomicU64>,
    dropped: Arc<AtomicU64>,
}

/// Result of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RecordingSummary {
    /// Events written.
    pub events: u64,
    /// Events that the disk was too slow for.
    pub dropped: u64,
    /// Length of the file \[bytes].
    pub bytes: u64,
}

impl FlightRecorder {
    /// Starts a recording in `folder`, which must not hold one.
    ///
    /// # Errors
    /// A folder that cannot be written, or that holds a recording; or a thread that cannot be started.
    pub fn create(folder: &Path, session: &Session) -> io::Result<Self> {
        let mut folder = RecordingFolder::create(folder)?;
        let mut writer = McapWriter::new(McapCompression::Lz4);
        for topic in Topic::ALL {
            let schema = writer.add_schema(topic.kind(), &topic.definition());
            writer.add_channel(schema, topic.name());
        }
        writer.write(Topic::Session as u16, time(session.stamp), &session_cdr::encoded(session));
        let settings: Vec<_> = session.config.settings().iter().map(text_of).collect();
        let values = [("version", session.version.as_str()), ("configuration", &settings.join("\n"))];
        writer.add_metadata("surepose", &values);
        folder.append(&writer.take())?;
        folder.write_metadata(&writer)?;

        let (queue, events) = sync_channel(QUEUE);
        let is_ended = Arc::new(AtomicBool::new(false));
        let mut thread = Thread {
            folder,
            writer,
            messages: StandardMessages::new(session.config.drive()),
            events,
            is_ended: Arc::clone(&is_ended),
            bytes: 0,
        };
        let thread = thread::Builder::new().name("recorder".to_owned()).spawn(move || thread.run())?;
        let handle = RecorderHandle { queue, next: Arc::default(), dropped: Arc::default() };
        Ok(Self { handle, thread, is_ended })
    }

    /// Sender for the loop.
    pub fn handle(&self) -> RecorderHandle {
        self.handle.clone()
    }

    /// Ends the recording: writes what waits, and the index.
    ///
    /// # Errors
    /// A file that could not be written.
    pub fn finish(self) -> io::Result<RecordingSummary> {
        self.is_ended.store(true, Ordering::Release);
        let dropped = self.handle.dropped();
        let failed = || io::Error::other("the recorder's thread has failed");
        let (events, bytes) = self.thread.join().map_err(|_| failed())??;
        Ok(RecordingSummary { events, dropped, bytes })
    }
}

impl RecorderHandle {
    /// Logs a call of the navigator, and never waits: where the queue is full, the event is dropped and counted.
    pub fn log(&self, stamp: Stamp, input: EventInput) {
        self.send(self.event(stamp, input, None));
    }

    /// Logs a step like [`RecorderHandle::log`].
    pub fn log_step(&self, input: &SensorInput<'_, f64>, report: &StepReport<f64>) {
        let outcome = Some(StepOutcome::of(report));
        self.send(self.event(input.stamp, EventInput::of_step(input), outcome));
    }

    /// Logs a step, and waits for a place in the queue: for a simulation, whose time waits as well.
    pub fn log_simulated_step(&self, input: &SensorInput<'_, f64>, report: &StepReport<f64>) {
        let outcome = Some(StepOutcome::of(report));
        let event = self.event(input.stamp, EventInput::of_step(input), outcome);
        if self.queue.send(event).is_err() {
            self.dropped.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// Number of events that were dropped.
    pub fn dropped(&self) -> u64 {
        self.dropped.load(Ordering::Relaxed)
    }

    fn event(&self, stamp: Stamp, input: EventInput, outcome: Option<StepOutcome>) -> Event {
        Event { sequence: self.next.fetch_add(1, Ordering::Relaxed), stamp, input, outcome }
    }

    fn send(&self, event: Event) {
        if self.queue.try_send(event).is_err() {
            self.dropped.fetch_add(1, Ordering::Relaxed);
        }
    }
}

struct Thread {
    folder: RecordingFolder,
    writer: McapWriter,
    messages: StandardMessages,
    events: Receiver<Event>,
    is_ended: Arc<AtomicBool>,
    bytes: u64,
}

impl Thread {
    fn run(&mut self) -> io::Result<(u64, u64)> {
        let (mut count, mut flushed) = (0, Instant::now());
        loop {
            match self.events.recv_timeout(CHUNK_TIME) {
                Ok(event) => {
                    self.write(&event);
                    count += 1;
                }
                Err(RecvTimeoutError::Timeout) if !self.is_ended.load(Ordering::Acquire) => {}
                Err(_) => break,
            }
            if flushed.elapsed() >= CHUNK_TIME {
                self.writer.end_chunk();
                self.flush()?;
                flushed = Instant::now();
            }
        }
        self.writer.end_chunk();
        self.flush()?;
        self.folder.write_metadata(&self.writer)?;
        let end = std::mem::replace(&mut self.writer, McapWriter::new(McapCompression::None)).finished();
        self.append(&end)?;
        Ok((count, self.bytes))
    }

    fn write(&mut self, event: &Event) {
        let at = time(event.stamp);
        self.writer.write(Topic::Event as u16, at, &crate::event_cdr::encoded(event));
        for (topic, message) in self.messages.of(event) {
            self.writer.write(topic as u16, at, &message);
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        let bytes = self.writer.take();
        self.append(&bytes)
    }

    fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.bytes += bytes.len() as u64;
        if bytes.is_empty() { Ok(()) } else { self.folder.append(bytes) }
    }
}

/// Time of a message \[ns]; MCAP has no times before the origin.
fn time(stamp: Stamp) -> u64 {
    u64::try_from(stamp.nanoseconds()).unwrap_or(0)
}
