//! What sensors said, kept until odometry has come to where it was measured.

use std::collections::VecDeque;

use surepose::estimation::Measurement;
use surepose::geometry::{Angle, Body, Laser, Pose};
use surepose::lidar::{LaserGeometry, Scan};
use surepose::localization::SensorReading;
use surepose::time::{Stamp, Stamped};

/// What a sensor said.
#[derive(Clone, Debug, PartialEq)]
pub enum SensorMessage {
    /// Something that the filter understands as it is.
    Measurement(Measurement<f64>),
    /// A scan.
    Scan(LaserScan),
}

/// One turn of a laser.
#[derive(Clone, Debug, PartialEq)]
pub struct LaserScan {
    /// Direction of the first beam from the laser's x axis \[rad].
    pub angle_min: f64,
    /// From one beam to the next \[rad].
    pub angle_increment: f64,
    /// The range of every beam \[m]; infinite where nothing came back.
    pub ranges: Vec<f64>,
    /// Nearer returns are the housing's \[m].
    pub range_min: f64,
    /// Farther ones are none \[m].
    pub range_max: f64,
    /// Where the laser sits.
    pub body_from_laser: Pose<Body, Laser, f64>,
}

impl SensorMessage {
    /// The message as the core takes it.
    pub(super) fn reading(message: &Stamped<Self>) -> Stamped<SensorReading<'_, f64>> {
        let reading = match &message.value {
            Self::Measurement(measurement) => SensorReading::Measurement(*measurement),
            Self::Scan(scan) => {
                let LaserScan { body_from_laser, range_min, range_max, .. } = *scan;
                let geometry = LaserGeometry { body_from_laser, range_min, range_max };
                let angle_min = Angle::from_radians(scan.angle_min);
                let scan = Scan::new(angle_min, scan.angle_increment, &scan.ranges);
                SensorReading::Scan(scan.with_geometry(geometry))
            }
        };
        Stamped::new(message.stamp, reading)
    }

    /// The scan, if it is one.
    pub(super) fn scan(&self) -> Option<&LaserScan> {
        match self {
            Self::Scan(scan) => Some(scan),
            Self::Measurement(_) => None,
        }
    }
}

/// The most that is kept: a second of a compass at 100 Hz and scans at 40 Hz.
const CAPACITY: usize = 140;

/// Signals that odometry has not come to yet.
#[derive(Clone, Debug, Default)]
pub(super) struct MeasurementQueue {
    waiting: VecDeque<Stamped<SensorMessage>>,
    dropped: u64,
}

impl MeasurementQueue {
    /// Keeps a signal; the oldest one goes where there is no room.
    pub(super) fn put(&mut self, heard: Stamped<SensorMessage>) {
        if self.waiting.len() >= CAPACITY {
            self.waiting.pop_front();
            self.dropped = self.dropped.saturating_add(1);
        }
        self.waiting.push_back(heard);
    }

    /// Takes out what was measured until `stamp`, in the order in which it arrived.
    pub(super) fn until(&mut self, stamp: Stamp) -> Vec<Stamped<SensorMessage>> {
        let (due, early) = self.waiting.drain(..).partition::<Vec<_>, _>(|heard| heard.stamp <= stamp);
        self.waiting = early.into();
        due
    }

    /// How many went for want of room.
    pub(super) fn dropped(&self) -> u64 {
        self.dropped
    }
}

#[cfg(test)]
mod tests {
    use surepose::estimation::HeadingMeasurement;

    use super::*;

    fn heading(seconds: f64) -> Stamped<SensorMessage> {
        let compass = HeadingMeasurement { heading: Angle::zero(), std: 0.1 };
        Stamped::new(Stamp::from_seconds(seconds), SensorMessage::Measurement(Measurement::Heading(compass)))
    }

    #[test]
    fn early_measurements_stay_queued() {
        let mut measurement_queue = MeasurementQueue::default();
        for seconds in [0.3, 0.1, 0.2] {
            measurement_queue.put(heading(seconds));
        }
        let due = measurement_queue.until(Stamp::from_seconds(0.2));
        assert_eq!(due, [heading(0.1), heading(0.2)]);
        assert_eq!(measurement_queue.until(Stamp::from_seconds(1.0)), [heading(0.3)]);
    }

    #[test]
    fn queue_size_is_bounded() {
        let mut measurement_queue = MeasurementQueue::default();
        for k in 0..1000 {
            measurement_queue.put(heading(f64::from(k)));
        }
        assert_eq!(measurement_queue.dropped(), 1000 - CAPACITY as u64);
        assert_eq!(measurement_queue.until(Stamp::from_seconds(2000.0)).len(), CAPACITY);
    }
}
