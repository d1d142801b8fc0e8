//! The loop of a motor controller: [`Navigator::step`](surepose::navigator::Navigator::step) at 50 Hz in `f32`, with wheel
//! encoders, a compass and one wall at a time; no allocation, no clock, no operating system.
//!
//! `firmware/` runs the same file on a Cortex-M4F. Both print the same last line: a hash of the bits of every belief and
//! every command.
//!
//! ```text
//! cargo run --release -p surepose --example firmware_loop
//! ```

mod parking;

use std::process::ExitCode;

pub(crate) fn main() -> ExitCode {
    let parked = parking::park(|| ());
    println!("{parked}");
    if parked.reached { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
