//! Tick positions and labels of an axis.

/// A tick of an axis.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Tick {
    pub(crate) at: f64,
    /// Label; empty for a minor tick.
    pub(crate) text: String,
}

/// Labels with more decimals than this, or values from `MAX_PLAIN` on, have an exponent.
const MAX_DECIMALS: usize = 4;
const MAX_PLAIN: f64 = 1e6;
/// Range of decade exponents that are labeled without powers.
const PLAIN_DECADES: std::ops::RangeInclusive<i32> = -3..=4;
/// Maximum number of ticks; a step that is too small gives none.
const MAX_TICKS: f64 = 200.0;

/// Returns at most `most` + 1 multiples of a round step between `low` and `high`.
pub(crate) fn linear(low: f64, high: f64, most: usize) -> Vec<Tick> {
    let rough = (high - low) / most.max(1) as f64;
    let decade = 10f64.powf(rough.log10().floor());
    let round = [1.0, 2.0, 5.0].into_iter().find(|round| round * decade >= rough * (1.0 - 1e-9));
    stepped(low, high, decade * round.unwrap_or(10.0))
}

/// Returns the multiples of `step` between `low` and `high`.
pub(crate) fn stepped(low: f64, high: f64, step: f64) -> Vec<Tick> {
    let (first, last) = ((low / step - 1e-9).ceil(), (high / step + 1e-9).floor());
    // The negated condition also holds for NaN.
    if !(step > 0.0 && last - first <= MAX_TICKS) {
        return Vec::new();
    }
    let count = (last - first).max(-1.0) as i64 + 1;
    let largest = low.abs().max(high.abs());
    (0..count)
        .map(|k| (first + k as f64) * step)
        .map(|at| Tick { at, text: number(at, step, largest) })
        .collect()
}

/// Returns ticks of a logarithmic axis: at most `most` decades, or parts of one decade.
pub(crate) fn logarithmic(low: f64, high: f64, most: usize) -> Vec<Tick> {
    if !(low > 0.0 && low < high && high.is_finite()) {
        return Vec::new();
    }
    let (first, last) = ((low.log10() - 1e-9).ceil() as i32, (high.log10() + 1e-9).floor() as i32);
    let decades = last - first + 1;
    let within = |at: &f64| (low * (1.0 - 1e-9)..=high * (1.0 + 1e-9)).contains(at);
    if decades < 2 {
        let parts = (first - 1..=last).flat_map(|k| [1.0, 2.0, 5.0].map(|part| part * 10f64.powi(k)));
        let parts: Vec<f64> = parts.filter(within).collect();
        if parts.len() < 3 {
            return linear(low, high, most);
        }
        return parts.into_iter().map(|at| Tick { at, text: number(at, at, high) }).collect();
    }
    let stride = (f64::from(decades) / most.max(1) as f64).ceil() as i32;
    let plain = PLAIN_DECADES.contains(&first) && PLAIN_DECADES.contains(&last);
    let mut ticks = Vec::new();
    for k in first - 1..=last {
        let at = 10f64.powi(k);
        if k >= first && (k - first) % stride == 0 {
            let text = if plain { number(at, at.min(1.0), at) } else { power(k) };
            ticks.push(Tick { at, text });
        }
        // Minor ticks between the decades, if every decade is labeled.
        let parts = (2..10).map(|part| f64::from(part) * at).filter(|at| stride == 1 && within(at));
        ticks.extend(parts.map(|at| Tick { at, text: String::new() }));
    }
    ticks
}

/// Formats a multiple of `step` for an axis with values up to `largest`.
fn number(value: f64, step: f64, largest: f64) -> String {
    let is_whole = |decimals: &usize| {
        let scaled = step * 10f64.powf(*decimals as f64);
        scaled >= 0.5 && (scaled - scaled.round()).abs() < 1e-6 * scaled
    };
    let text = match (0..=MAX_DECIMALS).find(is_whole) {
        // Adding 0 turns −0 into 0.
        Some(decimals) if largest < MAX_PLAIN => format!("{:.decimals$}", value + 0.0),
        _ if value == 0.0 => "0".to_owned(),
        // Ten digits: 5e-6 instead of 4.9999999999999996e-6.
        _ => format!("{:e}", format!("{value:.9e}").parse().unwrap_or(value)),
    };
    text.replace('-', "−")
}

/// Formats a power of ten.
fn power(exponent: i32) -> String {
    let raised = |letter| match letter {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '4' => '⁴',
        '5' => '⁵',
        '6' => '⁶',
        '7' => '⁷',
        '8' => '⁸',
        '9' => '⁹',
        _ => '⁰',
    };
    format!("10{}", exponent.to_string().chars().map(raised).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::{Tick, linear, logarithmic, stepped};

    fn texts(ticks: Vec<Tick>) -> Vec<String> {
        ticks.into_iter().map(|tick| tick.text).filter(|text| !text.is_empty()).collect()
    }

    #[test]
    fn linear_ticks_are_round_and_within_the_range() {
        assert_eq!(texts(linear(1.0, 1.4, 5)), ["1.0", "1.1", "1.2", "1.3", "1.4"]);
        assert_eq!(texts(linear(0.0, 100.0, 5)), ["0", "20", "40", "60", "80", "100"]);
        assert_eq!(texts(linear(-0.12, 0.11, 5)), ["−0.10", "−0.05", "0.00", "0.05", "0.10"]);
        assert_eq!(texts(linear(0.0, 1.7e-5, 4)), ["0", "5e−6", "1e−5", "1.5e−5"]);
        assert_eq!(texts(linear(0.0, 3e200, 3)), ["0", "1e200", "2e200", "3e200"]);
        assert_eq!(texts(stepped(-180.0, 180.0, 90.0)), ["−180", "−90", "0", "90", "180"]);
        assert_eq!(texts(stepped(0.0, 1.0, 0.25)), ["0.00", "0.25", "0.50", "0.75", "1.00"]);
    }

    #[test]
    fn logarithmic_ticks_are_decades_or_parts_of_them() {
        assert_eq!(texts(logarithmic(0.01, 10.0, 6)), ["0.01", "0.1", "1", "10"]);
        assert_eq!(texts(logarithmic(1e-6, 10.0, 4)), ["10⁻⁶", "10⁻⁴", "10⁻²", "10⁰"]);
        assert_eq!(texts(logarithmic(0.9, 6.0, 6)), ["1", "2", "5"]);
        assert_eq!(texts(logarithmic(1.1, 1.5, 5)), ["1.1", "1.2", "1.3", "1.4", "1.5"]);
        assert_eq!(logarithmic(1.0, 100.0, 6).len(), 3 + 2 * 8);
    }

    #[test]
    fn invalid_ranges_have_no_ticks() {
        for (low, high) in [(f64::NAN, 1.0), (0.0, f64::INFINITY), (1.0, 1.0), (2.0, 1.0)] {
            assert!(linear(low, high, 5).len() <= 1, "{low} {high}");
            assert!(logarithmic(low, high, 5).is_empty(), "{low} {high}");
        }
    }
}
