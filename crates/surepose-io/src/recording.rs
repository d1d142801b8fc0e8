//! Defines the records of recordings: stamped poses, twists and wheel ticks, and laser scans.
//!
//! Values are in SI units and radians. Every number is finite and within the bounds of its quantity, except missing laser
//! returns (see [`ScanRecord::ranges`]). Headings are as recorded and not always normalized. Stamps are as recorded: they
//! do not decrease within a list, and their origin depends on the recording.

use std::collections::BTreeMap;

use surepose::geometry::{Angle, Body, Laser, Pose};

/// Recording of a robot with a laser: odometry of type `O`, scans, and reference poses if there are any.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording<O> {
    /// Odometry records, by time.
    pub odometry: Vec<O>,
    /// Laser scans, by time.
    pub scans: Vec<ScanRecord>,
    /// Reference poses, by time; empty if the recording has none.
    pub reference: Vec<StampedPose>,
    /// Number of records with an irregular stamp or without use, by kind; empty if there are none.
    pub irregular: BTreeMap<&'static str, u32>,
}

impl<O> Default for Recording<O> {
    fn default() -> Self {
        Self { odometry: Vec::new(), scans: Vec::new(), reference: Vec::new(), irregular: BTreeMap::new() }
    }
}

/// A pose with a time stamp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StampedPose {
    /// Time \[s\].
    pub time: f64,
    /// Position along the x axis \[m\].
    pub x: f64,
    /// Position along the y axis \[m\].
    pub y: f64,
    /// Heading, counter-clockwise from the x axis \[rad\].
    pub heading: f64,
}

/// A velocity with a time stamp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StampedTwist {
    /// Time \[s\].
    pub time: f64,
    /// Forward speed \[m/s\].
    pub speed: f64,
    /// Turn rate, counter-clockwise \[rad/s\].
    pub turn_rate: f64,
}

/// The counters of both wheel encoders with a time stamp.
///
/// The counters have 32 bits, so that the difference of any two does not overflow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StampedTicks {
    /// Time \[s\].
    pub time: f64,
    /// Left counter \[ticks\].
    pub left: i64,
    /// Right counter \[ticks\].
    pub right: i64,
}

/// One scan of a laser range finder, counter-clockwise.
#[derive(Clone, Debug, PartialEq)]
pub struct ScanRecord {
    /// Time \[s\].
    pub time: f64,
    /// Angle of the first beam, relative to the laser \[rad\].
    pub angle_min: f64,
    /// Angle between successive beams \[rad\].
    pub angle_increment: f64,
    /// One range per beam, above 0 \[m\]; [`f64::INFINITY`] for a beam without return.
    pub ranges: Vec<f64>,
    /// Pose of the laser on the robot.
    pub mount: SensorPose,
    /// Odometry pose at the time of the scan; `None` if the recording has none.
    pub odometry: Option<StampedPose>,
    /// Number of records in [`Recording::odometry`] that precede this scan. It relates both lists even if the stamps of a
    /// recording do not.
    pub odometry_before: usize,
}

/// The pose of a sensor on the robot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SensorPose {
    /// Forward of the wheel axle \[m\].
    pub x: f64,
    /// To the left of the center line \[m\].
    pub y: f64,
    /// Yaw relative to the robot, counter-clockwise \[rad\].
    pub heading: f64,
}

impl ScanRecord {
    /// Returns the angle of beam `index`, relative to the laser \[rad\].
    pub fn angle(&self, index: usize) -> f64 {
        self.angle_min + index as f64 * self.angle_increment
    }
}

/// Pose of the laser as a type of the core.
pub fn laser_extrinsics(mount: SensorPose) -> Pose<Body, Laser, f64> {
    Pose::new(mount.x, mount.y, Angle::from_radians(mount.heading))
}

/// A record with a time stamp.
pub trait Timestamped {
    /// Time \[s\].
    fn time(&self) -> f64;
}

macro_rules! stamped {
    ($($record:ty),*) => {
        $(impl Timestamped for $record {
            fn time(&self) -> f64 {
                self.time
            }
        })*
    };
}
stamped!(StampedPose, StampedTwist, StampedTicks, ScanRecord);

impl<O: Timestamped> Recording<O> {
    /// Returns the time from the first record to the last \[s\]; 0 if the stamps were rounded to one value, so that the
    /// records have an order but no rate.
    pub fn duration(&self) -> f64 {
        let odometry = span(&self.odometry).into_iter();
        let (first, last) = odometry
            .chain(span(&self.scans))
            .chain(span(&self.reference))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(first, last), (from, to)| {
                (first.min(from), last.max(to))
            });
        (last - first).max(0.0)
    }
}

/// Returns the first and the last stamp of ordered records; `None` if there are none.
fn span<R: Timestamped>(records: &[R]) -> Option<(f64, f64)> {
    Some((records.first()?.time(), records.last()?.time()))
}
