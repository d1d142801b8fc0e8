//! Small samples of the trials that `examples/kidnappings.rs` runs in large numbers.

use surepose_config::{Config, ScanMethod};
use surepose_io::grid::{Grid, GridOrigin};
use surepose_sim::robot::Sensors;
use surepose_sim::{Arena, Clutter};

use super::{KidnappingSetup, SpawnArea, run_trials};

fn setup(compass: bool, clutter: f64) -> KidnappingSetup {
    let clutter = Clutter { fraction: clutter, width: 5.0 };
    let sensors = Sensors { compass, laser: true };
    KidnappingSetup { config: Config::default(), sensors, scan_method: ScanMethod::Lines, clutter }
}

/// With 60 trials per case, a failure rate of a few percent makes this test fail.
#[test]
fn kidnapped_robots_are_flagged_and_recover() {
    let area = SpawnArea::anywhere(Arena::paper());
    for (compass, clutter) in [(true, 0.0), (true, 0.2), (false, 0.0)] {
        let sum = run_trials(&area, &setup(compass, clutter), 1..=60);
        assert_eq!(sum.false_alarms, 0, "{sum:?}");
        assert_eq!(sum.flagged, 60, "{sum:?}");
        assert_eq!((sum.recovered, sum.ambiguous), (60, 0), "{sum:?}");
        assert_eq!((sum.wrongly_found, sum.confidently_wrong), (0, 0), "{sum:?}");
        // Three standard deviations of the mean of 60 draws of χ² with 3 degrees of freedom: 3 ± 3·√(6/60).
        assert!((2.05..3.95).contains(&sum.nees_mean), "{sum:?}");
    }
}

/// An empty rectangle has a rotational symmetry: without a compass the pose is ambiguous.
#[test]
fn symmetric_places_remain_ambiguous() {
    let area = SpawnArea::anywhere(Arena::open());
    let sum = run_trials(&area, &setup(false, 0.0), 1..=30);
    assert_eq!((sum.ambiguous, sum.wrongly_found, sum.confidently_wrong), (30, 0, 0), "{sum:?}");
    let with_compass = run_trials(&area, &setup(true, 0.0), 1..=30);
    assert_eq!(
        (with_compass.recovered, with_compass.ambiguous, with_compass.wrongly_found),
        (30, 0, 0),
        "{with_compass:?}"
    );
}

/// A hall of 10 × 7 m whose walls are steps and pillars of 0.5 m: a line has only a few beams.
fn hall_of_steps() -> Grid {
    let (width, height, resolution) = (200, 140, 0.05);
    let pillars = [(30, 40), (62, 95), (80, 30), (118, 84), (150, 52), (165, 110), (98, 112), (38, 108)];
    let cells = (0..height).flat_map(|row| (0..width).map(move |column| (column, row)));
    let occupied = cells.map(|(column, row): (i32, i32)| {
        let step = 3 * ((column / 9 + row / 9) % 3);
        let outside =
            column < 4 + step || column >= width - 4 - step || row < 4 + step || row >= height - 4 - step;
        let pillar = pillars.iter().any(|(x, y)| (column - x).abs() < 5 && (row - y).abs() < 5);
        Some(if outside || pillar { 1.0 } else { 0.0 })
    });
    let cells = occupied.collect();
    Grid { width: width as usize, height: height as usize, resolution, origin: GridOrigin::default(), cells }
}

/// With few lines as starting points, the exhaustive pose grid finds the pose.
#[test]
fn robots_recover_among_short_walls() {
    let area = SpawnArea::on_grid("steps", &hall_of_steps());
    for compass in [true, false] {
        let setup = KidnappingSetup { scan_method: ScanMethod::Beams, ..setup(compass, 0.0) };
        let sum = run_trials(&area, &setup, 1..=20);
        assert_eq!((sum.false_alarms, sum.flagged, sum.recovered), (0, 20, 20), "{sum:?}");
        assert_eq!((sum.wrongly_found, sum.confidently_wrong), (0, 0), "{sum:?}");
    }
}
