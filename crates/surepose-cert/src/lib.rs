//! The proof that the loop arrives: the law that runs, evaluated with intervals.
#![forbid(unsafe_code)]

mod annulus;
mod certificate;
mod counterexample;
mod descent;
mod drift;
mod edge;
mod fork;
mod interval;
mod map;
mod mind;
mod noise;
mod ranked;
mod region;
mod search;
mod settle;
mod situation;
mod subject;
mod switch;
mod verdict;
mod weight;

pub use certificate::{Certificate, Reason, Request, certify};
pub use counterexample::Counterexample;
pub use drift::{Drift, drift};
pub use fork::explore;
pub use interval::Interval;
pub use map::{MarginAsked, MarginMap, Margins, margin_map, margins};
pub use mind::Mind;
pub use noise::Noise;
pub use settle::Settling;
pub use situation::{Consequence, Situation};
pub use subject::{Shipped, Subject};
pub use verdict::Verdict;
pub use weight::Weight;
