//! The beams of a laser that sees half a circle, from its right to its left.

use std::f64::consts::{FRAC_PI_2, PI};

/// First direction and step of `count` beams over 180° \[rad\].
///
/// An odd count includes both ends (181 or 361 beams); an even one leaves out the last, as the logger did that
/// wrote 180 or 360 of them.
pub(crate) fn beams(count: usize) -> (f64, f64) {
    let steps = if count % 2 == 1 { count - 1 } else { count };
    (-FRAC_PI_2, PI / steps.max(1) as f64)
}
