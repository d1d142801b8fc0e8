//! What recordings hold, in SI units and radians: stamped poses, twists and wheel ticks, and laser scans.
//!
//! Every number is finite (a missing laser return apart, see [`ScanRecord::ranges`]) and inside the bounds of its
//! quantity. Headings are as the format has them, so not always wrapped. Stamps are those of the recording, never going back within one
//! list; their zero is the recording's own.

use surepose::geometry::{Angle, Body, Laser, Pose};

/// What a robot with a laser recorded: odometry of some kind, scans, and a reference path where there is one.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording<O> {
    /// Odometry, by time.
    pub odometry: Vec<O>,
    /// Laser scans, by time.
    pub scans: Vec<ScanRecord>,
    /// Poses to be judged against, by time; empty where the recording has none.
    pub reference: Vec<StampedPose>,
}

/// A pose at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StampedPose {
    /// Time \[s\].
    pub time: f64,
    /// Position \[m\].
    pub x: f64,
    /// Position \[m\].
    pub y: f64,
    /// Heading, counter-clockwise from the x axis \[rad\].
    pub heading: f64,
}

/// A velocity at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StampedTwist {
    /// Time \[s\].
    pub time: f64,
    /// Forward speed \[m/s\].
    pub speed: f64,
    /// Turn rate, counter-clockwise \[rad/s\].
    pub turn_rate: f64,
}

/// The counters of both wheel encoders at a time.
///
/// They come from 32-bit counters, so that the difference of any two never overflows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StampedTicks {
    /// Time \[s\].
    pub time: f64,
    /// Left counter \[ticks\].
    pub left: i64,
    /// Right counter \[ticks\].
    pub right: i64,
}

/// One sweep of a laser range finder, counter-clockwise.
#[derive(Clone, Debug, PartialEq)]
pub struct ScanRecord {
    /// Time \[s\].
    pub time: f64,
    /// Direction of the first beam, seen from the laser's heading \[rad\].
    pub angle_min: f64,
    /// Angle from one beam to the next \[rad\].
    pub angle_increment: f64,
    /// One range per beam, above zero \[m\]; [`f64::INFINITY`] where nothing came back.
    pub ranges: Vec<f64>,
    /// Where the laser sits on the robot.
    pub mount: SensorPose,
    /// Where odometry put the robot at the moment of the scan, if the recording tells.
    pub odometry: Option<StampedPose>,
    /// How many records of [`Recording::odometry`] precede this scan. It joins the two lists even where the stamps
    /// of a recording cannot.
    pub odometry_before: usize,
}

/// Where a laser sits on the robot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SensorPose {
    /// Ahead of the wheel axle \[m\].
    pub x: f64,
    /// To the left of the middle \[m\].
    pub y: f64,
    /// Turned counter-clockwise against the robot's heading \[rad\].
    pub heading: f64,
}

impl ScanRecord {
    /// Direction of beam `index`, seen from the laser's heading \[rad\].
    pub fn angle(&self, index: usize) -> f64 {
        self.angle_min + index as f64 * self.angle_increment
    }
}

/// Where the laser is, in the core's form.
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
    /// Time from the first record to the last \[s\]. It is 0 for a recording whose stamps were rounded away: such
    /// records have an order, but no rate.
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

/// First and last stamp of records that are in order.
fn span<R: Timestamped>(records: &[R]) -> Option<(f64, f64)> {
    Some((records.first()?.time(), records.last()?.time()))
}
