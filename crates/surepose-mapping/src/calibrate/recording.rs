//! Input of a calibration: wheel ticks, scans and headings, stamped on arrival.

use core::f64::consts::TAU;

use surepose::geometry::Angle;
use surepose::kinematics::{Twist, WheelPair};
use surepose_io::recording::{ScanRecord, StampedTicks};

/// A recording to calibrate from.
#[derive(Clone, Debug, PartialEq)]
pub struct CalibrationRecording {
    /// Ticks per wheel turn.
    pub ticks_per_turn: f64,
    /// Wheel counters, ordered by time.
    pub ticks: Vec<StampedTicks>,
    /// Laser scans, ordered by time; their mounting is ignored.
    pub scans: Vec<ScanRecord>,
    /// Compass readings, ordered by time; empty if there is no compass.
    pub headings: Vec<StampedHeading>,
    /// Velocity commands, ordered by time; empty if they were not recorded.
    pub commands: Vec<StampedCommand>,
}

/// A velocity command with the time at which it was sent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StampedCommand {
    /// Time \[s\], by the clock of the odometry.
    pub time: f64,
    /// Commanded speed and turn rate.
    pub twist: Twist<f64>,
}

/// A compass reading with its time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StampedHeading {
    /// Time \[s\].
    pub time: f64,
    /// Heading reported by the compass.
    pub heading: Angle<f64>,
}

/// Wheel motion between two records of the counters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct OdometryStep {
    /// Start time \[s].
    pub(super) begin: f64,
    /// Duration \[s], positive.
    pub(super) duration: f64,
    /// Rotation of each wheel \[rad].
    pub(super) turned: WheelPair<f64>,
}

impl OdometryStep {
    pub(super) fn end(&self) -> f64 {
        self.begin + self.duration
    }
}

impl CalibrationRecording {
    /// Returns the steps between counter records; records with equal times are merged.
    pub(super) fn steps(&self) -> Vec<OdometryStep> {
        let radians = TAU / self.ticks_per_turn;
        let mut steps = Vec::with_capacity(self.ticks.len());
        let mut before: Option<&StampedTicks> = None;
        for now in &self.ticks {
            let Some(last) = before else {
                before = Some(now);
                continue;
            };
            let duration = now.time - last.time;
            if duration > 1e-6 {
                let turned = |now: i64, last: i64| (now - last) as f64 * radians;
                let turned = WheelPair::new(turned(now.right, last.right), turned(now.left, last.left));
                steps.push(OdometryStep { begin: last.time, duration, turned });
                before = Some(now);
            }
        }
        steps
    }
}

/// Returns the step that contains `time`, and the time since its start; times outside map to the nearest
/// step.
pub(super) fn locate(steps: &[OdometryStep], time: f64) -> (usize, f64) {
    let index = steps.partition_point(|step| step.end() <= time).min(steps.len().saturating_sub(1));
    let fraction = steps.get(index).map_or(0.0, |step| (time - step.begin) / step.duration);
    (index, fraction)
}
