//! Beam angles of a laser with a field of view of 180°, counter-clockwise.

use std::f64::consts::{FRAC_PI_2, PI};

/// Returns the first angle and the increment of `count` beams over 180° \[rad\].
///
/// An odd count includes both ends (181 or 361 beams). An even count excludes the last end, as loggers with 180 or 360
/// beams do.
pub(crate) fn beams(count: usize) -> (f64, f64) {
    let steps = if count % 2 == 1 { count - 1 } else { count };
    (-FRAC_PI_2, PI / steps.max(1) as f64)
}
