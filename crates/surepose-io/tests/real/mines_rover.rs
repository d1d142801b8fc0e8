use std::f64::consts::TAU;

use surepose_io::mines_rover::{self, ROVER};

use crate::recording;

#[test]
fn both_recordings_match_numpy() {
    // Lines, duration [s], distance [m], missing returns among 682 ranges per line.
    let found = [
        ("exp1", 756, 74.620_139, 45.969_483, 271_287 + 14_391 - 756),
        ("exp2", 641, 63.162_132, 44.500_892, 242_258 + 10_795 - 641),
    ];
    for (name, lines, duration, distance, no_return) in found {
        let Some(path) = recording(&format!("mines_rover/{name}.dat.gz")) else { continue };
        let log = mines_rover::read(&path).unwrap();
        assert_eq!((log.odometry.len(), log.scans.len()), (lines, lines), "{name}");
        assert!(log.scans.iter().all(|scan| scan.ranges.len() == 682), "{name}");
        assert!((log.duration() - duration).abs() < 1e-6, "{name}: {} s", log.duration());
        let meters_per_tick = ROVER.wheel_radius * TAU / ROVER.ticks_per_turn;
        let ticks = log
            .odometry
            .windows(2)
            .map(|pair| (pair[1].left - pair[0].left) + (pair[1].right - pair[0].right));
        let driven: f64 = ticks.map(|ticks| (ticks as f64 / 2.0 * meters_per_tick).abs()).sum();
        assert!((driven - distance).abs() < 1e-5, "{name}: {driven} m");
        let missing =
            log.scans.iter().flat_map(|scan| &scan.ranges).filter(|range| range.is_infinite()).count();
        assert_eq!(missing, no_return, "{name}");
    }
}
