//! What sensors said, kept until odometry has come to where it was measured.

use std::collections::VecDeque;

use surepose::closed_loop::Signal;
use surepose::{Angle, Body, Laser, Measurement, Pose, Scan, Stamp, Stamped};

/// What a sensor said.
#[derive(Clone, Debug, PartialEq)]
pub enum Heard {
    /// Something that the filter understands as it is.
    Measurement(Measurement<f64>),
    /// A scan.
    Scan(LaserScan),
}

/// One turn of a laser.
#[derive(Clone, Debug, PartialEq)]
pub struct LaserScan {
    /// Direction of the first beam from the laser's x axis \[rad].
    pub first_bearing: f64,
    /// From one beam to the next \[rad].
    pub bearing_step: f64,
    /// The range of every beam \[m]; infinite where nothing came back.
    pub ranges: Vec<f64>,
    /// Nearer returns are the housing's \[m].
    pub nearest: f64,
    /// Farther ones are none \[m].
    pub farthest: f64,
    /// Where the laser sits.
    pub body_from_laser: Pose<Body, Laser, f64>,
}

impl Heard {
    /// In the core's words.
    pub(super) fn signal(heard: &Stamped<Self>) -> Stamped<Signal<'_, f64>> {
        let signal = match &heard.value {
            Self::Measurement(measurement) => Signal::Measurement(*measurement),
            Self::Scan(scan) => Signal::Scan(Scan {
                first_bearing: Angle::wrapped(scan.first_bearing),
                bearing_step: scan.bearing_step,
                ranges: &scan.ranges,
            }),
        };
        Stamped::new(heard.stamp, signal)
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
const ROOM: usize = 140;

/// Signals that odometry has not come to yet.
#[derive(Clone, Debug, Default)]
pub(super) struct Inbox {
    waiting: VecDeque<Stamped<Heard>>,
    dropped: u64,
}

impl Inbox {
    /// Keeps a signal; the oldest one goes where there is no room.
    pub(super) fn put(&mut self, heard: Stamped<Heard>) {
        if self.waiting.len() >= ROOM {
            self.waiting.pop_front();
            self.dropped = self.dropped.saturating_add(1);
        }
        self.waiting.push_back(heard);
    }

    /// Takes out what was measured until `stamp`, in the order in which it arrived.
    pub(super) fn until(&mut self, stamp: Stamp) -> Vec<Stamped<Heard>> {
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
    use super::*;
    use surepose::Compass;

    fn heading(seconds: f64) -> Stamped<Heard> {
        let compass = Compass { heading: Angle::zero(), std: 0.1 };
        Stamped::new(Stamp::from_seconds(seconds), Heard::Measurement(Measurement::Compass(compass)))
    }

    #[test]
    fn what_is_early_waits() {
        let mut inbox = Inbox::default();
        for seconds in [0.3, 0.1, 0.2] {
            inbox.put(heading(seconds));
        }
        let due = inbox.until(Stamp::from_seconds(0.2));
        assert_eq!(due, [heading(0.1), heading(0.2)]);
        assert_eq!(inbox.until(Stamp::from_seconds(1.0)), [heading(0.3)]);
    }

    #[test]
    fn the_room_is_bounded() {
        let mut inbox = Inbox::default();
        for k in 0..1000 {
            inbox.put(heading(f64::from(k)));
        }
        assert_eq!(inbox.dropped(), 1000 - ROOM as u64);
        assert_eq!(inbox.until(Stamp::from_seconds(2000.0)).len(), ROOM);
    }
}
