//! One table of bounds: what a number in a file may be before it counts as damage or as a wrong unit.
//!
//! The bounds are far outside anything a wheeled robot records, and far inside what overflows when it is
//! squared or loses its resolution as an `f64`.

use std::fmt;

/// A kind of number with its SI unit and its bounds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Quantity {
    unit: &'static str,
    min: f64,
    max: f64,
}

/// Stamps reach from zero to the year 2286; up there an `f64` still resolves 2 µs.
pub(crate) const TIME: Quantity = Quantity { unit: "s", min: 0.0, max: 1e10 };
/// Map coordinates: UTM northings reach 10⁷ m.
pub(crate) const POSITION: Quantity = Quantity { unit: "m", min: -1e8, max: 1e8 };
/// Headings may be unwrapped, but not by more than 10⁵ turns.
pub(crate) const ANGLE: Quantity = Quantity { unit: "rad", min: -1e6, max: 1e6 };
/// Forward speed of a vehicle on wheels.
pub(crate) const SPEED: Quantity = Quantity { unit: "m/s", min: -1e3, max: 1e3 };
/// Turn rate of a vehicle on wheels.
pub(crate) const TURN_RATE: Quantity = Quantity { unit: "rad/s", min: -1e3, max: 1e3 };
/// Distance to a landmark or a laser return.
pub(crate) const RANGE: Quantity = Quantity { unit: "m", min: 0.0, max: 1e5 };
/// Standard deviation of a coordinate.
pub(crate) const POSITION_STD: Quantity = Quantity { unit: "m", min: 0.0, max: 1e5 };
/// Side of a grid cell.
pub(crate) const RESOLUTION: Quantity = Quantity { unit: "m", min: 1e-6, max: 1e3 };
/// Probability of anything.
pub(crate) const PROBABILITY: Quantity = Quantity { unit: "", min: 0.0, max: 1.0 };
/// Variance or covariance of a line's distance and direction, in any mix of their units.
pub(crate) const COVARIANCE: Quantity = Quantity { unit: "(m, rad)²", min: -1e10, max: 1e10 };

impl Quantity {
    /// Whether `value` is inside the bounds; NaN is not.
    pub(crate) fn admits(&self, value: f64) -> bool {
        value >= self.min && value <= self.max
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:e} to {:e} {}", self.min, self.max, self.unit)
    }
}

/// A number as a person would write it: 0.05 rather than 0.050000000000000003, and 1e300 rather than its 301 digits.
pub(crate) fn plain(number: f64) -> String {
    exact(format!("{number:.8e}").parse().unwrap_or(number))
}

/// The same to the last bit.
fn exact(number: f64) -> String {
    if number != 0.0 && !(1e-6..1e15).contains(&number.abs()) {
        format!("{number:e}")
    } else {
        format!("{number}")
    }
}
