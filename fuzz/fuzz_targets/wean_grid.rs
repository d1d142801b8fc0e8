//! Any bytes are a Wean Hall grid, or an error.

#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use surepose_data::lines::Lines;
use surepose_data::wean;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(grid) = wean::parse_grid(Lines::from_bytes(Path::new("input"), bytes)) {
        assert_eq!(grid.cells.len(), grid.width * grid.height);
    }
});
