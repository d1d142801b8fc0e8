//! Runs every example; its exit code is the result of the test.

use std::error::Error;
use std::process::ExitCode;

#[path = "../examples/custom_sensor.rs"]
mod custom_sensor;
#[path = "../examples/firmware_loop/main.rs"]
mod firmware_loop;
#[path = "../examples/localize_only.rs"]
mod localize_only;
#[path = "../examples/park.rs"]
mod park;

#[test]
fn park_succeeds() -> Result<ExitCode, Box<dyn Error>> {
    park::main()
}

#[test]
fn custom_sensor_succeeds() -> ExitCode {
    custom_sensor::main()
}

#[test]
fn localize_only_succeeds() -> Result<ExitCode, Box<dyn Error>> {
    localize_only::main()
}

#[test]
fn firmware_loop_succeeds() -> ExitCode {
    firmware_loop::main()
}
