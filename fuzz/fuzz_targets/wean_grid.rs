//! Parses arbitrary bytes as a Wean Hall grid.

#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use surepose_io::cmu_wean;
use surepose_io::lines::LineReader;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(grid) = cmu_wean::parse_grid(LineReader::from_bytes(Path::new("input"), bytes)) {
        assert_eq!(grid.cells.len(), grid.width * grid.height);
    }
});
