//! Reads CARMEN laser logs corrected by SLAM: scans with reference poses, and raw odometry between them.
//!
//! Each line is one message; its first word is the name:
//!
//! | line | meaning |
//! |---|---|
//! | `FLASER n r1..rn x y θ x' y' θ' t host t` | n ranges \[m\] over 180°, counter-clockwise; corrected pose; robot pose |
//! | `ROBOTLASER1 type first fov step max … n r1..rn m i1..im x y θ x' y' θ' … t host t` | the same, with the laser's angles |
//! | `RAWLASER1 type first fov step max … n r1..rn m i1..im t host t` | the same without a pose |
//! | `ODOM x y θ … t host t` | odometry pose, with any number of columns |
//! | `#…`, `PARAM`, `NEFF`, any other upper-case word | ignored |
//!
//! # Raw odometry
//! After every scan line, the SLAM program wrote an `ODOM` line that repeats the corrected pose, with a stamp from
//! uninitialized memory (0, 1e−91, even −2.9). Such a line resets odometry to that pose and is no motion. The motions
//! between successive `ODOM` lines are concatenated from the first one on; the result is the odometry before correction.
//! After a `RAWLASER1` line, such a line is recognized by its stamp, which precedes that of the scan, and its pose is the
//! scan's reference.
//!
//! # Laser position
//! The pose on a scan line is used as the pose of the laser: [`ScanRecord::mount`] is zero, and the parameter
//! `robot_frontlaser_offset` is ignored. In `freiburg-101`, where it is −0.04 m, the map of all scans is sharpest without
//! it (entropy over 6 cm cells: 8.668 without, 8.817 with; 9.226 and 9.329 in `belgioioso`).
//!
//! # Stamps
//! The order of the lines is the order of the records. Stamps that step back, are below 0 or are absent are counted in
//! [`Recording::irregular`]; see `LineClock` for the time that replaces them. Some logs, for example `belgioioso`, have stamps
//! rounded to hours. [`ScanRecord::odometry`] and [`ScanRecord::odometry_before`] associate scans with odometry without stamps.
//!
//! # Scans of both kinds
//! A `RAWLASER1` line with the ranges of the preceding scan line, or followed by a line with its ranges, is the same scan. Scans
//! without a reference are left out, and counted, if others have one.

mod scan_line;

use std::path::Path;

use crate::error::{DataError, Problem, excerpt};
use crate::lines::{Field, LineClock, LineReader, TextLine};
use crate::recording::{Recording, ScanRecord, SensorPose, StampedPose};

use scan_line::{MapFromBody, ScanLine, pose};

/// Stamps nearer to 0 than this are from uninitialized memory \[s\].
const UNSET: f64 = 1e-3;

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
/// A malformed line, with its number, or a log without scans. A log without odometry is valid, for example for mapping.
pub fn parse(mut lines: LineReader<'_>) -> Result<Recording<StampedPose>, DataError> {
    let mut log = Log::default();
    while let Some(line) = lines.next_record()? {
        let columns = line.all_columns();
        match columns.split_first() {
            Some((name, values)) if name.text() == b"FLASER" => {
                log.scan(ScanLine::from_flaser(line, values)?)?;
            }
            Some((name, values)) if name.text() == b"ROBOTLASER1" => {
                log.scan(ScanLine::from_laser1(line, values, true)?)?;
            }
            Some((name, values)) if name.text() == b"RAWLASER1" => {
                log.scan(ScanLine::from_laser1(line, values, false)?)?;
            }
            Some((name, values)) if name.text() == b"ODOM" => log.odom(line, values)?,
            Some((name, _)) if is_message_name(name.text()) => {}
            _ => {
                let found = excerpt(line.text());
                let expected = "FLASER, ROBOTLASER1, RAWLASER1, ODOM, PARAM, …";
                return Err(line.error(Problem::UnknownRecord { found, expected }));
            }
        }
    }
    if log.recording.scans.is_empty() {
        let what = if log.recording.odometry.is_empty() {
            "odometry (ODOM lines) and no scans (FLASER, ROBOTLASER1 or RAWLASER1 lines)"
        } else {
            "scans (FLASER, ROBOTLASER1 or RAWLASER1 lines)"
        };
        return Err(lines.error(Problem::Empty { what }));
    }
    Ok(log.finish())
}

/// Returns whether `word` is a CARMEN message name: upper-case letters, digits and dashes.
fn is_message_name(word: &[u8]) -> bool {
    word.first().is_some_and(u8::is_ascii_uppercase)
        && word.iter().all(|c| c.is_ascii_uppercase() || c.is_ascii_digit() || matches!(c, b'-' | b'_'))
}

