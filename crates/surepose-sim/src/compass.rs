//! Compass: heading measurement with noise, [Tran2012] Sec. 5.2.

use surepose::geometry::Angle;

use crate::random::Stream;

/// Parameters of a compass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompassModel {
    /// Standard deviation of a measurement \[rad].
    pub std: f64,
    /// Measured heading at a true heading of 0 \[rad], at the start.
    pub offset: f64,
    /// Change of the offset \[rad/s].
    pub drift: f64,
}

impl Default for CompassModel {
    /// The paper's compass: standard deviation 0.1°.
    fn default() -> Self {
        Self { std: 0.1_f64.to_radians(), offset: 0.0, drift: 0.0 }
    }
}

impl CompassModel {
    /// Simulates a measurement at the true heading, `time` \[s] after the start.
    pub fn read(&self, heading: Angle<f64>, time: f64, noise: &mut Stream) -> Angle<f64> {
        heading.rotated_by(self.offset + self.drift * time + self.std * noise.normal())
    }
}
