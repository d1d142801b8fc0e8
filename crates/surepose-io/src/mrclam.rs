//! UTIAS MRCLAM: five robots, landmarks with barcodes, motion-capture ground truth [Leung2011].
//!
//! A data set is a folder. Each file is plain text or gzip (`.gz`), has `#` header lines, and columns between
//! blanks:
//!
//! | file | columns |
//! |---|---|
//! | `Barcodes.dat` | subject, barcode |
//! | `Landmark_Groundtruth.dat` | subject, x, y, σx, σy \[m\] |
//! | `RobotN_Odometry.dat` | time \[s\], forward speed \[m/s\], turn rate \[rad/s\] |
//! | `RobotN_Measurement.dat` | time \[s\], barcode, range \[m\], bearing \[rad\] |
//! | `RobotN_Groundtruth.dat` | time \[s\], x, y \[m\], heading \[rad\] |
//!
//! The odometry is the *commanded* velocity; the camera sees other robots as well as landmarks; a few barcodes are
//! misread and belong to nobody ([`Target::Unknown`]).

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::error::{DataError, Problem};
use crate::lines::{Clock, LineReader};
use crate::quantity::{ANGLE, POSITION, POSITION_STD, RANGE, SPEED, TURN_RATE};
use crate::recording::{StampedPose, StampedTwist};

/// What one robot recorded, with the landmarks around it and its true path.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotLog {
    /// Commanded velocities, by time.
    pub odometry: Vec<StampedTwist>,
    /// Sightings of landmarks and of other robots, by time.
    pub sightings: Vec<LandmarkObservation>,
    /// True poses, by time.
    pub reference: Vec<StampedPose>,
    /// The landmarks, by subject.
    pub landmarks: Vec<Landmark>,
}

/// A landmark as the motion capture saw it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Landmark {
    /// Its subject number.
    pub subject: u32,
    /// Position \[m\].
    pub x: f64,
    /// Position \[m\].
    pub y: f64,
    /// Standard deviation of `x` \[m\].
    pub x_std: f64,
    /// Standard deviation of `y` \[m\].
    pub y_std: f64,
}

/// One barcode seen by the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LandmarkObservation {
    /// Time \[s\].
    pub time: f64,
    /// Who was seen.
    pub target: Target,
    /// Distance \[m\].
    pub range: f64,
    /// Direction seen from the robot's heading, counter-clockwise \[rad\].
    pub bearing: f64,
}

/// Whom a barcode belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// A landmark, by subject.
    Landmark(u32),
    /// Another robot, by subject.
    Robot(u32),
    /// Nobody in the data set has this barcode: it was misread.
    Unknown {
        /// The barcode as read.
        barcode: u32,
    },
}

impl RobotLog {
    /// The landmark with this subject number.
    pub fn landmark(&self, subject: u32) -> Option<&Landmark> {
        let found = self.landmarks.binary_search_by_key(&subject, |landmark| landmark.subject);
        found.ok().and_then(|index| self.landmarks.get(index))
    }
}

/// Reads the files of one robot from the folder of a data set.
///
/// # Errors
/// A missing, unreadable or malformed file, by name and line; a robot that the data set does not have.
pub fn read(folder: &Path, robot: u32) -> Result<RobotLog, DataError> {
    let present = robots(folder)?;
    if !present.contains(&robot) {
        let present = present.iter().map(u32::to_string).collect::<Vec<_>>().join(", ");
        return Err(DataError::in_file(folder, Problem::UnknownRobot { expected: robot, present }));
    }
    parse(Files {
        barcodes: open(folder, "Barcodes.dat")?,
        landmarks: open(folder, "Landmark_Groundtruth.dat")?,
        odometry: open(folder, &format!("Robot{robot}_Odometry.dat"))?,
        sightings: open(folder, &format!("Robot{robot}_Measurement.dat"))?,
        reference: open(folder, &format!("Robot{robot}_Groundtruth.dat"))?,
    })
}

/// The numbers of the robots whose odometry is in the folder, in order.
///
/// # Errors
/// A folder that cannot be read, or that holds no robot.
pub fn robots(folder: &Path) -> Result<Vec<u32>, DataError> {
    let unreadable = |error| DataError::in_file(folder, Problem::Unreadable(error));
    let mut robots = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(unreadable)? {
        let name = entry.map_err(unreadable)?.file_name();
        let name = name.to_str().map(|name| name.strip_suffix(".gz").unwrap_or(name));
        robots.extend(name.and_then(robot_of_odometry));
    }
    robots.sort_unstable();
    robots.dedup();
    if robots.is_empty() {
        let what = "file Robot1_Odometry.dat or Robot1_Odometry.dat.gz";
        return Err(DataError::in_file(folder, Problem::Empty { what }));
    }
    Ok(robots)
}

/// The five texts behind one robot's log.
pub struct Files<'a> {
    /// `Barcodes.dat`.
    pub barcodes: LineReader<'a>,
    /// `Landmark_Groundtruth.dat`.
    pub landmarks: LineReader<'a>,
    /// `RobotN_Odometry.dat`.
    pub odometry: LineReader<'a>,
    /// `RobotN_Measurement.dat`.
    pub sightings: LineReader<'a>,
    /// `RobotN_Groundtruth.dat`.
    pub reference: LineReader<'a>,
}