/// The recording so far, with the state for concatenating odometry.
#[derive(Default)]
struct Log {
    recording: Recording<StampedPose>,
    /// Reference pose of each scan; `None` of a `RAWLASER1` line without one.
    poses: Vec<Option<MapFromBody>>,
    odometry_clock: LineClock,
    scan_clock: LineClock,
    /// Pose of the previous `ODOM` line.
    previous: Option<MapFromBody>,
    /// That pose in raw odometry.
    raw: Option<MapFromBody>,
    /// Stamp of a scan line, until the following `ODOM` line is read.
    awaited: Option<f64>,
}

impl Log {
    fn scan(&mut self, scan: ScanLine<'_>) -> Result<(), DataError> {
        let ScanLine { ranges, angles: (angle_min, angle_increment), pose, time } = scan;
        self.awaited = Some(time.finite("time")?);
        if let (Some(last), Some(last_pose)) = (self.recording.scans.last(), self.poses.last_mut())
            && (last_pose.is_none() || pose.is_none())
            && last.odometry_before == self.recording.odometry.len()
            && last.ranges == ranges
        {
            *last_pose = last_pose.or(pose);
            return Ok(());
        }
        let time = self.scan_clock.stamp(Some(time), &mut self.recording.irregular)?;
        self.recording.scans.push(ScanRecord {
            time,
            angle_min,
            angle_increment,
            ranges,
            mount: SensorPose::default(),
            odometry: self.raw.map(|raw| stamped(time, raw)),
            odometry_before: self.recording.odometry.len(),
        });
        self.poses.push(pose);
        Ok(())
    }

    fn odom(&mut self, line: TextLine<'_>, values: &[Field<'_>]) -> Result<(), DataError> {
        let [x, y, heading, ..] = values else {
            let layout = "ODOM, x, y, heading, …, time, host, log time";
            return Err(line.error(Problem::Columns { expected: 4, found: 1 + values.len(), layout }));
        };
        let here = pose(x, y, heading)?;
        let time = stamp_column(values);
        if self.is_reset(here, time)? {
            self.previous = Some(here);
            self.raw.get_or_insert(here);
            return Ok(());
        }
        let raw = match (self.raw, self.previous) {
            (Some(raw), Some(previous)) => raw * (previous.inverse() * here),
            _ => here,
        };
        let time = self.odometry_clock.stamp(time, &mut self.recording.irregular)?;
        self.recording.odometry.push(stamped(time, raw));
        (self.previous, self.raw) = (Some(here), Some(raw));
        Ok(())
    }

    /// Whether an `ODOM` line right after a scan only repeats the corrected pose; the pose of a scan without one is set to it.
    fn is_reset(&mut self, here: MapFromBody, time: Option<Field<'_>>) -> Result<bool, DataError> {
        let (Some(scanned), Some(pose)) = (self.awaited.take(), self.poses.last_mut()) else {
            return Ok(false);
        };
        if pose.is_some() {
            return Ok(*pose == Some(here));
        }
        let Some(time) = time else { return Ok(false) };
        let time = time.finite("time")?;
        let is_reset = time < scanned || (time.abs() < UNSET && scanned.abs() >= UNSET);
        if is_reset {
            *pose = Some(here);
        }
        Ok(is_reset)
    }

    /// Leaves out scans without a reference if others have one.
    fn finish(self) -> Recording<StampedPose> {
        let Self { mut recording, poses, .. } = self;
        if poses.iter().all(Option::is_none) {
            return recording;
        }
        let scans = std::mem::take(&mut recording.scans);
        for (scan, pose) in scans.into_iter().zip(poses) {
            let Some(pose) = pose else {
                *recording.irregular.entry("scan_without_reference").or_default() += 1;
                continue;
            };
            recording.reference.push(stamped(scan.time, pose));
            recording.scans.push(scan);
        }
        recording
    }
}

/// Returns the column of the stamp: the one before the host, which is the last column that is not a number, or else the
/// seventh value; `None` without stamp.
fn stamp_column<'l>(values: &[Field<'l>]) -> Option<Field<'l>> {
    let others = values.get(3..)?;
    let is_number = |column: &Field<'_>| fast_float2::parse::<f64, _>(column.text()).is_ok();
    match others.iter().rposition(|column| !is_number(column)) {
        Some(host) => others.get(host.checked_sub(1)?).copied(),
        None => others.get(3).copied(),
    }
}

fn stamped(time: f64, place: MapFromBody) -> StampedPose {
    StampedPose { time, x: place.x, y: place.y, heading: place.heading.radians() }
}

#[cfg(test)]
mod tests;
