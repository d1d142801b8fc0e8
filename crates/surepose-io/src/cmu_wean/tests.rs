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

/// A scan line of a robot at (1, 2) m that looks north, its laser 25 cm ahead.
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
fn a_small_log_is_read() {
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
fn each_damage_of_a_log_names_line_and_remedy() {
    let message = |text: &str| read(text).unwrap_err().to_string();
    assert!(message("O 1 2 3\n").starts_with("log:1: expected 5 columns (O, x, y, heading, time), found 4"));
    assert!(message(&scan("1", 179, "1")).ends_with("found 187"));
    assert!(message(&scan("1", 181, "1")).ends_with("found 189"));
    assert!(message("L 1\n").ends_with("found 2"));
    assert!(message(&scan("NaN", 180, "1")).contains("column 8 (range) is not finite"));
    assert!(message(&scan("1", 180, "-1")).contains("column 188 (time) is '-1', outside"));
    assert!(message("O 1 2 3 4\nO 1 2 3 3\n").starts_with("log:2: time goes back"));
    assert!(message("X 1\n").starts_with("log:1: 'X' is not a record of this format; expected O or L"));
    assert!(message("O 1 2 3 4\n").starts_with("log: holds no L lines"));
}

#[test]
fn lines_of_a_grid_are_its_columns_and_values_mean_free() {
    let grid = grid(GRID).unwrap();
    assert_eq!((grid.width, grid.height), (2, 3));
    assert_eq!(grid.occupancy(0, 0), None);
    assert_eq!(grid.occupancy(0, 1), Some(1.0));
    assert_eq!(grid.occupancy(0, 2), Some(0.75));
    assert_eq!(grid.occupancy(1, 2), Some(0.0));
    assert_eq!(grid.cell_at(0.15, 0.75), Some((1, 2)));
}

#[test]
fn each_damage_of_a_grid_names_line_and_remedy() {
    let message = |text: &str| grid(text).unwrap_err().to_string();
    let damaged = |from: &str, to: &str| message(&GRID.replacen(from, to, 1));
    assert_eq!(damaged("0.250\n", "0.250 0\n"), "grid:7: declares 3 values per line, but holds 4");
    assert_eq!(damaged("1.000 1.000 1.000\n", ""), "grid: declares 2 lines of values, but holds 1");
    assert_eq!(message(&format!("{GRID}0 0 0\n")), "grid:9: declares 2 lines of values, but holds 3");
    assert!(
        damaged("0.250", "1.250").starts_with("grid:7: column 3 (probability of free) is '1.250', outside")
    );
    assert!(damaged("0.250", "inf").starts_with("grid:7: column 3 (probability of free) is not finite"));
    assert!(damaged("2 3", "99999 99999").starts_with("grid:6: a grid has 1 to"));
    assert!(damaged("2 3", "0 3").starts_with("grid:6: a grid has 1 to"));
    assert!(damaged("resolution  ", "size  ").contains("grid:6: holds no robot_specifications->resolution"));
    assert!(damaged("global_map[0]: 2 3", "hello").starts_with("grid:6: 'hello' is not a record"));
    assert!(message("").starts_with("grid: holds no line 'global_map[0]: width height'"));
}

proptest! {
    #[test]
    fn any_bytes_are_read_or_an_error(bytes in prop::collection::vec(any::<u8>(), 0..512)) {
        let _ = parse(LineReader::from_bytes(Path::new("log"), &bytes));
        let _ = parse_grid(LineReader::from_bytes(Path::new("grid"), &bytes));
        let tail = [GRID.as_bytes(), &bytes].concat();
        let _ = parse_grid(LineReader::from_bytes(Path::new("grid"), &tail));
    }
}
