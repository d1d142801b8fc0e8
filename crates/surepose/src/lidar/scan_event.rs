//! A scan that was processed, for observers.

use crate::estimation::Belief;
use crate::map::MapView;
use crate::time::Stamp;

use super::scan::{RangeFinder, Scan};
use super::scan_processor::ScanObservation;

/// A scan and what the scan processor made of it.
#[derive(Clone, Copy, Debug)]
pub struct ScanEvent<'a, S> {
    /// When the scan was taken.
    pub stamp: Stamp,
    /// The laser that took it.
    pub laser: &'a RangeFinder<S>,
    /// The scan.
    pub scan: &'a Scan<'a, S>,
    /// Lines and poses that the scan processor found in it.
    pub observation: &'a ScanObservation<'a, S>,
    /// The belief at `stamp`, after the scan corrected it.
    pub belief: Belief<S>,
    /// The map.
    pub map: &'a MapView<'a, S>,
}
