//! Compass: heading measurement with noise, [Tran2012] Sec. 5.2.

use surepose::geometry::Angle;

use crate::random::Stream;

/// Parameters of a compass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompassModel {
    /// Standard deviation of a measurement \[rad].
    pub std: f64,
    /// Measured heading at a true heading of 0 \[rad].
    pub offset: f64,
}

impl Default for CompassModel {
    /// The paper's compass: standard deviation 0.1°.
    fn default() -> Self {
        Self { std: 0.1_f64.to_radians(), offset: 0.0 }
    }
}

impl CompassModel {
    /// Simulates a measurement at the true heading.
    pub fn read(&self, heading: Angle<f64>, noise: &mut Stream) -> Angle<f64> {
        heading.rotated_by(self.offset + self.std * noise.normal())
    }
}
