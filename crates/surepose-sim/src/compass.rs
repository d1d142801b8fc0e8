//! The compass: the heading with noise, [Tran2012] Sec. 5.2.

use surepose::geometry::Angle;

use crate::random::Stream;

/// How a compass reads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompassModel {
    /// Standard deviation of a reading \[rad].
    pub std: f64,
    /// What it reads when the robot's heading is 0 \[rad].
    pub offset: f64,
}

impl Default for CompassModel {
    /// The paper's: 0.1°.
    fn default() -> Self {
        Self { std: 0.1_f64.to_radians(), offset: 0.0 }
    }
}

impl CompassModel {
    /// A reading at this true heading.
    pub fn read(&self, heading: Angle<f64>, noise: &mut Stream) -> Angle<f64> {
        heading.rotated_by(self.offset + self.std * noise.normal())
    }
}
