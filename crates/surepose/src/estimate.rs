//! Where am I? Odometry predicts; each measurement is gated, then corrects: [Tran2012] Sec. 3.

mod ekf;
mod estimator;
mod gate;
mod history;
mod measurement;
mod outcome;
mod time;

pub use ekf::{Belief, Correction, Ekf, Travel};
pub use estimator::Estimator;
pub use gate::Gate;
pub use measurement::{
    Compass, Innovation, LandmarkSighting, Measurement, PoseFix, PositionFix, WallSighting,
};
pub use outcome::{Outcome, Refusal, Tally};
pub use time::{Stamp, Stamped};