/// Reads one robot's log from its texts.
///
/// # Errors
/// A malformed text, by name and line.
pub fn parse(files: Files<'_>) -> Result<RobotLog, DataError> {
    let subjects = parse_barcodes(files.barcodes)?;
    let landmarks = parse_landmarks(files.landmarks)?;
    let target = |barcode| match subjects.get(&barcode) {
        None => Target::Unknown { barcode },
        Some(&subject) if landmarks.contains_key(&subject) => Target::Landmark(subject),
        Some(&subject) => Target::Robot(subject),
    };
    Ok(RobotLog {
        odometry: parse_odometry(files.odometry)?,
        sightings: parse_sightings(files.sightings, target)?,
        reference: parse_reference(files.reference)?,
        landmarks: landmarks.into_values().collect(),
    })
}

/// `N` of `RobotN_Odometry.dat`.
fn robot_of_odometry(name: &str) -> Option<u32> {
    name.strip_prefix("Robot")?.strip_suffix("_Odometry.dat")?.parse().ok()
}

/// Opens `name` or, where it is absent, `name.gz`.
fn open(folder: &Path, name: &str) -> Result<LineReader<'static>, DataError> {
    let plain: PathBuf = folder.join(name);
    let compressed = folder.join(format!("{name}.gz"));
    LineReader::open(if compressed.exists() && !plain.exists() { &compressed } else { &plain })
}

fn parse_barcodes(mut lines: LineReader<'_>) -> Result<BTreeMap<u32, u32>, DataError> {
    let mut subjects = BTreeMap::new();
    while let Some(line) = lines.next_record()? {
        let [subject, barcode] = line.split("subject, barcode")?;
        let (subject, barcode) = (subject.whole("subject")?, barcode.whole("barcode")?);
        if subjects.insert(barcode, subject).is_some() {
            return Err(line.error(Problem::Duplicate { what: "barcode", id: u64::from(barcode) }));
        }
    }
    present(&lines, "barcodes", subjects.is_empty())?;
    Ok(subjects)
}

fn parse_landmarks(mut lines: LineReader<'_>) -> Result<BTreeMap<u32, Landmark>, DataError> {
    let mut landmarks = BTreeMap::new();
    while let Some(line) = lines.next_record()? {
        let [subject, x, y, x_std, y_std] = line.split("subject, x, y, x std, y std")?;
        let landmark = Landmark {
            subject: subject.whole("subject")?,
            x: x.read("x", &POSITION)?,
            y: y.read("y", &POSITION)?,
            x_std: x_std.read("x std", &POSITION_STD)?,
            y_std: y_std.read("y std", &POSITION_STD)?,
        };
        if landmarks.insert(landmark.subject, landmark).is_some() {
            return Err(line.error(Problem::Duplicate { what: "landmark", id: u64::from(landmark.subject) }));
        }
    }
    present(&lines, "landmarks", landmarks.is_empty())?;
    Ok(landmarks)
}

fn parse_odometry(mut lines: LineReader<'_>) -> Result<Vec<StampedTwist>, DataError> {
    let (mut twists, mut clock) = (Vec::new(), Clock::default());
    while let Some(line) = lines.next_record()? {
        let [time, speed, turn_rate] = line.split("time, forward speed, turn rate")?;
        twists.push(StampedTwist {
            time: clock.stamp(time, 1.0)?,
            speed: speed.read("forward speed", &SPEED)?,
            turn_rate: turn_rate.read("turn rate", &TURN_RATE)?,
        });
    }
    present(&lines, "odometry", twists.is_empty())?;
    Ok(twists)
}

fn parse_sightings(
    mut lines: LineReader<'_>,
    target: impl Fn(u32) -> Target,
) -> Result<Vec<LandmarkObservation>, DataError> {
    let (mut sightings, mut clock) = (Vec::new(), Clock::default());
    while let Some(line) = lines.next_record()? {
        let [time, barcode, range, bearing] = line.split("time, barcode, range, bearing")?;
        sightings.push(LandmarkObservation {
            time: clock.stamp(time, 1.0)?,
            target: target(barcode.whole("barcode")?),
            range: range.read("range", &RANGE)?,
            bearing: bearing.read("bearing", &ANGLE)?,
        });
    }
    Ok(sightings)
}

fn parse_reference(mut lines: LineReader<'_>) -> Result<Vec<StampedPose>, DataError> {
    let (mut poses, mut clock) = (Vec::new(), Clock::default());
    while let Some(line) = lines.next_record()? {
        let [time, x, y, heading] = line.split("time, x, y, heading")?;
        poses.push(StampedPose {
            time: clock.stamp(time, 1.0)?,
            x: x.read("x", &POSITION)?,
            y: y.read("y", &POSITION)?,
            heading: heading.read("heading", &ANGLE)?,
        });
    }
    present(&lines, "reference poses", poses.is_empty())?;
    Ok(poses)
}

fn present(lines: &LineReader<'_>, what: &'static str, empty: bool) -> Result<(), DataError> {
    if empty { Err(lines.error(Problem::Empty { what })) } else { Ok(()) }
}

#[cfg(test)]
mod tests;
