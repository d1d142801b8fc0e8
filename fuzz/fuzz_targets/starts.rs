//! Parses arbitrary bytes as start poses; a valid list has at least one, all finite.

#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use surepose_io::lines::LineReader;
use surepose_io::start_poses;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(starts) = start_poses::parse(LineReader::from_bytes(Path::new("input"), bytes)) {
        assert!(!starts.is_empty());
        assert!(starts.iter().all(|start| start.x.is_finite() && start.heading.radians().is_finite()));
    }
});
