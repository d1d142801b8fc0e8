//! Errors of a line that is fitted to the cells that a straight wall occupies.
//!
//! The cells repeat one pattern along the wall, so the error of the line does not average out as noise does. A wall
//! parallel to the raster that stays in one row is anywhere in it: offset std 1/√12 of a cell. A wall that crosses several
//! rows is known better. Near every slope p/q the pattern repeats after q columns, and 1/q of these errors remains.

/// Largest q of the slopes p/q whose repeating pattern is considered.
const MAX_PERIOD: u32 = 6;

/// Variance of a uniform position in a cell, in cells².
const CELL_VARIANCE: f64 = 1.0 / 12.0;

/// Rise of the fitted line, in rows, from which the row of the wall no longer limits its offset. The rise itself is
/// inaccurate: a line through one step between two rows rises by up to 1.5.
const KNOWN_ROWS: f64 = 1.6;

/// Standard deviation of the rise over the wall, in cells, while the wall stays within one row or enters the next.
const RISE_STD: f64 = 0.6;

/// Standard deviation of the offset that always remains, in cells.
const MIN_OFFSET_STD: f64 = 0.05;

/// Standard deviation of the rise over the wall that always remains, in cells.
const MIN_RISE_STD: f64 = 0.1;

/// Columns over which deviations that are not of the raster are correlated.
const CORRELATED_COLUMNS: f64 = 4.0;

/// Variances of a fitted line in cells, measured along a column: offset at the middle, and rise over the whole length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RasterError {
    pub offset_variance: f64,
    pub rise_variance: f64,
}

/// Returns the errors of a line fitted to `columns` columns, with the absolute `slope` against the rows, 0 to 1.
///
/// `mean_square` is that of the deviations along a column; what exceeds the raster's share is noise.
pub(super) fn raster_error(slope: f64, columns: f64, mean_square: f64) -> RasterError {
    let noise = (mean_square - CELL_VARIANCE).max(0.0) * CORRELATED_COLUMNS / columns;
    let mut offset = MIN_OFFSET_STD * MIN_OFFSET_STD + noise;
    let mut rise = MIN_RISE_STD * MIN_RISE_STD + 12.0 * noise;
    for period in 1..=MAX_PERIOD {
        let rows = (slope * f64::from(period)).round();
        if !is_coprime(rows as u32, period) {
            continue;
        }
        let period = f64::from(period);
        // Rows of the pattern that the wall crosses relative to the nearest slope p/q.
        let off = (slope * period - rows).abs() * columns;
        let fraction = (1.0 / (period * period)) * CELL_VARIANCE;
        let remaining = 1.0 - off / KNOWN_ROWS;
        if remaining > 0.0 {
            offset += fraction * remaining * remaining;
        }
        let rows = (off / KNOWN_ROWS).max(1.0) * period;
        rise += RISE_STD * RISE_STD / (rows * rows);
    }
    RasterError { offset_variance: offset, rise_variance: rise }
}

fn is_coprime(a: u32, b: u32) -> bool {
    if b == 0 { a == 1 } else { is_coprime(b, a % b) }
}
