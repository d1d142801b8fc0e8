//! Parses arbitrary bytes as a configuration file.

#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use surepose_config::Config;

fuzz_target!(|bytes: &[u8]| {
    let _ = Config::default().with_text(Path::new("input"), bytes);
});
