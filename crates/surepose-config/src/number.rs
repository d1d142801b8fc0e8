//! Numbers as text, as a person would write them.

/// `number` with nine significant digits: 0.05 rather than 0.050000000000000003.
pub(crate) fn plain(number: f64) -> String {
    exact(format!("{number:.8e}").parse().unwrap_or(number))
}

/// `number` to the last bit; very large and very small ones in scientific notation.
pub(crate) fn exact(number: f64) -> String {
    if number != 0.0 && !(1e-6..1e15).contains(&number.abs()) {
        format!("{number:e}")
    } else {
        format!("{number}")
    }
}
