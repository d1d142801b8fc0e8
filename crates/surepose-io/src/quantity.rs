//! Defines the bounds of numbers in files, beyond which a value counts as damaged or in a wrong unit.
//!
//! The bounds are far outside the values of wheeled robots. They are far inside the range in which squares overflow or
//! an `f64` loses resolution.

use std::fmt;

/// A physical quantity with its SI unit and its bounds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Quantity {
    unit: &'static str,
    min: f64,
    max: f64,
}

/// Time stamps, from 0 to the year 2286, where an `f64` still resolves 2 µs.
pub(crate) const TIME: Quantity = Quantity { unit: "s", min: 0.0, max: 1e10 };
/// Time stamps of a logger whose clock may begin below 0.
pub(crate) const SIGNED_TIME: Quantity = Quantity { unit: "s", min: -1e10, max: 1e10 };
/// Map coordinates; UTM northings reach 10⁷ m.
pub(crate) const POSITION: Quantity = Quantity { unit: "m", min: -1e8, max: 1e8 };
/// Headings, possibly unwrapped, up to 10⁵ turns.
pub(crate) const ANGLE: Quantity = Quantity { unit: "rad", min: -1e6, max: 1e6 };
/// Forward speed of a wheeled vehicle.
pub(crate) const SPEED: Quantity = Quantity { unit: "m/s", min: -1e3, max: 1e3 };
/// Turn rate of a wheeled vehicle.
pub(crate) const TURN_RATE: Quantity = Quantity { unit: "rad/s", min: -1e3, max: 1e3 };
/// Distance to a landmark or a laser return.
pub(crate) const RANGE: Quantity = Quantity { unit: "m", min: 0.0, max: 1e5 };
/// Standard deviation of a coordinate.
pub(crate) const POSITION_STD: Quantity = Quantity { unit: "m", min: 0.0, max: 1e5 };
/// Edge length of a grid cell.
pub(crate) const RESOLUTION: Quantity = Quantity { unit: "m", min: 1e-6, max: 1e3 };
/// Probability.
pub(crate) const PROBABILITY: Quantity = Quantity { unit: "", min: 0.0, max: 1.0 };
/// Variances and covariance of the distance and direction of a line, in any combination of their units.
pub(crate) const COVARIANCE: Quantity = Quantity { unit: "(m, rad)²", min: -1e10, max: 1e10 };

impl Quantity {
    /// Returns whether `value` is within the bounds; `false` for NaN.
    pub(crate) fn admits(&self, value: f64) -> bool {
        value >= self.min && value <= self.max
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:e} to {:e} {}", self.min, self.max, self.unit)
    }
}

/// Formats a number with at most 9 significant digits: 0.05 instead of 0.050000000000000003.
///
/// Very large and very small numbers have an exponent: 1e300.
pub(crate) fn plain(number: f64) -> String {
    exact(format!("{number:.8e}").parse().unwrap_or(number))
}

/// Formats a number with as many digits as it needs to be read back exactly.
fn exact(number: f64) -> String {
    if number != 0.0 && !(1e-6..1e15).contains(&number.abs()) {
        format!("{number:e}")
    } else {
        format!("{number}")
    }
}
