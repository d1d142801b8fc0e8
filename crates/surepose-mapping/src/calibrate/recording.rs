//! What calibration reads: wheel ticks, scans and headings, stamped when they arrived.

use core::f64::consts::TAU;

use surepose::geometry::Angle;
use surepose::kinematics::WheelPair;
use surepose_io::recording::{ScanRecord, StampedTicks};

/// A recording to calibrate from.
#[derive(Clone, Debug, PartialEq)]
pub struct CalibrationRecording {
    /// Ticks of one turn of a wheel.
    pub ticks_per_turn: f64,
    /// Wheel counters, by time.
    pub ticks: Vec<StampedTicks>,
    /// Laser scans, by time; where their laser sits is not read.
    pub scans: Vec<ScanRecord>,
    /// Compass readings, by time; empty where there is no compass.
    pub headings: Vec<StampedHeading>,
}

/// A compass reading at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StampedHeading {
    /// Time \[s\].
    pub time: f64,
    /// What the compass reads.
    pub heading: Angle<f64>,
}

/// The wheels between two records of their counters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct OdometryStep {
    /// When it begins \[s].
    pub(super) begin: f64,
    /// How long it lasts \[s], positive.
    pub(super) duration: f64,
    /// How far each wheel turned \[rad].
    pub(super) turned: WheelPair<f64>,
}

impl OdometryStep {
    pub(super) fn end(&self) -> f64 {
        self.begin + self.duration
    }
}

impl CalibrationRecording {
    /// The steps between the counters' records; records of the same time are one.
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

/// Which step holds `time`, and how far into it the time is; times outside belong to the step nearest.
pub(super) fn locate(steps: &[OdometryStep], time: f64) -> (usize, f64) {
    let index = steps.partition_point(|step| step.end() <= time).min(steps.len().saturating_sub(1));
    let fraction = steps.get(index).map_or(0.0, |step| (time - step.begin) / step.duration);
    (index, fraction)
}
