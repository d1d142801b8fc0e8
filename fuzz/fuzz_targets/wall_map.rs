//! Parses arbitrary bytes as a wall map; a valid map survives a round trip.

#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use surepose_io::wall_map;

fuzz_target!(|bytes: &[u8]| {
    let name = Path::new("input");
    if let Ok(map) = wall_map::parse(name, bytes) {
        let written = map.to_toml(name).expect("a map that was read can be written");
        let read = wall_map::parse(name, written.as_bytes()).expect("a map that was written can be read");
        assert_eq!(read, map);
    }
});
