//! What the supervisor puts up with.

use crate::scalar::Float;

/// The supervisor's constants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vigilance<S> {
    /// Odometry may be silent for so long \[s].
    pub odometry_age: f64,
    /// Measurements of the pose may be missing for so long \[s]; infinite where there is no sensor for it.
    pub unaided: f64,
    /// A scan is against the map where less than this part of its beams is explained.
    pub explained: S,
    /// It is, too, where more than this part ends beyond the walls.
    pub beyond: S,
    /// A scan with fewer beams says nothing.
    pub fewest_beams: u16,
    /// The robot is lost when so many more scans were against the map than agreed with it.
    pub scans: u16,
    /// The robot is lost when so many more measurements were outliers than were accepted.
    pub measurements: u16,
    /// The mean of the normalised innovation squared per row may be so large, of measurements, and of scans as a whole; 1
    /// for a consistent filter.
    pub innovation: S,
    /// Turn rates may be off by so much on average \[rad/s].
    pub following: S,
    /// The position's standard deviation may be so large \[m] before the robot slows down.
    pub vague: S,
    /// And so large \[m] before it stops.
    pub hopeless: S,
}

impl<S: Float> Default for Vigilance<S> {
    /// For sensors at 10 Hz, of which the laser's beams may be hidden to a fifth by things on no map.
    ///
    /// Six scans against the map make the robot lost. After a kidnap all are: the flag is up within 0.6 s, or 1 s
    /// where two of ten agree by chance.
    fn default() -> Self {
        Self {
            odometry_age: 0.5,
            unaided: 5.0,
            explained: S::of(0.55),
            beyond: S::of(0.12),
            fewest_beams: 12,
            scans: 6,
            measurements: 15,
            innovation: S::of(3.0),
            following: S::of(2.0),
            vague: S::of(0.5),
            hopeless: S::of(2.0),
        }
    }
}
