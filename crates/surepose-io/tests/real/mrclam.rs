use surepose_io::error::Problem;
use surepose_io::mrclam::{self, Target};

use crate::{path_length, recording};

/// The figures of one robot, computed with numpy.
struct Counted {
    odometry: usize,
    reference: usize,
    sightings: usize,
    landmarks: usize,
    robots: usize,
    unknown: usize,
    odometry_duration: f64,
    path: f64,
    commanded_path: f64,
}

const COUNTED: [Counted; 5] = [
    Counted {
        odometry: 58598,
        reference: 58389,
        sightings: 3228,
        landmarks: 2578,
        robots: 650,
        unknown: 0,
        odometry_duration: 893.790,
        path: 53.554_712,
        commanded_path: 55.311_253,
    },
    Counted {
        odometry: 60936,
        reference: 56529,
        sightings: 4518,
        landmarks: 3818,
        robots: 700,
        unknown: 0,
        odometry_duration: 891.892,
        path: 54.332_768,
        commanded_path: 56.366_025,
    },
    Counted {
        odometry: 55085,
        reference: 53545,
        sightings: 5399,
        landmarks: 4425,
        robots: 965,
        unknown: 9,
        odometry_duration: 891.342,
        path: 49.393_271,
        commanded_path: 52.435_864,
    },
    Counted {
        odometry: 62207,
        reference: 63081,
        sightings: 2377,
        landmarks: 1822,
        robots: 555,
        unknown: 0,
        odometry_duration: 892.361,
        path: 38.163_641,
        commanded_path: 38.389_965,
    },
    Counted {
        odometry: 59787,
        reference: 58414,
        sightings: 4760,
        landmarks: 3424,
        robots: 1336,
        unknown: 0,
        odometry_duration: 893.654,
        path: 45.749_571,
        commanded_path: 46.174_284,
    },
];

#[test]
fn every_robot_matches_numpy() {
    let Some(folder) = recording("mrclam7") else { return };
    assert_eq!(mrclam::robots(&folder).unwrap(), [1, 2, 3, 4, 5]);
    for (robot, counted) in (1..).zip(&COUNTED) {
        let log = mrclam::read(&folder, robot).unwrap();
        assert_eq!(log.odometry.len(), counted.odometry, "robot {robot}");
        assert_eq!(log.reference.len(), counted.reference, "robot {robot}");
        assert_eq!(log.sightings.len(), counted.sightings, "robot {robot}");
        assert_eq!(log.landmarks.len(), 15, "robot {robot}");
        let seen = |of: fn(&Target) -> bool| log.sightings.iter().filter(|s| of(&s.target)).count();
        assert_eq!(seen(|target| matches!(target, Target::Landmark(6..=20))), counted.landmarks);
        assert_eq!(seen(|target| matches!(target, Target::Robot(1..=5))), counted.robots);
        assert_eq!(seen(|target| matches!(target, Target::Unknown { .. })), counted.unknown);

        let duration = log.odometry.last().unwrap().time - log.odometry[0].time;
        assert!((duration - counted.odometry_duration).abs() < 1e-5, "robot {robot}: {duration} s");
        let path = path_length(&log.reference);
        assert!((path - counted.path).abs() < 1e-6, "robot {robot}: {path} m");
        let commanded: f64 =
            log.odometry.windows(2).map(|pair| pair[0].speed * (pair[1].time - pair[0].time)).sum();
        assert!((commanded - counted.commanded_path).abs() < 1e-6, "robot {robot}: {commanded} m");
    }
}

#[test]
fn unknown_robot_is_reported_with_the_present_ones() {
    let Some(folder) = recording("mrclam7") else { return };
    let error = mrclam::read(&folder, 6).unwrap_err();
    assert!(matches!(error.problem, Problem::UnknownRobot { expected: 6, .. }));
    assert!(
        error.to_string().ends_with("robot: not in this data set (got 6, expected one of 1, 2, 3, 4, 5)")
    );
}
