//! Parses arbitrary bytes as an image; the pixel count matches its size.

#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use surepose_io::image;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(image) = image::parse(Path::new("input"), bytes) {
        assert_eq!(image.pixels.len(), image.width * image.height);
    }
});
