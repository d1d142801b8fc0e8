//! The replays without a reference: what the walls explain of what the laser sees.
//!
//! The recordings are not part of this repository; see `common`.

#![allow(clippy::expect_used, reason = "a test that cannot go on has failed")]

mod common;

use common::recording;
use surepose::{Angle, Pose};
use surepose_data::wean as data;
use surepose_lab::replay::wean::{self, Followed};
use surepose_lab::replay::{FollowerSettings, ticks};

/// Both runs begin at the same place of the hall, found by a particle filter over the whole grid. The same filter has
/// the robot at these poses (x, y, θ) at these scans, each to about 0.15 m.
#[test]
fn wean_hall_is_followed_from_a_given_start() {
    let Some(grid) = recording("cmu_wean/wean.dat.gz") else { return };
    let hall = wean::Hall::of_grid(&data::read_grid(&grid).expect("a readable grid"));
    let settings = wean::settings(&wean::preset());
    let places = [
        (
            "robotdata1",
            0.75,
            [(118, 44.89, 39.57, -0.04), (272, 49.78, 38.98, -2.95), (704, 39.91, 41.42, 1.30)],
        ),
        (
            "robotdata3",
            0.79,
            [(118, 42.19, 39.61, 0.04), (272, 45.01, 39.55, -0.04), (704, 37.25, 40.09, 1.19)],
        ),
    ];
    for (name, share, places) in places {
        let Some(path) = recording(&format!("cmu_wean/{name}.log.gz")) else { continue };
        let log = data::read(&path).expect("a readable log");
        let start = Pose::new(40.0, 41.4, Angle::from_degrees(-96.0));
        let Followed { report, way, .. } = wean::replay(&log, &hall, Some(start), &settings);
        println!("{name}: {report:?}");
        assert!(report.beams_on_walls.is_some_and(|mean| mean > share), "{name}");
        assert_eq!(report.position_rmse_m, None);
        for (scan, x, y, heading) in places {
            let at = way[scan].expect("followed from the start");
            let off = libm::hypot(at.x - x, at.y - y);
            let turned = (at.heading - Angle::wrapped(heading)).radians().abs();
            assert!(off < 0.3 && turned < 0.1, "{name}, scan {scan}: {off} m, {turned} rad");
        }
    }
}

/// The corridor repeats itself every six metres: after twenty seconds in it several places explain the scans, and none is
/// said to be it.
#[test]
fn wean_hall_is_not_guessed_at() {
    let Some(grid) = recording("cmu_wean/wean.dat.gz") else { return };
    let hall = wean::Hall::of_grid(&data::read_grid(&grid).expect("a readable grid"));
    let Some(path) = recording("cmu_wean/robotdata1.log.gz") else { return };
    let mut log = data::read(&path).expect("a readable log");
    log.scans.truncate(110);
    let Followed { report, way, places } = wean::replay(&log, &hall, None, &wean::settings(&wean::preset()));
    println!("{report:?}");
    assert_eq!((report.found_s, report.beams_on_walls), (None, None));
    assert_eq!(report.hypotheses_left, Some(places.len()));
    assert!(places.len() > 1 && way.iter().all(Option::is_none));
    assert!(report.explained.is_some_and(|share| share > 0.8));
}

/// The wheels alone end 3.4 m away from where the laser puts the robot in the first run.
#[test]
fn the_rover_makes_its_own_map() {
    for (name, share, scans) in [("exp1", 0.79, 755), ("exp2", 0.77, 640)] {
        let Some(path) = recording(&format!("mines_rover/{name}.dat.gz")) else { continue };
        let settings = FollowerSettings::of(&ticks::preset());
        let explored = ticks::replay(&path, &settings).expect("a readable recording");
        println!("{name}: {:?} {:?}", explored.report, explored.mapped.report);
        assert!(explored.report.beams_on_walls.is_some_and(|mean| mean > share), "{name}");
        assert!(explored.report.accepted + 5 >= scans, "{name}");
        assert!(explored.mapped.report.explained.is_some_and(|part| part > 0.87), "{name}");
    }
}
