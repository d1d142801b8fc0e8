//! The proof that the loop arrives: the law that runs, evaluated with intervals.
#![forbid(unsafe_code)]

mod fork;
mod interval;
mod verdict;

pub use fork::explore;
pub use interval::Interval;
pub use verdict::Verdict;
