//! Correction of scan stamps: the scanner turns evenly, the host stamps late.

use surepose_io::recording::ScanRecord;

/// Removes duplicate scans and replaces the stamps by an even clock.
///
/// The mirror turns at a constant rate; the stamps of a busy host have a variable delay. The clock t = a +
/// T·n is fitted to the stamps by least squares. The initial T is the median over ten turns. A scan whose
/// stamp is more than half a period from its clock tick is ambiguous and is dropped.
pub(super) fn regularize_stamps(scans: &[ScanRecord]) -> Vec<ScanRecord> {
    let mut kept: Vec<&ScanRecord> = Vec::with_capacity(scans.len());
    for scan in scans {
        if kept.last().is_none_or(|last| last.ranges != scan.ranges) {
            kept.push(scan);
        }
    }
    // Ten turns, so that stamps with an alternating delay do not produce two clusters of intervals.
    let mut distances: Vec<f64> =
        kept.windows(11).map(|span| (span[10].time - span[0].time) / 10.0).collect();
    distances.sort_by(f64::total_cmp);
    let Some(median) = distances.get(distances.len() / 2).copied().filter(|median| *median > 0.0) else {
        return scans.to_vec();
    };
    // The expected time follows the stamps slowly, so that one late scan does not shift it.
    let mut turns: Vec<(f64, &ScanRecord)> = Vec::with_capacity(kept.len());
    let (mut turn, mut expected) = (0.0, kept.first().map_or(0.0, |scan| scan.time));
    for scan in kept {
        let passed = ((scan.time - expected) / median).round();
        turn += passed;
        expected += passed * median;
        expected += 0.1 * (scan.time - expected);
        // If two scans fall on one turn, the earlier was late by a turn; its true turn is unknown, so it is
        // dropped.
        turns.pop_if(|(last, _)| *last >= turn);
        turns.push((turn, scan));
    }
    let (mut a, mut period) = line(turns.iter().map(|(n, scan)| (*n, scan.time)));
    for _ in 0..3 {
        let near = turns.iter().map(|(n, scan)| (*n, scan.time));
        (a, period) = line(near.filter(|(n, t)| (t - a - period * n).abs() < 0.5 * period));
    }
    let even = turns.into_iter().filter_map(|(n, scan)| {
        let time = a + period * n;
        ((scan.time - time).abs() < 0.5 * period).then(|| ScanRecord { time, ..scan.clone() })
    });
    even.collect()
}

/// Fits the line y = a + b·x by least squares and returns (a, b).
fn line(points: impl Iterator<Item = (f64, f64)> + Clone) -> (f64, f64) {
    let n = points.clone().count().max(1) as f64;
    let (mx, my) = points.clone().fold((0.0, 0.0), |(x, y), p| (x + p.0 / n, y + p.1 / n));
    let (xx, xy) =
        points.fold((0.0, 0.0), |(xx, xy), (x, y)| (xx + (x - mx) * (x - mx), xy + (x - mx) * (y - my)));
    let slope = if xx > 0.0 { xy / xx } else { 0.0 };
    (my - slope * mx, slope)
}

#[cfg(test)]
mod tests {
    use surepose_io::recording::{ScanRecord, SensorPose};

    use super::regularize_stamps;

    fn scan(time: f64, range: f64) -> ScanRecord {
        ScanRecord {
            time,
            angle_min: 0.0,
            angle_increment: 0.1,
            ranges: vec![range],
            mount: SensorPose::default(),
            odometry: None,
            odometry_before: 0,
        }
    }

    /// Delays of 0 or 40 ms, one scan lost, one duplicated, one late by 90 ms.
    #[test]
    fn late_stamps_are_moved_to_the_even_clock() {
        let late = |n: usize| if n == 50 { 0.09 } else { [0.0, 0.04][n * 7 % 2] };
        let mut scans: Vec<ScanRecord> =
            (0..100).filter(|n| *n != 30).map(|n| scan(n as f64 * 0.1 + late(n), n as f64)).collect();
        let again = ScanRecord { time: scans[60].time + 0.01, ..scans[60].clone() };
        scans.insert(61, again);
        let even = regularize_stamps(&scans);
        assert_eq!(even.len(), 98, "the duplicate and the scan that is 90 ms late are dropped");
        for scan in even {
            let n = scan.ranges[0];
            // Half of the scans are 40 ms late, so the clock is late by 20 ms.
            assert!((scan.time - n * 0.1 - 0.02).abs() < 0.004, "{n}: {}", scan.time);
        }
    }

    #[test]
    fn scans_without_a_rate_are_unchanged() {
        let scans = vec![scan(1.0, 1.0), scan(1.0, 2.0), scan(1.0, 3.0)];
        assert_eq!(regularize_stamps(&scans), scans);
        assert!(regularize_stamps(&[]).is_empty());
    }
}
