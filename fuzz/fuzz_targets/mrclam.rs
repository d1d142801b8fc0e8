//! Parses five arbitrary texts as the MRCLAM log of a robot.

#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use surepose_io::lines::LineReader;
use surepose_io::mrclam::{self, Files};

fuzz_target!(|bytes: &[u8]| {
    // 0xff does not occur in UTF-8: it separates the five files.
    let mut texts = bytes.split(|&byte| byte == 0xff);
    let mut next = |name: &str| LineReader::from_bytes(Path::new(name), texts.next().unwrap_or_default());
    let _ = mrclam::parse(Files {
        barcodes: next("barcodes"),
        landmarks: next("landmarks"),
        odometry: next("odometry"),
        sightings: next("sightings"),
        reference: Some(next("reference")),
    });
});
