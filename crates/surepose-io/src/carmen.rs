//! Reads CARMEN laser logs corrected by SLAM: scans with reference poses, and raw odometry between them.
//!
//! Each line is one message; its first word is the name:
//!
//! | line | meaning |
//! |---|---|
//! | `FLASER n r1..rn x y θ x' y' θ' t host t` | n ranges \[m\] over 180°, counter-clockwise; corrected pose; robot pose |
//! | `ODOM x y θ v ω a t host t` | odometry pose |
//! | `#…`, `PARAM`, `NEFF`, any other upper-case word | ignored |
//!
//! # Raw odometry
//! After every `FLASER` line, the SLAM program wrote an `ODOM` line that repeats the corrected pose, with a stamp from
//! uninitialized memory (0, 1e−91, even −2.9). Such a line resets odometry to that pose and is no motion. The motions
//! between successive `ODOM` lines are concatenated from the first one on; the result is the odometry before correction.
//!
//! # Laser position
//! The pose on a `FLASER` line is used as the pose of the laser: [`ScanRecord::mount`] is zero, and the parameter
//! `robot_frontlaser_offset` is ignored. In `freiburg-101`, where it is −0.04 m, the map of all scans is sharpest without
//! it (entropy over 6 cm cells: 8.668 without, 8.817 with; 9.226 and 9.329 in `belgioioso`).
//! # Stamps
//! Some logs, for example `belgioioso`, have stamps rounded to hours. [`ScanRecord::odometry`] and
//! [`ScanRecord::odometry_before`] associate scans with odometry without stamps.

use std::ops::Range;
use std::path::Path;

use surepose::geometry::{Angle, Body, Map, Pose};

use crate::error::{DataError, Problem, excerpt};
use crate::half_circle;
use crate::lines::{Clock, Field, LineReader, TextLine};
use crate::quantity::{ANGLE, POSITION};
use crate::recording::{Recording, ScanRecord, SensorPose, StampedPose};

/// Ranges that count as returns \[m\]. Without a return the laser reports 81.9 m; values from 50 m to that are beyond its
/// rated range.
const RETURNS: Range<f64> = f64::MIN_POSITIVE..50.0;

/// Number of columns of a `FLASER` line that are not ranges.
const FLASER_OTHERS: usize = 11;

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
    let mut log = Log::default();
    while let Some(line) = lines.next_record()? {
        let columns = line.all_columns();
        match columns.split_first() {
            Some((name, values)) if name.text() == b"FLASER" => log.flaser(line, values)?,
            Some((name, _)) if name.text() == b"ODOM" => log.odom(line)?,
            Some((name, _)) if is_message_name(name.text()) => {}
            _ => {
                let found = excerpt(line.text());
                return Err(line.error(Problem::UnknownRecord { found, expected: "FLASER, ODOM, PARAM, …" }));
            }
        }
    }
    if log.recording.scans.is_empty() {
        return Err(lines.error(Problem::Empty { what: "FLASER lines" }));
    }
    Ok(log.recording)
}

/// Returns whether `word` is a CARMEN message name: upper-case letters, digits and dashes.
fn is_message_name(word: &[u8]) -> bool {
    word.first().is_some_and(u8::is_ascii_uppercase)
        && word.iter().all(|c| c.is_ascii_uppercase() || c.is_ascii_digit() || matches!(c, b'-' | b'_'))
}

/// The recording so far, with the state for concatenating odometry.
struct Log {
    recording: Recording<StampedPose>,
    odometry_clock: Clock,
    scan_clock: Clock,
    /// Pose of the previous `ODOM` line.
    previous: Option<MapFromBody>,
    /// That pose in raw odometry.
    raw: Option<MapFromBody>,
    /// Corrected pose of a `FLASER` line, until the following `ODOM` line is read.
    corrected: Option<MapFromBody>,
}

/// A pose of the log. Its frame is the map for corrected poses; for raw poses it drifts from the map.
type MapFromBody = Pose<Map, Body, f64>;

impl Default for Log {
    fn default() -> Self {
        let recording = Recording { odometry: Vec::new(), scans: Vec::new(), reference: Vec::new() };
        let (odometry_clock, scan_clock) = (Clock::default(), Clock::default());
        Self { recording, odometry_clock, scan_clock, previous: None, raw: None, corrected: None }
    }
}

impl Log {
    fn flaser(&mut self, line: TextLine<'_>, values: &[Field<'_>]) -> Result<(), DataError> {
        let Some((count, values)) = values.split_first() else {
            return Err(too_few(line, 1));
        };
        let declared: u64 = count.whole("number of ranges")?;
        let found = (2 + values.len()).checked_sub(FLASER_OTHERS);
        let found = found.ok_or_else(|| too_few(line, 2 + values.len()))?;
        if declared != found as u64 {
            return Err(line.error(Problem::Count { what: "ranges", declared, found: found as u64 }));
        }
        if found == 0 {
            return Err(line.error(Problem::Empty { what: "ranges" }));
        }
        let (ranges, rest) = values.split_at(found);
        let [x, y, heading, .., time, _host, _log_time] = rest else {
            return Err(too_few(line, 2 + values.len()));
        };
        let time = self.scan_clock.stamp(*time, 1.0)?;
        let ranges = ranges.iter().map(|range| range.laser_range(1.0, &RETURNS)).collect::<Result<_, _>>()?;
        let corrected = place(x, y, heading)?;
        let (angle_min, angle_increment) = half_circle::beams(found);
        self.recording.reference.push(stamped(time, corrected));
        self.recording.scans.push(ScanRecord {
            time,
            angle_min,
            angle_increment,
            ranges,
            mount: SensorPose::default(),
            odometry: self.raw.map(|raw| stamped(time, raw)),
            odometry_before: self.recording.odometry.len(),
        });
        self.corrected = Some(corrected);
        Ok(())
    }

    fn odom(&mut self, line: TextLine<'_>) -> Result<(), DataError> {
        let [_name, x, y, heading, _v, _w, _a, time, _host, _log_time] =
            line.split("ODOM, x, y, heading, v, w, acceleration, time, host, log time")?;
        let here = place(&x, &y, &heading)?;
        if self.corrected.take() == Some(here) {
            self.previous = Some(here);
            self.raw.get_or_insert(here);
            return Ok(());
        }
        let raw = match (self.raw, self.previous) {
            (Some(raw), Some(previous)) => raw * (previous.inverse() * here),
            _ => here,
        };
        let time = self.odometry_clock.stamp(time, 1.0)?;
        self.recording.odometry.push(stamped(time, raw));
        (self.previous, self.raw) = (Some(here), Some(raw));
        Ok(())
    }
}

fn too_few(line: TextLine<'_>, found: usize) -> DataError {
    let layout = "FLASER, number of ranges, ranges, x, y, heading, x, y, heading, time, host, log time";
    line.error(Problem::Columns { expected: FLASER_OTHERS + 1, found, layout })
}

fn place(x: &Field<'_>, y: &Field<'_>, heading: &Field<'_>) -> Result<MapFromBody, DataError> {
    let heading = Angle::from_radians(heading.read("heading", &ANGLE)?);
    Ok(Pose::new(x.read("x", &POSITION)?, y.read("y", &POSITION)?, heading))
}

fn stamped(time: f64, place: MapFromBody) -> StampedPose {
    StampedPose { time, x: place.x, y: place.y, heading: place.heading.radians() }
}

#[cfg(test)]
mod tests;
