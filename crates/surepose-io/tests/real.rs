//! Compares the parsers on recordings of real robots with figures computed independently with numpy.
//!
//! The recordings are not part of this repository. The tests read them from `$SUREPOSE_DATA`, else from
//! `../shared/data` beside the workspace, and print a message if they are absent.

mod real {
    mod carmen;
    mod cmu_wean;
    mod mines_rover;
    mod mrclam;
}

use surepose_io::map_server;
use surepose_io::recording::StampedPose;
use surepose_testdata::recording;

/// Returns the length of the path through `poses` \[m\].
fn path_length(poses: &[StampedPose]) -> f64 {
    poses.windows(2).map(|pair| (pair[1].x - pair[0].x).hypot(pair[1].y - pair[0].y)).sum()
}

#[test]
fn cell_counts_match_numpy() {
    // Size, then occupied, free and unknown cells.
    let found = [
        ("turtlebot3_world", (384, 384), (-10.0, -10.0, 0.0), (870, 7903, 138_683)),
        ("nav2_depot", (604, 307), (0.0, 0.0, 0.0), (5947, 179_481, 0)),
        ("nav2_tb3_sandbox", (384, 384), (-10.0, -10.0, 0.0), (870, 7903, 138_683)),
        ("aws_small_house_map", (500, 500), (-12.5, -12.5, 0.0), (3442, 63021, 183_537)),
    ];
    for (name, size, origin, cells) in found {
        let Some(path) = recording(&format!("maps/{name}.yaml")) else { continue };
        let (grid, renamed) = map_server::read(&path).unwrap();
        // Three maps were renamed without editing the image name in the YAML file.
        assert_eq!(renamed.is_some(), !name.starts_with("turtlebot3"), "{name}: {renamed:?}");
        assert_eq!((grid.width, grid.height), size, "{name}");
        assert!((grid.resolution - 0.05).abs() < 1e-15, "{name}");
        assert_eq!((grid.origin.x, grid.origin.y, grid.origin.heading), origin, "{name}");
        let count = |expected| grid.cells.iter().filter(|&&cell| cell == expected).count();
        assert_eq!((count(Some(1.0)), count(Some(0.0)), count(None)), cells, "{name}");
    }
}
