//! What recordings hold, in SI units and radians: stamped poses, twists and wheel ticks, and laser scans.
//!
//! Headings are as recorded, not wrapped. Stamps are those of the recording, never going back; their zero is
//! the recording's own.

/// A pose at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StampedPose {
    /// Time \[s\].
    pub time: f64,
    /// Position \[m\].
    pub x: f64,
    /// Position \[m\].
    pub y: f64,
    /// Heading, counter-clockwise from the x axis, as recorded \[rad\].
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
