use surepose_io::cmu_wean;

use crate::{path_length, recording};

#[test]
fn both_logs_match_numpy() {
    // Odometry records, scans, time of first and last record [s], path length [m], missing returns.
    let found = [
        ("robotdata1", 1505, 713, (0.025_466, 134.998_162), 41.227_847, 693),
        ("robotdata3", 1735, 1241, (0.051_821, 132.385_364), 42.551_409, 3669),
    ];
    for (name, odometry, scans, (first, last), path, no_return) in found {
        let Some(file) = recording(&format!("cmu_wean/{name}.log.gz")) else { continue };
        let log = cmu_wean::read(&file).unwrap();
        assert_eq!((log.odometry.len(), log.scans.len()), (odometry, scans), "{name}");
        assert!((log.duration() - (last - first)).abs() < 1e-9, "{name}: {} s", log.duration());
        assert!((path_length(&log.odometry) - path).abs() < 1e-5, "{name}");
        let missing = log.scans.iter().flat_map(|scan| &scan.ranges).filter(|range| range.is_infinite());
        assert_eq!(missing.count(), no_return, "{name}");
        for scan in &log.scans {
            let off = (scan.mount.x - 0.25).abs() + scan.mount.y.abs() + scan.mount.heading.abs();
            assert!(off < 2e-6, "{name}: laser at {:?}", scan.mount);
        }
    }
}

#[test]
fn grid_matches_numpy() {
    let Some(file) = recording("cmu_wean/wean.dat.gz") else { return };
    let grid = cmu_wean::read_grid(&file).unwrap();
    assert_eq!((grid.width, grid.height, grid.resolution.to_bits()), (800, 800, 0.1_f64.to_bits()));
    let count = |of: fn(f32) -> bool| grid.cells.iter().flatten().filter(|&&cell| of(cell)).count();
    assert_eq!(grid.cells.iter().filter(|cell| cell.is_none()).count(), 466_143);
    assert_eq!(count(|occupied| occupied > 0.9), 17_025, "walls");
    assert_eq!(count(|occupied| occupied < 0.1), 43_700, "free");
}
