use surepose_io::carmen;

use crate::{path_length, recording};

/// The figures of one log, computed with numpy.
struct Found {
    name: &'static str,
    odometry: usize,
    scans: usize,
    beams: usize,
    no_return: usize,
    odometry_path: f64,
    reference_path: f64,
    duration: f64,
    last_raw: (f64, f64),
}

const FOUND: [Found; 2] = [
    Found {
        name: "freiburg-101",
        odometry: 4277,
        scans: 292,
        beams: 360,
        no_return: 12573,
        odometry_path: 211.527_198,
        reference_path: 210.558_669,
        duration: 923.605,
        last_raw: (33.305_084, 22.360_097),
    },
    Found {
        name: "belgioioso",
        odometry: 4047,
        scans: 395,
        beams: 361,
        no_return: 725,
        odometry_path: 227.584_258,
        reference_path: 218.961_453,
        duration: 0.0,
        last_raw: (6.780_638, -0.108_602),
    },
];

#[test]
fn both_logs_match_numpy() {
    for found in &FOUND {
        let name = found.name;
        let Some(path) = recording(&format!("carmen/{name}-corrected.log.gz")) else { continue };
        let log = carmen::read(&path).unwrap();
        assert_eq!(log.odometry.len(), found.odometry, "{name}");
        assert_eq!((log.scans.len(), log.reference.len()), (found.scans, found.scans), "{name}");
        assert!(log.scans.iter().all(|scan| scan.ranges.len() == found.beams), "{name}");
        let no_return = log.scans.iter().flat_map(|scan| &scan.ranges).filter(|range| range.is_infinite());
        assert_eq!(no_return.count(), found.no_return, "{name}");
        let (odometry, reference) = (path_length(&log.odometry), path_length(&log.reference));
        assert!((odometry - found.odometry_path).abs() < 1e-5, "{name}: {odometry} m of raw odometry");
        assert!((reference - found.reference_path).abs() < 1e-5, "{name}: {reference} m of reference");
        assert!((log.duration() - found.duration).abs() < 1e-9, "{name}: {} s", log.duration());
        let last = log.odometry.last().unwrap();
        let off = (last.x - found.last_raw.0).hypot(last.y - found.last_raw.1);
        assert!(off < 1e-5, "{name}: raw odometry ends at {last:?}");
    }
}

#[test]
fn scans_follow_their_odometry() {
    for found in &FOUND {
        let Some(path) = recording(&format!("carmen/{}-corrected.log.gz", found.name)) else { continue };
        let log = carmen::read(&path).unwrap();
        for scan in &log.scans {
            assert_eq!(scan.odometry.unwrap(), log.odometry[scan.odometry_before - 1], "{}", found.name);
        }
    }
}
