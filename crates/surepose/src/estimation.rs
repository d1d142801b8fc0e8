//! Pose estimation by an extended Kalman filter with gated measurements: [Tran2012] Sec. 3.

mod considered;
mod delayed_ekf;
mod ekf;
mod gate;
mod gyroscope;
mod history;
mod measurement;
mod outcome;

pub use considered::{ConsideredParameters, DisagreeingSensor};
pub use delayed_ekf::{DelayedEkf, SWEEP_KNOTS, SweepMotion};
pub use ekf::{Belief, Correction, Ekf, WheelOdometry};
pub use gate::Gate;
pub use gyroscope::{Gyroscope, GyroscopeBias, GyroscopeTurn};
pub use measurement::{
    HeadingMeasurement, Innovation, LineMeasurement, Measurement, PoseMeasurement, PositionMeasurement,
    RangeBearingMeasurement,
};
pub use outcome::{MeasurementOutcome, MeasurementStats, OdometryOutcome, RejectReason};
