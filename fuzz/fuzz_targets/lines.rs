//! Reads arbitrary bytes as lines of plain text or gzip.

#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use surepose_io::lines::LineReader;

fuzz_target!(|bytes: &[u8]| {
    let mut lines = LineReader::from_bytes(Path::new("input"), bytes);
    while let Ok(Some(_)) = lines.next_line() {}
});
