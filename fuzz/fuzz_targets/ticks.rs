//! Parses arbitrary bytes as a log of encoder ticks and ranges.

#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use surepose_io::lines::LineReader;
use surepose_io::mines_rover;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(log) = mines_rover::parse(LineReader::from_bytes(Path::new("input"), bytes)) {
        let ranges = log.scans.iter().flat_map(|scan| &scan.ranges);
        assert!(ranges.copied().all(|range| range > 0.0), "a range is NaN or not above zero");
        assert!(log.duration().is_finite());
    }
});
