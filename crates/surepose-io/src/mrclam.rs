//! Reads UTIAS MRCLAM data sets: five robots, landmarks with barcodes, motion-capture ground truth [Leung2011].
//!
//! A data set is a directory. Each file is plain text or gzip (`.gz`), with `#` header lines and columns separated by
//! whitespace:
//!
//! | file | columns |
//! |---|---|
//! | `Barcodes.dat` | subject, barcode |
//! | `Landmark_Groundtruth.dat` | subject, x, y, σx, σy \[m\] |
//! | `RobotN_Odometry.dat` | time \[s\], forward speed \[m/s\], turn rate \[rad/s\] |
//! | `RobotN_Measurement.dat` | time \[s\], barcode, range \[m\], bearing \[rad\] |
//! | `RobotN_Groundtruth.dat` | time \[s\], x, y \[m\], heading \[rad\] |
//!
//! The odometry is the *commanded* velocity. The camera observes other robots as well as landmarks. A few barcodes are
//! misread and match no subject ([`Target::Unknown`]).

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::error::{DataError, Problem};
use crate::lines::{Clock, LineReader};
use crate::quantity::{ANGLE, POSITION, POSITION_STD, RANGE, SPEED, TURN_RATE};
use crate::recording::{StampedPose, StampedTwist};

/// The recording of one robot, with the landmarks and the true path.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotLog {
    /// Velocity commands, by time.
    pub odometry: Vec<StampedTwist>,
    /// Observations of landmarks and other robots, by time.
    pub sightings: Vec<LandmarkObservation>,
    /// True poses, by time.
    pub reference: Vec<StampedPose>,
    /// The landmarks, by subject number.
    pub landmarks: Vec<Landmark>,
}

/// A landmark, measured by motion capture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Landmark {
    /// The subject number.
    pub subject: u32,
    /// Position along the x axis \[m\].
    pub x: f64,
    /// Position along the y axis \[m\].
    pub y: f64,
    /// Standard deviation of `x` \[m\].
    pub x_std: f64,
    /// Standard deviation of `y` \[m\].
    pub y_std: f64,
}

/// An observation of a barcode by the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LandmarkObservation {
    /// Time \[s\].
    pub time: f64,
    /// The observed subject.
    pub target: Target,
    /// Distance \[m\].
    pub range: f64,
    /// Bearing from the robot heading, counter-clockwise \[rad\].
    pub bearing: f64,
}

/// The subject of a barcode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// A landmark, by subject number.
    Landmark(u32),
    /// Another robot, by subject number.
    Robot(u32),
    /// A misread barcode, which no subject has.
    Unknown {
        /// The barcode as read.
        barcode: u32,
    },
}

impl RobotLog {
    /// Returns the landmark with this subject number; `None` if there is none.
    pub fn landmark(&self, subject: u32) -> Option<&Landmark> {
        let found = self.landmarks.binary_search_by_key(&subject, |landmark| landmark.subject);
        found.ok().and_then(|index| self.landmarks.get(index))
    }
}

/// Reads the files of one robot from the directory of a data set.
///
/// A directory with one odometry file of another name than `RobotN_Odometry.dat` is data of one robot, whose files have that
/// prefix. The reference may be absent.
///
/// # Errors
/// A missing, unreadable or malformed file, with name and line, or a robot that the data set does not contain.
pub fn read(folder: &Path, robot: u32) -> Result<RobotLog, DataError> {
    let prefix = prefix_of(folder, robot)?;
    let reference = format!("{prefix}_Groundtruth.dat");
    let has_reference =
        [reference.clone(), format!("{reference}.gz")].iter().any(|name| folder.join(name).exists());
    parse(Files {
        barcodes: open(folder, "Barcodes.dat")?,
        landmarks: open(folder, "Landmark_Groundtruth.dat")?,
        odometry: open(folder, &format!("{prefix}_Odometry.dat"))?,
        sightings: open(folder, &format!("{prefix}_Measurement.dat"))?,
        reference: has_reference.then(|| open(folder, &reference)).transpose()?,
    })
}

/// Returns the prefix of the files of `robot`: `RobotN`, or that of the only odometry file of another name.
fn prefix_of(folder: &Path, robot: u32) -> Result<String, DataError> {
    let others = prefixes(folder)?;
    if let [prefix] = others.as_slice()
        && robot_of_prefix(prefix).is_none()
    {
        return Ok(prefix.clone());
    }
    let present = robots(folder)?;
    if !present.contains(&robot) {
        let present = present.iter().map(u32::to_string).collect::<Vec<_>>().join(", ");
        return Err(DataError::in_file(folder, Problem::UnknownRobot { expected: robot, present }));
    }
    Ok(format!("Robot{robot}"))
}

/// Returns the prefixes of all odometry files in the directory, in ascending order.
fn prefixes(folder: &Path) -> Result<Vec<String>, DataError> {
    let unreadable = |error| DataError::in_file(folder, Problem::Unreadable(error));
    let mut prefixes = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(unreadable)? {
        let name = entry.map_err(unreadable)?.file_name();
        let name = name.to_str().map(|name| name.strip_suffix(".gz").unwrap_or(name));
        prefixes.extend(name.and_then(|name| name.strip_suffix("_Odometry.dat")).map(str::to_owned));
    }
    prefixes.sort_unstable();
    prefixes.dedup();
    Ok(prefixes)
}

/// Returns the numbers of the robots with an odometry file in the directory, in ascending order.
///
/// # Errors
/// An unreadable directory, or one without a robot.
pub fn robots(folder: &Path) -> Result<Vec<u32>, DataError> {
    let mut robots: Vec<u32> =
        prefixes(folder)?.iter().filter_map(|prefix| robot_of_prefix(prefix)).collect();
    robots.sort_unstable();
    robots.dedup();
    if robots.is_empty() {
        let what = "file Robot1_Odometry.dat or Robot1_Odometry.dat.gz";
        return Err(DataError::in_file(folder, Problem::Empty { what }));
    }
    Ok(robots)
}

/// The five files of one robot.
pub struct Files<'a> {
    /// `Barcodes.dat`.
    pub barcodes: LineReader<'a>,
    /// `Landmark_Groundtruth.dat`.
    pub landmarks: LineReader<'a>,
    /// `RobotN_Odometry.dat`.
    pub odometry: LineReader<'a>,
    /// `RobotN_Measurement.dat`.
    pub sightings: LineReader<'a>,
    /// `RobotN_Groundtruth.dat`; `None` without reference.
    pub reference: Option<LineReader<'a>>,
}

/// Parses the files of one robot.
///
/// # Errors
/// A malformed file, with name and line.
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
        reference: files.reference.map(parse_reference).transpose()?.unwrap_or_default(),
        landmarks: landmarks.into_values().collect(),
    })
}

/// Returns `N` of `RobotN`; `None` for other prefixes.
fn robot_of_prefix(prefix: &str) -> Option<u32> {
    prefix.strip_prefix("Robot")?.parse().ok()
}

/// Opens `name` or, if it is absent, `name.gz`.
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
