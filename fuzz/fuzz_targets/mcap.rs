//! Any bytes are a recording in MCAP, or an error; the pilot takes what it says.

#![no_main]

use libfuzzer_sys::fuzz_target;
use surepose_data::Config;
use surepose_lab::rig::Reading;
use surepose_ros2::{Names, Settings, bag};

fuzz_target!(|bytes: &[u8]| {
    let path = std::env::temp_dir().join(format!("surepose-fuzz-{}.mcap", std::process::id()));
    std::fs::write(&path, bytes).expect("a temporary file can be written");
    let config = Config::default();
    let reading = Reading::Lines;
    let settings = Settings { config, map: None, reading, start: None, compass: true, room: 0.4, hold: false };
    if let Ok(report) = bag::replay(&path, &settings, &Names::default(), |_| ()) {
        assert!(report.distance_m.is_finite() && report.duration_s.is_finite());
    }
});
