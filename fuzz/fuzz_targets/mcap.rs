//! Replays arbitrary bytes as an MCAP recording; every input gives a report or an error.

#![no_main]

use libfuzzer_sys::fuzz_target;
use surepose_config::{Config, ScanMethod};
use surepose_ros2::{Names, NodeDriverSettings, bag};

fuzz_target!(|bytes: &[u8]| {
    let path = std::env::temp_dir().join(format!("surepose-fuzz-{}.mcap", std::process::id()));
    std::fs::write(&path, bytes).expect("a temporary file can be written");
    let config = Config::default();
    let scan_method = ScanMethod::Lines;
    let settings = NodeDriverSettings {
        config,
        map: None,
        scan_method,
        start: None,
        compass: true,
        gyroscope: true,
        safety_radius: 0.4,
        hold: false,
    };
    if let Ok(report) = bag::replay(&path, &settings, &Names::default(), |_| ()) {
        assert!(report.distance_m.is_finite() && report.duration_s.is_finite());
    }
});
