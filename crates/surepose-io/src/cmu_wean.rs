//! Reads the CMU Wean Hall data: odometry, laser scans and an occupancy grid, from a course on robotics.
//!
//! A log has two kinds of lines, with lengths in centimeters and angles in radians:
//!
//! | line | meaning |
//! |---|---|
//! | `O x y θ t` | odometry pose |
//! | `L x y θ x' y' θ' r1..r180 t` | odometry pose of the robot and of its laser, interpolated; 180 ranges over 180°, counter-clockwise |
//!
//! The poses on `L` lines lag those on `O` lines by 0.05 to 0.1 s, so both are kept separately: [`ScanRecord::odometry`]
//! and [`Recording::odometry`].
//!
//! The grid is a text file: a header, then one line per **x** index, ascending, with one value per y index. A value is the
//! probability that the cell is *free*, although the notes of the data say *occupied*; −1 is unknown. The scans confirm
//! both: eight scans, placed at their best poses on the grid as read here, lie 2.5 cm from the nearest wall (mean, capped
//! at 0.5 m), and 4.2 cm on the mirrored grid.

use std::ops::Range;
use std::path::Path;

use surepose::geometry::{Angle, Body, Laser, Map, Pose};

use crate::error::{DataError, Problem, excerpt};
use crate::grid::{Grid, GridOrigin, MAX_CELLS};
use crate::half_circle;
use crate::lines::{Clock, Field, LineReader, TextLine};
use crate::quantity::{ANGLE, POSITION, PROBABILITY, RESOLUTION};
use crate::recording::{Recording, ScanRecord, SensorPose, StampedPose};

const CENTIMETER: f64 = 0.01;
const BEAMS: usize = 180;
/// The value of an unknown cell in the grid file.
const UNKNOWN: f64 = -1.0;
const SCAN_COLUMNS: usize = BEAMS + 8;

/// Ranges that count as returns \[m\]: the laser reports 81.83 m or 81.91 m without a return.
const RETURNS: Range<f64> = f64::MIN_POSITIVE..81.83;

/// Reads a log, plain or compressed.
///
/// # Errors
/// A missing, unreadable or malformed file, with name and line.
pub fn read(path: &Path) -> Result<Recording<StampedPose>, DataError> {
    parse(LineReader::open(path)?)
}

/// Parses the lines of a log.
///
/// # Errors
/// A malformed line, with its number, or a log without scans.
pub fn parse(mut lines: LineReader<'_>) -> Result<Recording<StampedPose>, DataError> {
    let mut recording = Recording::default();
    let mut clock = Clock::default();
    while let Some(line) = lines.next_record()? {
        let columns = line.all_columns();
        match columns.first().map(Field::text) {
            Some(b"O") => recording.odometry.push(odometry(line, &mut clock)?),
            Some(b"L") => {
                let before = recording.odometry.len();
                recording.scans.push(scan(line, &columns, &mut clock, before)?);
            }
            name => {
                let found = excerpt(name.unwrap_or_default());
                return Err(line.error(Problem::UnknownRecord { found, expected: "O or L" }));
            }
        }
    }
    if recording.scans.is_empty() {
        return Err(lines.error(Problem::Empty { what: "L lines" }));
    }
    Ok(recording)
}

fn odometry(line: TextLine<'_>, clock: &mut Clock) -> Result<StampedPose, DataError> {
    let [_name, x, y, heading, time] = line.split("O, x, y, heading, time")?;
    Ok(stamped(clock.stamp(time, 1.0)?, pose::<Body>([&x, &y, &heading])?))
}

