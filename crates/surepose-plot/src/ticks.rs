//! What is written beside the ticks of an axis.

use std::sync::Arc;

use kuva::TickFormat;

/// From here on a whole number has more digits than can be read at a glance.
const LARGE: f64 = 1e7;

/// Numbers as the library writes them, without the rounding in which ticks are added up.
pub(crate) fn plain() -> TickFormat {
    TickFormat::Custom(Arc::new(|value| {
        let value = rounded(value);
        if value.abs() < LARGE { TickFormat::Auto.format(value) } else { format!("{value:e}") }
    }))
}

/// Numbers of a logarithmic axis: 0.01 rather than 1e-2, down to where zeros can no longer be counted at a glance.
pub(crate) fn decimal() -> TickFormat {
    TickFormat::Custom(Arc::new(|value| {
        let value = rounded(value);
        if value == 0.0 || (1e-3..1e4).contains(&value.abs()) {
            format!("{value}")
        } else {
            format!("{value:e}")
        }
    }))
}

/// To ten digits: 5e-6 rather than 4.9999999999999996e-6.
fn rounded(value: f64) -> f64 {
    format!("{value:.9e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::{decimal, plain};

    #[test]
    fn ticks_are_short() {
        // As they come, from steps of 5e-6 and of 0.1.
        for (value, text) in [
            (4.999_999_999_999_999_6e-6, "5e-6"),
            (0.1 + 0.2, "0.3"),
            (-0.0, "0"),
            (250.0, "250"),
            (1e300, "1e300"),
            (3.0 * 1e22, "3e22"),
        ] {
            assert_eq!(plain().format(value), text);
        }
        for (value, text) in
            [(10f64.powf(-2.0), "0.01"), (1e-5, "1e-5"), (4.999_999_999_999_999_6e-6, "5e-6")]
        {
            assert_eq!(decimal().format(value), text);
        }
    }
}
