//! Queues measurements until odometry reaches their stamps.

use std::collections::VecDeque;

use surepose::estimation::Measurement;
use surepose::geometry::{Angle, Body, Laser, Pose};
use surepose::lidar::{LaserGeometry, MAX_SWEEP_DURATION, Scan, ScanTiming};
use surepose::localization::SensorReading;
use surepose::time::{Stamp, Stamped};

/// Measurement or scan of a sensor.
#[derive(Clone, Debug, PartialEq)]
pub enum SensorMessage {
    /// Measurement for the filter.
    Measurement(Measurement<f64>),
    /// A scan.
    Scan(LaserScan),
    /// Yaw rate of a gyroscope \[rad/s].
    YawRate(f64),
}

/// Scan with the geometry of its laser.
#[derive(Clone, Debug, PartialEq)]
pub struct LaserScan {
    /// Angle of the first beam from the laser's x axis \[rad].
    pub angle_min: f64,
    /// Angle between adjacent beams \[rad].
    pub angle_increment: f64,
    /// Time between adjacent beams \[s]; 0 for beams that were all measured at the stamp.
    pub time_increment: f64,
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
            Self::YawRate(rate) => SensorReading::YawRate(*rate),
            Self::Scan(scan) => {
                let LaserScan { body_from_laser, range_min, range_max, .. } = *scan;
                let geometry = LaserGeometry { body_from_laser, range_min, range_max };
                let angle_min = Angle::from_radians(scan.angle_min);
                let beams = Scan::new(angle_min, scan.angle_increment, &scan.ranges);
                let beams = beams.with_time_increment(scan.time_increment);
                SensorReading::Scan(beams.with_geometry(geometry))
            }
        };
        Stamped::new(message.stamp, reading)
    }

    /// Scan of the message; `None` for a measurement.
    pub(super) fn scan(&self) -> Option<&LaserScan> {
        match self {
            Self::Scan(scan) => Some(scan),
            Self::Measurement(_) | Self::YawRate(_) => None,
        }
    }
}

impl LaserScan {
    /// Time from the first beam to the last \[s].
    fn sweep_duration(&self) -> f64 {
        self.time_increment * self.ranges.len().saturating_sub(1) as f64
    }

    /// Sets the time increment by the configuration, and returns the time of the first beam.
    pub(super) fn resolve(&mut self, stamp: Stamp, timing: &ScanTiming) -> Stamp {
        let scan = Scan::new(Angle::zero(), 1.0, &self.ranges).with_time_increment(self.time_increment);
        let resolved = timing.resolve(Stamped::new(stamp, scan));
        let (first, time_increment) = (resolved.stamp, resolved.value.time_increment);
        self.time_increment = time_increment;
        first
    }
}

/// Time of the last measurement of a message, which odometry must reach. A sweep that is invalid does not count.
fn complete_at(message: &Stamped<SensorMessage>) -> Stamp {
    let duration = message.value.scan().map_or(0.0, LaserScan::sweep_duration);
    if (0.0..=MAX_SWEEP_DURATION).contains(&duration) { message.stamp.after(duration) } else { message.stamp }
}

/// Largest number of queued messages: 1 s of headings at 100 Hz, yaw rates at 200 Hz and scans at 40 Hz.
const CAPACITY: usize = 340;

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

    /// Drops the messages with stamps after `begin` and before `end`.
    pub(super) fn drop_between(&mut self, begin: Stamp, end: Stamp) {
        let before = self.waiting.len();
        self.waiting.retain(|message| message.stamp <= begin || message.stamp >= end);
        self.dropped = self.dropped.saturating_add((before - self.waiting.len()) as u64);
    }

    /// Removes and returns the messages that are complete at `stamp`, in the order of arrival: a scan once its last beam
    /// was measured.
    pub(super) fn until(&mut self, stamp: Stamp) -> Vec<Stamped<SensorMessage>> {
        let (due, early) =
            self.waiting.drain(..).partition::<Vec<_>, _>(|message| complete_at(message) <= stamp);
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
    fn a_scan_waits_for_its_last_beam() {
        let scan = |time_increment| LaserScan {
            angle_min: 0.0,
            angle_increment: 0.01,
            time_increment,
            ranges: vec![1.0; 101],
            range_min: 0.05,
            range_max: 30.0,
            body_from_laser: Pose::identity(),
        };
        let stamped = |scan| Stamped::new(Stamp::from_seconds(1.0), SensorMessage::Scan(scan));
        let mut measurement_queue = MeasurementQueue::default();
        measurement_queue.put(stamped(scan(1e-3)));
        assert!(measurement_queue.until(Stamp::from_seconds(1.09)).is_empty());
        assert_eq!(measurement_queue.until(Stamp::from_seconds(1.1)).len(), 1);
        // An invalid sweep is passed on at once, to be counted.
        for time_increment in [f64::NAN, -1.0, 1.0] {
            measurement_queue.put(stamped(scan(time_increment)));
            assert_eq!(measurement_queue.until(Stamp::from_seconds(1.0)).len(), 1);
        }
        let timing = ScanTiming { sweep: Some(0.2), stamped: surepose::lidar::StampedBeam::Middle };
        let mut resolved = scan(0.0);
        assert_eq!(resolved.resolve(Stamp::from_seconds(1.0), &timing), Stamp::from_seconds(0.9));
        assert!((resolved.sweep_duration() - 0.2).abs() < 1e-12);
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
