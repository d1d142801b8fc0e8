//! Queues measurements until odometry reaches their stamps.

use std::collections::VecDeque;

use surepose::estimation::Measurement;
use surepose::geometry::{Angle, Body, Laser, Pose};
use surepose::lidar::{LaserGeometry, Scan};
use surepose::localization::SensorReading;
use surepose::time::{Stamp, Stamped};

/// Measurement or scan of a sensor.
#[derive(Clone, Debug, PartialEq)]
pub enum SensorMessage {
    /// Measurement for the filter.
    Measurement(Measurement<f64>),
    /// A scan.
    Scan(LaserScan),
}

/// Scan with the geometry of its laser.
#[derive(Clone, Debug, PartialEq)]
pub struct LaserScan {
    /// Angle of the first beam from the laser's x axis \[rad].
    pub angle_min: f64,
    /// Angle between adjacent beams \[rad].
    pub angle_increment: f64,
    /// Range of each beam \[m]; infinite without a return.
    pub ranges: Vec<f64>,
    /// Shortest valid range \[m].
    pub range_min: f64,
    /// Longest valid range \[m].
    pub range_max: f64,
    /// Pose of the laser on the body.
    pub body_from_laser: Pose<Body, Laser, f64>,
}

impl SensorMessage {
    /// Converts the message to the core's reading.
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

    /// Scan of the message; `None` for a measurement.
    pub(super) fn scan(&self) -> Option<&LaserScan> {
        match self {
            Self::Scan(scan) => Some(scan),
            Self::Measurement(_) => None,
        }
    }
}

/// Largest number of queued messages: 1 s of headings at 100 Hz and scans at 40 Hz.
const CAPACITY: usize = 140;

/// Messages with stamps later than the odometry.
#[derive(Clone, Debug, Default)]
pub(super) struct MeasurementQueue {
    waiting: VecDeque<Stamped<SensorMessage>>,
    dropped: u64,
}

impl MeasurementQueue {
    /// Adds a message; a full queue drops its oldest one.
    pub(super) fn put(&mut self, message: Stamped<SensorMessage>) {
        if self.waiting.len() >= CAPACITY {
            self.waiting.pop_front();
            self.dropped = self.dropped.saturating_add(1);
        }
        self.waiting.push_back(message);
    }

    /// Removes and returns the messages up to `stamp`, in the order of arrival.
    pub(super) fn until(&mut self, stamp: Stamp) -> Vec<Stamped<SensorMessage>> {
        let (due, early) = self.waiting.drain(..).partition::<Vec<_>, _>(|message| message.stamp <= stamp);
        self.waiting = early.into();
        due
    }

    /// Number of messages dropped from a full queue.
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
