//! The program `surepose`.

use std::process::ExitCode;

fn main() -> ExitCode {
    surepose_cli::program()
}
