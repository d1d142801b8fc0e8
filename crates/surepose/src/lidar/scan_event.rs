//! A processed scan, for observers.

use crate::estimation::Belief;
use crate::map::MapView;
use crate::time::Stamp;

use super::scan::{RangeFinder, Scan};
use super::scan_processor::ScanObservation;

/// A scan and the result of its processing.
#[derive(Clone, Copy, Debug)]
pub struct ScanEvent<'a, S> {
    /// Time of the scan.
    pub stamp: Stamp,
    /// Laser that took the scan.
    pub laser: &'a RangeFinder<S>,
    /// The scan.
    pub scan: &'a Scan<'a, S>,
    /// Lines and poses that the scan processor extracted.
    pub observation: &'a ScanObservation<'a, S>,
    /// Belief at `stamp`, after the correction by the scan.
    pub belief: Belief<S>,
    /// The map.
    pub map: &'a MapView<'a, S>,
}
