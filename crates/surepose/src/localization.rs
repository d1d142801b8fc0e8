//! Localization: the estimate, the laser that corrects it, and the supervision of both.
//!
//! [`Localizer`] is the estimating half of a step: wheel odometry predicts, measurements and scans correct, and the
//! [`LocalizationMonitor`] checks that the map still explains what the laser sees. A robot that was pushed is found by the
//! [`LocalSearch`] around its estimate, a lost one by the [`GlobalLocalizer`], which follows several hypotheses until
//! one is left.

mod global_localizer;
mod input;
mod local_search;
mod localizer;
mod monitor;
mod observer;

pub use global_localizer::{
    AcceptanceCriteria, GlobalLocalizer, GlobalStatus, Hypothesis, MAX_LINE_PAIRS, MAX_ODOMETRY_INCREMENTS,
};
pub use input::{Odometry, SensorInput, SensorReading};
pub use local_search::LocalSearch;
pub use localizer::Localizer;
pub use monitor::{LocalizationMonitor, MonitorConfig};
pub use observer::LoopObserver;
