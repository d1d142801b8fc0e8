//! Times of the beams of a scan, for drivers that stamp another beam or leave the time increment out.

use crate::param::impl_choice;
use crate::scalar::Float;
use crate::time::{Stamp, Stamped};

use super::scan::Scan;

/// The beam whose time a driver writes into the stamp of a scan.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum StampedBeam {
    /// The first one, as in ROS.
    #[default]
    First,
    /// The middle one.
    Middle,
    /// The last one.
    Last,
}

/// Times of the beams as a driver states them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ScanTiming {
    /// Time from the first beam to the last \[s]; `None` takes the time increment of each scan.
    pub sweep: Option<f64>,
    /// The beam that the stamp belongs to.
    pub stamped: StampedBeam,
}

impl_choice!(StampedBeam { First = "first", Middle = "middle", Last = "last" });

impl StampedBeam {
    /// Time from the first beam to this one as a fraction of the sweep.
    pub const fn fraction(self) -> f64 {
        match self {
            Self::First => 0.0,
            Self::Middle => 0.5,
            Self::Last => 1.0,
        }
    }
}

impl ScanTiming {
    /// Converts a scan as the driver states it to one that is stamped at its first beam and has its time increment.
    pub fn resolve<'a, S: Float>(&self, scan: Stamped<Scan<'a, S>>) -> Stamped<Scan<'a, S>> {
        let steps = scan.value.ranges.len().saturating_sub(1).max(1) as f64;
        let increment = self.sweep.map_or(scan.value.time_increment, |sweep| sweep / steps);
        let value = scan.value.with_time_increment(increment);
        Stamped::new(self.first_beam(scan.stamp, value.sweep_duration()), value)
    }

    /// Time of the first beam of a scan with this stamp, whose sweep takes `duration` \[s].
    pub fn first_beam(&self, stamp: Stamp, duration: f64) -> Stamp {
        stamp.after(-self.stamped.fraction() * duration)
    }
}