fn scan(
    line: TextLine<'_>,
    columns: &[Field<'_>],
    clock: &mut Clock,
    odometry_before: usize,
) -> Result<ScanRecord, DataError> {
    let [_name, x, y, heading, laser_x, laser_y, laser_heading, ranges @ .., time] = columns else {
        return Err(wrong_columns(line, columns.len()));
    };
    if ranges.len() != BEAMS {
        return Err(wrong_columns(line, columns.len()));
    }
    let time = clock.stamp(*time, 1.0)?;
    let odometry_from_body = pose::<Body>([x, y, heading])?;
    let odometry_from_laser = pose::<Laser>([laser_x, laser_y, laser_heading])?;
    let body_from_laser = odometry_from_body.inverse() * odometry_from_laser;
    let (angle_min, angle_increment) = half_circle::beams(BEAMS);
    let ranges = ranges.iter().map(|range| range.laser_range(CENTIMETER, &RETURNS));
    Ok(ScanRecord {
        time,
        angle_min,
        angle_increment,
        ranges: ranges.collect::<Result<_, _>>()?,
        mount: SensorPose {
            x: body_from_laser.x,
            y: body_from_laser.y,
            heading: body_from_laser.heading.radians(),
        },
        odometry: Some(stamped(time, odometry_from_body)),
        odometry_before,
    })
}

fn wrong_columns(line: TextLine<'_>, found: usize) -> DataError {
    let layout = "L, robot x, y, heading, laser x, y, heading, 180 ranges, time";
    line.error(Problem::Columns { expected: SCAN_COLUMNS, found, layout })
}

/// Reads a pose in the odometry frame, a map frame that drifts.
fn pose<From: surepose::geometry::Frame>(
    [x, y, heading]: [&Field<'_>; 3],
) -> Result<Pose<Map, From, f64>, DataError> {
    let x = x.read_in("x", &POSITION, CENTIMETER)?;
    let y = y.read_in("y", &POSITION, CENTIMETER)?;
    Ok(Pose::new(x, y, Angle::from_radians(heading.read("heading", &ANGLE)?)))
}

fn stamped(time: f64, pose: Pose<Map, Body, f64>) -> StampedPose {
    StampedPose { time, x: pose.x, y: pose.y, heading: pose.heading.radians() }
}

/// Reads a grid, plain or compressed.
///
/// # Errors
/// A missing, unreadable or malformed file, with name and line.
pub fn read_grid(path: &Path) -> Result<Grid, DataError> {
    parse_grid(LineReader::open(path)?)
}

/// Parses the lines of a grid.
///
/// # Errors
/// A malformed header, or a wrong number of lines or values, with the line number.
pub fn parse_grid(mut lines: LineReader<'_>) -> Result<Grid, DataError> {
    let header = parse_header(&mut lines)?;
    let Header { width, height, .. } = header;
    // The file is transposed with respect to [`Grid`]: each of its lines is a column.
    let mut columns: Vec<Vec<Option<f32>>> = Vec::new();
    while let Some(line) = lines.next_record()? {
        let column = line.columns().map(|value| occupancy(&value)).collect::<Result<Vec<_>, _>>()?;
        if column.len() != height {
            let (declared, found) = (height as u64, column.len() as u64);
            return Err(line.error(Problem::Count { what: "values per line", declared, found }));
        }
        if columns.len() == width {
            let (declared, found) = (width as u64, width as u64 + 1);
            return Err(line.error(Problem::Count { what: "lines of values", declared, found }));
        }
        columns.push(column);
    }
    if columns.len() != width {
        let (declared, found) = (width as u64, columns.len() as u64);
        return Err(lines.error(Problem::Count { what: "lines of values", declared, found }));
    }
    let cells = (0..height).flat_map(|row| columns.iter().map(move |column| column[row])).collect();
    Ok(Grid { width, height, resolution: header.resolution, origin: header.origin, cells })
}

/// The header of a grid file.
struct Header {
    width: usize,
    height: usize,
    resolution: f64,
    origin: GridOrigin,
}

/// Reads up to `global_map[0]: width height`, the last line before the values.
fn parse_header(lines: &mut LineReader<'_>) -> Result<Header, DataError> {
    let (mut resolution, mut origin) = (None, GridOrigin::default());
    while let Some(line) = lines.next_record()? {
        let columns = line.all_columns();
        match columns.as_slice() {
            [name, width, height] if name.text() == b"global_map[0]:" => {
                let (width, height) = (width.whole("width")?, height.whole("height")?);
                let cells = usize::checked_mul(width, height).filter(|cells| (1..=MAX_CELLS).contains(cells));
                if cells.is_none() {
                    let message = format!(
                        "grid: invalid size (got {width} × {height} cells, expected 1 to {MAX_CELLS} cells)"
                    );
                    return Err(line.error(Problem::Document { message }));
                }
                let missing = || line.error(Problem::Empty { what: "robot_specifications->resolution" });
                return Ok(Header { width, height, resolution: resolution.ok_or_else(missing)?, origin });
            }
            [name, value] => match name.text().strip_prefix(b"robot_specifications->") {
                Some(b"resolution") => {
                    resolution = Some(value.read_in("resolution", &RESOLUTION, CENTIMETER)?);
                }
                Some(b"autoshifted_x") => origin.x = value.read_in("x shift", &POSITION, CENTIMETER)?,
                Some(b"autoshifted_y") => origin.y = value.read_in("y shift", &POSITION, CENTIMETER)?,
                Some(_) => {}
                None => return Err(unknown_header(line)),
            },
            _ => return Err(unknown_header(line)),
        }
    }
    Err(lines.error(Problem::Empty { what: "line 'global_map[0]: width height'" }))
}

fn unknown_header(line: TextLine<'_>) -> DataError {
    let found = excerpt(line.text());
    line.error(Problem::UnknownRecord { found, expected: "robot_specifications-> or global_map[0]:" })
}

/// Converts the probability of free space to occupancy; −1 is unknown and gives `None`.
fn occupancy(value: &Field<'_>) -> Result<Option<f32>, DataError> {
    let free = value.finite("probability of free")?;
    if free.to_bits() == UNKNOWN.to_bits() {
        return Ok(None);
    }
    Ok(Some(1.0 - value.read("probability of free", &PROBABILITY)? as f32))
}

#[cfg(test)]
mod tests;
