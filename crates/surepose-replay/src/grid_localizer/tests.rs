//! Global localization in a corridor with identical bays, on synthetic grids and scans.

use surepose::geometry::{Angle, Body, Map, Point, Pose};
use surepose::kinematics::{Integration, Motion};
use surepose_io::grid::{Grid, GridOrigin};
use surepose_io::recording::{ScanRecord, SensorPose};

use crate::{LaserReplaySettings, cmu_wean};

use super::GridLocalizer;

const SIDE: f64 = 0.1;
/// Maximum range \[m]; shorter than the corridor.
const SIGHT: f64 = 8.0;
/// Length of a bay with its doorway \[m].
const BAY: f64 = 6.0;
const BAYS: usize = 8;

/// Builds a corridor of equal bays along x, with a doorway in each on one side, and additional solid cells.
fn corridor(is_solid: impl Fn(f64, f64) -> bool) -> Grid {
    let (width, height) = ((BAYS as f64 * BAY / SIDE) as usize, 60);
    let cell = |k: usize| {
        let at = |k: usize| (k as f64 + 0.5) * SIDE;
        let (x, y) = (at(k % width), at(k / width));
        let in_bay = x % BAY;
        let doorway = (2.0..3.2).contains(&in_bay) && (3.9..4.5).contains(&y);
        let open = (1.5..3.9).contains(&y) || doorway;
        Some(f32::from(u8::from(!open || is_solid(x, y))))
    };
    // The corridor is rotated in the map.
    let origin = GridOrigin { x: -7.0, y: 3.0, heading: 0.4 };
    Grid { width, height, resolution: SIDE, origin, cells: (0..width * height).map(cell).collect() }
}

/// Simulates a scan in a grid from `pose`.
fn scan(grid: &Grid, map_from_body: Pose<Map, Body, f64>) -> ScanRecord {
    let ranges = (0..90).map(|number| {
        let (sin, cos) = (f64::from(number).to_radians() * 2.0 - std::f64::consts::FRAC_PI_2).sin_cos();
        let solid = |range: f64| {
            let end = map_from_body * Point::new(range * cos, range * sin);
            let cell = grid.cell_at(end.x, end.y).and_then(|(column, row)| grid.occupancy(column, row));
            cell.is_none_or(|occupancy| occupancy > 0.5)
        };
        let range =
            (1..1000).map(|step| f64::from(step) * 0.02).find(|range| *range > SIGHT || solid(*range));
        range.filter(|range| *range <= SIGHT).unwrap_or(f64::INFINITY)
    });
    ScanRecord {
        time: 0.0,
        angle_min: -std::f64::consts::FRAC_PI_2,
        angle_increment: 2.0_f64.to_radians(),
        ranges: ranges.collect(),
        mount: SensorPose::default(),
        odometry: None,
        odometry_before: 0,
    }
}

/// Drives from the middle of `world` through adjacent bays and back, with `known` as the map. Returns the
/// localizer and the true pose.
fn driven(world: &Grid, known: &Grid) -> (GridLocalizer, Pose<Map, Body, f64>) {
    let settings: LaserReplaySettings = cmu_wean::settings(&cmu_wean::preset());
    let mut grid_localizer = GridLocalizer::new(known, settings);
    let start = Pose::new(0.5 * BAYS as f64 * BAY - 2.0, 2.6, Angle::from_radians(0.05));
    let mut pose = world.map_from_cells() * start;
    let legs = [(0.1, 0.0, 80), (0.02, 0.06, 52), (0.1, 0.0, 80)];
    for (length, turn, steps) in legs {
        for _ in 0..steps {
            grid_localizer.update(&scan(world, pose));
            let motion = Motion { length, turn };
            pose = pose.integrate(motion, Integration::Arc);
            // Odometry has a scale error of 1 %.
            grid_localizer.predict(Motion { length: 1.01 * length, turn });
        }
    }
    grid_localizer.update(&scan(world, pose));
    (grid_localizer, pose)
}

#[test]
fn cupboards_disambiguate_the_pose() {
    let cupboards = |x: f64, y: f64| (26.0..30.0).contains(&x) && y < 2.1;
    let grid = corridor(cupboards);
    let (grid_localizer, truth) = driven(&grid, &grid);
    let found = grid_localizer.found().expect("a unique pose beside the cupboards");
    let turned = (found.heading - truth.heading).radians().abs();
    assert!(found.origin().distance(truth.origin()) < 0.2 && turned < 0.05, "{found:?} is not {truth:?}");
    assert!(grid_localizer.shares().is_some_and(|shares| shares.hits > 0.95 && shares.behind_wall < 0.01));
    assert!(!grid_localizer.is_inconsistent());
}

#[test]
fn identical_bays_remain_ambiguous() {
    let grid = corridor(|_, _| false);
    let (grid_localizer, truth) = driven(&grid, &grid);
    assert_eq!(grid_localizer.found(), None);
    let candidates = grid_localizer.candidates();
    assert!(candidates.len() >= 3, "{candidates:?}");
    assert!(candidates.iter().any(|place| place.origin().distance(truth.origin()) < 0.3), "{candidates:?}");
}

/// On the map one bay has no doorway, in the world all have: this difference must not determine the pose.
#[test]
fn a_door_that_differs_from_the_map_does_not_decide() {
    let (world, known) = (corridor(|_, _| false), corridor(|x, y| (25.5..28.0).contains(&x) && y > 3.9));
    assert_eq!(driven(&world, &known).0.found(), None);
}

/// The map is of another building.
#[test]
fn no_pose_is_found_when_no_hypothesis_fits() {
    let world = corridor(|x, y| (26.0..30.0).contains(&x) && y < 2.1);
    let known = corridor(|x, y| y > 2.6 + 0.1 * (x % 3.0) || y < 1.8);
    assert_eq!(driven(&world, &known).0.found(), None);
}

#[test]
fn an_unknown_map_has_no_pose() {
    let world = corridor(|_, _| false);
    let mut known = world.clone();
    known.cells.fill(None);
    let (grid_localizer, _) = driven(&world, &known);
    assert!(
        grid_localizer.found().is_none()
            && grid_localizer.shares().is_none()
            && grid_localizer.candidates().is_empty()
    );
}

/// Repeated observations add no evidence.
#[test]
fn a_surface_cell_counts_once() {
    let (world, known) = (corridor(|_, _| false), corridor(|x, y| (25.5..28.0).contains(&x) && y > 3.9));
    let mut grid_localizer = GridLocalizer::new(&known, cmu_wean::settings(&cmu_wean::preset()));
    let seen = scan(&world, world.map_from_cells() * Pose::new(24.0, 2.6, Angle::zero()));
    let mut spread = Vec::new();
    for _ in 0..3 {
        assert!(grid_localizer.update(&seen));
        spread.push(
            grid_localizer.hypotheses.last().map_or(0.0, |last| last.evidence)
                - grid_localizer.hypotheses[0].evidence,
        );
        // One full turn in place.
        (0..72)
            .for_each(|_| grid_localizer.predict(Motion { length: 0.0, turn: std::f64::consts::TAU / 72.0 }));
    }
    assert!(grid_localizer.hypotheses.len() > 10 && spread[0] < -1.0);
    let grown = spread[2] / spread[0];
    assert!(grown < 1.3, "three equal scans have {grown} times the evidence of one");
}
