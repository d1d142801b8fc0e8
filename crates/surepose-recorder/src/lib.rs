//! The flight recorder: every input and outcome of the navigator, written as MCAP and replayed to the bit.
//!
//! [`FlightRecorder`] receives a [`Session`] and then each [`Event`]: the calls of the
//! [`Navigator`](surepose::navigator::Navigator) with their inputs, and the outcome of each step. A thread of its own writes
//! them; its queue is bounded, and [`RecorderHandle::log`] never waits. [`replay`](replay::replay) feeds a recording to a new
//! navigator and compares the outcomes bit by bit.
//!
//! # Errors
//! [`RecordingError`] for a recording that cannot be read; `std::io::Error` for one that cannot be written.

mod cdr;
mod definitions;
mod event;
mod event_cdr;
mod files;
mod reading;
mod recorder;
pub mod replay;
mod session;
mod session_cdr;
#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
mod tests;
mod topics;

pub use event::{Event, EventInput, RecordedReading, StepOutcome};
pub use reading::{ReadRecording, RecordingError, is_recording, read};
pub use recorder::{FlightRecorder, RecorderHandle, RecordingSummary};
pub use session::Session;
