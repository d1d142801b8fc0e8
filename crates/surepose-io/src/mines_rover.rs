//! Reads wheel ticks and laser scans: the `mines_rover` recordings of the `BreezySLAM` project.
//!
//! Each line has one record of space-separated columns, counted from 0; other columns are not read:
//!
//! | column | meaning |
//! |---|---|
//! | 0 | time \[µs\] |
//! | 2, 3 | left and right wheel counter \[ticks\] |
//! | 24–705 | 682 ranges \[mm\], counter-clockwise |
//! | 706 | optional 683rd range, which `BreezySLAM` drops; 0 in both recordings |
//!
//! The laser is a Hokuyo URG-04LX. A range under 20 mm is an error code (0, 1, 2, 6, 7, 8, 10 and 15 occur) and counts
//! as no return. The angular step is 1/1024 turn; steps 44 to 725 are reported, and step 384 points forward.

use std::f64::consts::TAU;
use std::ops::Range;
use std::path::Path;

use crate::error::{DataError, Problem};
use crate::lines::{Clock, Field, LineReader};
use crate::recording::{Recording, ScanRecord, SensorPose, StampedTicks};

/// The dimensions of the rover, from its manufacturer.
pub const ROVER: Rover = Rover {
    wheel_radius: 0.077,
    wheel_separation: 0.330,
    ticks_per_turn: 2000.0,
    mount: SensorPose { x: 0.145, y: 0.0, heading: 0.0 },
};

/// Dimensions of a rover, for the conversion of ticks to meters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rover {
    /// Radius of both wheels \[m\].
    pub wheel_radius: f64,
    /// Distance between the wheels \[m\].
    pub wheel_separation: f64,
    /// Ticks per turn of a wheel.
    pub ticks_per_turn: f64,
    /// Pose of the laser in the robot frame.
    pub mount: SensorPose,
}

const MICROSECOND: f64 = 1e-6;
const MILLIMETER: f64 = 1e-3;
const TURN_STEPS: f64 = 1024.0;
const STEP_AHEAD: f64 = 384.0;
const FIRST_STEP: f64 = 44.0;
const RANGES: Range<usize> = 24..706;
const LAYOUT: &str = "time, -, left, right, 20 others, 682 or 683 ranges";

/// Ranges that count as returns \[m].
const RETURNS: Range<f64> = 0.020..f64::INFINITY;

/// Reads a recording, plain or compressed.
///
/// # Errors
/// A missing, unreadable or malformed file, with name and line.
pub fn read(path: &Path) -> Result<Recording<StampedTicks>, DataError> {
    parse(LineReader::open(path)?)
}

/// Parses the lines of a recording.
///
/// # Errors
/// A malformed line, with its number, or a recording without lines.
pub fn parse(mut lines: LineReader<'_>) -> Result<Recording<StampedTicks>, DataError> {
    let mut recording = Recording::default();
    let mut clock = Clock::default();
    while let Some(line) = lines.next_record()? {
        let columns = line.all_columns();
        let found = columns.len();
        let layout = || line.error(Problem::Columns { expected: RANGES.end + 1, found, layout: LAYOUT });
        let ([time, _, left, right, ..], Some(ranges)) = (columns.as_slice(), columns.get(RANGES)) else {
            return Err(layout());
        };
        if found > RANGES.end + 1 {
            return Err(layout());
        }
        let time = clock.stamp(*time, MICROSECOND)?;
        let left = ticks(left, "left ticks")?;
        let right = ticks(right, "right ticks")?;
        let ranges = ranges.iter().map(|range| range.laser_range(MILLIMETER, &RETURNS));
        let ranges = ranges.collect::<Result<_, _>>()?;
        recording.odometry.push(StampedTicks { time, left, right });
        recording.scans.push(ScanRecord {
            time,
            angle_min: (FIRST_STEP - STEP_AHEAD) * TAU / TURN_STEPS,
            angle_increment: TAU / TURN_STEPS,
            ranges,
            mount: ROVER.mount,
            odometry: None,
            odometry_before: recording.odometry.len(),
        });
    }
    if recording.scans.is_empty() {
        return Err(lines.error(Problem::Empty { what: "lines of ticks and ranges" }));
    }
    Ok(recording)
}

fn ticks(column: &Field<'_>, name: &'static str) -> Result<i64, DataError> {
    column.whole::<i32>(name).map(i64::from)
}

#[cfg(test)]
mod tests;
