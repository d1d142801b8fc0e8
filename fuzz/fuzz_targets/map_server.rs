//! Parses arbitrary bytes as the description of a map_server map.

#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use surepose_io::map_server;

fuzz_target!(|bytes: &[u8]| {
    let _ = map_server::parse(Path::new("input"), bytes);
});
