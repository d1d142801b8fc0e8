use std::f64::consts::FRAC_PI_2;
use std::path::Path;

use proptest::prelude::*;

use crate::error::DataError;
use crate::grid::Grid;
use crate::lines::LineReader;
use crate::recording::{Recording, StampedPose};

use super::{parse, parse_grid};

fn read(text: &str) -> Result<Recording<StampedPose>, DataError> {
    parse(LineReader::from_bytes(Path::new("log"), text.as_bytes()))
}

fn grid(text: &str) -> Result<Grid, DataError> {
    parse_grid(LineReader::from_bytes(Path::new("grid"), text.as_bytes()))
}

/// Returns a scan line of a robot at (1, 2) m facing north, with its laser 25 cm forward.
fn scan(first: &str, ranges: usize, time: &str) -> String {
    let rest = vec!["150"; ranges - 1].join(" ");
    format!("L 100 200 {FRAC_PI_2} 100 225 {FRAC_PI_2} {first} {rest} {time}\n")
}

const GRID: &str = "\
robot_specifications->global_mapsize_x                 20
robot_specifications->resolution                       10
robot_specifications->autoshifted_x                    0
robot_specifications->autoshifted_y                    50

global_map[0]: 2 3
-1.000 0.000 0.250
1.000 1.000 1.000
";

#[test]
fn small_log_is_parsed() {
    let text = format!("O 100 200 0.5 0.25\n{}", scan("8183", 180, "0.5"));
    let recording = read(&text).unwrap();
    assert_eq!(recording.odometry, [StampedPose { time: 0.25, x: 1.0, y: 2.0, heading: 0.5 }]);
    let scan = &recording.scans[0];
    assert_eq!((scan.ranges.len(), scan.ranges[0], scan.ranges[1]), (180, f64::INFINITY, 1.5));
    assert!((scan.mount.x - 0.25).abs() + scan.mount.y.abs() + scan.mount.heading.abs() < 1e-12);
    assert!((scan.angle(90)).abs() < 1e-12);
    assert_eq!((scan.odometry_before, scan.odometry.unwrap().y), (1, 2.0));
}

#[test]
fn malformed_logs_name_line_and_problem() {
    let message = |text: &str| read(text).unwrap_err().to_string();
    assert!(
        message("O 1 2 3\n")
            .starts_with("log:1: columns: wrong number (got 4, expected 5: O, x, y, heading, time)")
    );
    assert!(message(&scan("1", 179, "1")).contains("(got 187, "));
    assert!(message(&scan("1", 181, "1")).contains("(got 189, "));
    assert!(message("L 1\n").contains("(got 2, "));
    assert!(message(&scan("NaN", 180, "1")).contains("column 8 (range): not finite"));
    assert!(message(&scan("1", 180, "-1")).contains("column 188 (time): out of range (got '-1',"));
    assert!(message("O 1 2 3 4\nO 1 2 3 3\n").starts_with("log:2: time: decreases"));
    assert!(message("X 1\n").starts_with("log:1: record: unknown (got 'X', expected O or L)"));
    assert!(message("O 1 2 3 4\n").starts_with("log: no L lines found"));
}

#[test]
fn grid_lines_are_columns_of_free_probabilities() {
    let grid = grid(GRID).unwrap();
    assert_eq!((grid.width, grid.height), (2, 3));
    assert_eq!(grid.occupancy(0, 0), None);
    assert_eq!(grid.occupancy(0, 1), Some(1.0));
    assert_eq!(grid.occupancy(0, 2), Some(0.75));
    assert_eq!(grid.occupancy(1, 2), Some(0.0));
    assert_eq!(grid.cell_at(0.15, 0.75), Some((1, 2)));
}

#[test]
fn malformed_grids_name_line_and_problem() {
    let message = |text: &str| grid(text).unwrap_err().to_string();
    let damaged = |from: &str, to: &str| message(&GRID.replacen(from, to, 1));
    assert_eq!(
        damaged("0.250\n", "0.250 0\n"),
        "grid:7: values per line: wrong count (got 4, expected 3 as declared)"
    );
    assert_eq!(
        damaged("1.000 1.000 1.000\n", ""),
        "grid: lines of values: wrong count (got 1, expected 2 as declared)"
    );
    assert_eq!(
        message(&format!("{GRID}0 0 0\n")),
        "grid:9: lines of values: wrong count (got 3, expected 2 as declared)"
    );
    assert!(
        damaged("0.250", "1.250")
            .starts_with("grid:7: column 3 (probability of free): out of range (got '1.250',")
    );
    assert!(damaged("0.250", "inf").starts_with("grid:7: column 3 (probability of free): not finite"));
    assert!(damaged("2 3", "99999 99999").starts_with("grid:6: grid: invalid size"));
    assert!(damaged("2 3", "0 3").starts_with("grid:6: grid: invalid size"));
    assert!(damaged("resolution  ", "size  ").contains("grid:6: no robot_specifications->resolution found"));
    assert!(damaged("global_map[0]: 2 3", "hello").starts_with("grid:6: record: unknown (got 'hello'"));
    assert!(message("").starts_with("grid: no line 'global_map[0]: width height' found"));
}

proptest! {
    #[test]
    fn any_bytes_give_a_result_or_an_error(bytes in prop::collection::vec(any::<u8>(), 0..512)) {
        let _ = parse(LineReader::from_bytes(Path::new("log"), &bytes));
        let _ = parse_grid(LineReader::from_bytes(Path::new("grid"), &bytes));
        let tail = [GRID.as_bytes(), &bytes].concat();
        let _ = parse_grid(LineReader::from_bytes(Path::new("grid"), &tail));
    }
}
