//! Replays without a reference: fraction of the returns that the walls explain.
//!
//! The recordings are not part of this repository; see `common`.

#![allow(clippy::expect_used, reason = "tests may panic")]

use surepose::geometry::{Angle, Body, Map, Pose};
use surepose_io::cmu_wean as data;
use surepose_io::grid::Grid;
use surepose_io::recording::{Recording, StampedPose};
use surepose_replay::cmu_wean::{self, WeanReplay};
use surepose_replay::{BuildingMap, LaserReplaySettings, mines_rover};
use surepose_sim::CancelToken;
use surepose_testdata::recording;

/// Index of a scan, and the pose (x, y, θ) at which it was taken.
type Taken = (usize, f64, f64, f64);

/// Both runs start at the same place of the hall. A particle filter over the whole grid localized the robot
/// at these scans at these poses, each to about 0.15 m.
const PLACES: [(&str, [Taken; 3]); 2] = [
    ("robotdata1", [(118, 44.89, 39.57, -0.04), (272, 49.78, 38.98, -2.95), (704, 39.91, 41.42, 1.30)]),
    ("robotdata3", [(118, 42.19, 39.61, 0.04), (272, 45.01, 39.55, -0.04), (704, 37.25, 40.09, 1.19)]),
];

/// Returns the log and the hall's grid; `None` if either is absent.
fn run(name: &str) -> Option<(Recording<StampedPose>, Grid)> {
    let grid = recording("cmu_wean/wean.dat.gz")?;
    let log = recording(&format!("cmu_wean/{name}.log.gz"))?;
    Some((data::read(&log).expect("a readable log"), data::read_grid(&grid).expect("a readable grid")))
}

/// Returns the error of the estimate at a scan \[m], \[rad]; `None` before localization.
fn off((scan, x, y, heading): Taken, trajectory: &[Option<Pose<Map, Body, f64>>]) -> Option<(f64, f64)> {
    let at = trajectory[scan]?;
    Some((libm::hypot(at.x - x, at.y - y), (at.heading - Angle::from_radians(heading)).radians().abs()))
}

#[test]
fn wean_hall_is_tracked_from_a_given_start() {
    let settings = cmu_wean::settings(&cmu_wean::preset());
    for ((name, places), share) in PLACES.into_iter().zip([0.95, 0.97]) {
        let Some((log, grid)) = run(name) else { continue };
        let start = Pose::new(40.0, 41.4, Angle::from_degrees(-96.0));
        let WeanReplay { report, trajectory, .. } = cmu_wean::replay(
            &log,
            &BuildingMap::from_grid(grid),
            Some(start),
            &settings,
            &CancelToken::default(),
        );
        println!("{name}: {report:?}");
        assert!(report.beams_on_walls.is_some_and(|mean| mean > share), "{name}");
        assert_eq!(report.position_rmse_m, None);
        for place in places {
            let (off, turned) = off(place, &trajectory).expect("a pose at every scan");
            assert!(off < 0.3 && turned < 0.1, "{name}, scan {}: {off} m, {turned} rad", place.0);
        }
    }
}

/// From the start, and from 30 s later, when the robot has left a unique doorway. The most similar wrong pose
/// is 6 m away. Along the corridor the walls have little information, and two estimates differ by up to 0.7
/// m.
#[test]
fn wean_hall_start_pose_is_found() {
    let settings = cmu_wean::settings(&cmu_wean::preset());
    for (name, _) in PLACES {
        let Some((log, grid)) = run(name) else { continue };
        let building = BuildingMap::from_grid(grid);
        let start = Pose::new(40.0, 41.4, Angle::from_degrees(-96.0));
        let followed =
            cmu_wean::replay(&log, &building, Some(start), &settings, &CancelToken::default()).trajectory;
        for late in [0.0, 30.0] {
            let mut log = log.clone();
            let dropped = log.scans.iter().take_while(|scan| scan.time < late).count();
            log.scans.drain(..dropped);
            let WeanReplay { report, trajectory, candidates, before } =
                cmu_wean::replay(&log, &building, None, &settings, &CancelToken::default());
            println!("{name} from {late} s: {report:?}");
            assert!(report.found_s.is_some_and(|after| after < 50.0) && report.withdrawn.is_none(), "{name}");
            assert_eq!((report.hypotheses_left, candidates.len()), (Some(1), 0));
            assert!(!before.is_empty() && report.explained.is_some_and(|part| part > 0.75), "{name}");
            for (found, known) in trajectory.iter().zip(&followed[dropped..]) {
                let Some((found, known)) = found.zip(*known) else { continue };
                let off = found.origin().distance(known.origin());
                let turned = (found.heading - known.heading).radians().abs();
                assert!(off < 1.0 && turned < 0.2, "{name} from {late} s: {off} m, {turned} rad");
            }
        }
    }
}

/// The corridor repeats every 6 m: after 15 s in it several poses explain the scans, and none is accepted.
#[test]
fn wean_hall_ambiguity_is_reported() {
    let Some((mut log, grid)) = run("robotdata1") else { return };
    log.scans.truncate(80);
    let WeanReplay { report, trajectory, candidates, .. } = cmu_wean::replay(
        &log,
        &BuildingMap::from_grid(grid),
        None,
        &cmu_wean::settings(&cmu_wean::preset()),
        &CancelToken::default(),
    );
    println!("{report:?}");
    assert_eq!((report.found_s, report.beams_on_walls), (None, None));
    assert_eq!(report.hypotheses_left, Some(candidates.len()));
    assert!(candidates.len() > 1 && trajectory.iter().all(Option::is_none));
}

/// On a grid without the corridor segment of the robot, other segments match for a while.
#[test]
fn no_wrong_pose_is_accepted_on_an_incomplete_map_of_wean_hall() {
    let settings = cmu_wean::settings(&cmu_wean::preset());
    for (name, _) in PLACES {
        let Some((log, mut grid)) = run(name) else { continue };
        for (column, row) in (270..540).flat_map(|column| (0..540).map(move |row| (column, row))) {
            grid.cells[row * grid.width + column] = None;
        }
        let WeanReplay { report, trajectory, .. } =
            cmu_wean::replay(&log, &BuildingMap::from_grid(grid), None, &settings, &CancelToken::default());
        println!("{name}: {report:?}");
        assert!(report.found_s.is_none() && trajectory.iter().all(Option::is_none), "{name}");
    }
}

/// In the first run, dead reckoning ends 3.4 m away from the laser's estimate.
#[test]
fn the_rover_is_tracked_on_its_own_map() {
    for (name, share, scans) in [("exp1", 0.79, 755), ("exp2", 0.77, 640)] {
        let Some(path) = recording(&format!("mines_rover/{name}.dat.gz")) else { continue };
        let settings = LaserReplaySettings::from_config(&mines_rover::preset());
        let log = surepose_io::mines_rover::read(&path).expect("a readable recording");
        let explored = mines_rover::replay_log(&log, &settings, &CancelToken::default());
        println!("{name}: {:?} {:?}", explored.report, explored.mapped.report);
        assert!(explored.report.beams_on_walls.is_some_and(|mean| mean > share), "{name}");
        assert!(explored.report.accepted + 5 >= scans, "{name}");
        assert!(explored.mapped.report.explained.is_some_and(|part| part > 0.87), "{name}");
    }
}
