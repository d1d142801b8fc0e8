//! Localization: pose estimation, correction by the laser, and supervision of both.
//!
//! [`Localizer`] is the estimation half of a step. Wheel odometry predicts, measurements and scans correct, and the
//! [`LocalizationMonitor`] checks that the map still explains the scans. The [`LocalSearch`] relocalizes a displaced
//! robot near its estimate. The [`GlobalLocalizer`] relocalizes a lost robot: it tracks several hypotheses until one
//! remains.

mod global_localizer;
mod input;
mod local_search;
mod localizer;
mod monitor;
mod observer;
mod slip_monitor;

pub use global_localizer::{
    AcceptanceCriteria, GlobalLocalizer, GlobalStatus, Hypothesis, MAX_LINE_PAIRS, MAX_ODOMETRY_INCREMENTS,
};
pub use input::{Odometry, SensorInput, SensorReading};
pub use local_search::LocalSearch;
pub use localizer::Localizer;
pub use monitor::{LocalizationMonitor, MonitorConfig};
pub use observer::LoopObserver;
