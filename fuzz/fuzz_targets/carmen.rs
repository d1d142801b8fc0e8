//! Parses arbitrary bytes as a CARMEN log; valid ranges are positive.

#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use surepose_io::carmen;
use surepose_io::lines::LineReader;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(log) = carmen::parse(LineReader::from_bytes(Path::new("input"), bytes)) {
        let ranges = log.scans.iter().flat_map(|scan| &scan.ranges);
        assert!(ranges.copied().all(|range| range > 0.0), "a range is NaN or not above zero");
        assert!(log.duration().is_finite());
    }
});
