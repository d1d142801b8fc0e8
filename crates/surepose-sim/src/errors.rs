//! Statistics of estimation errors and of their consistency.

/// Accumulator of the errors of a replay.
#[derive(Clone, Debug, Default)]
pub struct ErrorAccumulator {
    position: Vec<f64>,
    heading_squared: f64,
    nees: Vec<f64>,
}

/// Statistics of an [`ErrorAccumulator`]; NEES figures are `None` without samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorSummary {
    /// Root mean square of the position error \[m].
    pub position_rmse: f64,
    /// Median of the position error \[m].
    pub position_median: f64,
    /// Root mean square of the heading error \[rad].
    pub heading_rmse: f64,
    /// Mean of the normalized estimation error squared (NEES).
    pub nees_mean: Option<f64>,
    /// Median of the NEES.
    pub nees_median: Option<f64>,
}

impl ErrorAccumulator {
    /// Adds an error (x \[m], y \[m], θ \[rad]).
    pub fn add(&mut self, [x, y, heading]: [f64; 3]) {
        self.position.push(libm::hypot(x, y));
        self.heading_squared += heading * heading;
    }

    /// Adds a NEES sample.
    pub fn add_nees(&mut self, nees: f64) {
        self.nees.push(nees);
    }

    /// Returns the statistics; `None` without samples.
    pub fn summary(mut self) -> Option<ErrorSummary> {
        let count = self.position.len() as f64;
        let squares: f64 = self.position.iter().map(|error| error * error).sum();
        Some(ErrorSummary {
            position_rmse: libm::sqrt(squares / count),
            position_median: median(&mut self.position)?,
            heading_rmse: libm::sqrt(self.heading_squared / count),
            nees_mean: mean(&self.nees),
            nees_median: median(&mut self.nees),
        })
    }
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// Returns the median; the upper one of an even number.
fn median(values: &mut [f64]) -> Option<f64> {
    let middle = values.len() / 2;
    if values.is_empty() {
        return None;
    }
    Some(*values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn summary_has_root_mean_square_and_median() {
        let mut score = ErrorAccumulator::default();
        score.add([3.0, 4.0, 0.1]);
        score.add([0.0, 1.0, -0.1]);
        score.add([0.0, 0.0, 0.1]);
        score.add_nees(2.0);
        score.add_nees(4.0);
        let summary = score.summary().unwrap();
        assert!((summary.position_rmse - (26.0_f64 / 3.0).sqrt()).abs() < 1e-12);
        assert!((summary.position_median - 1.0).abs() < 1e-12);
        assert!((summary.heading_rmse - 0.1).abs() < 1e-12);
        assert_eq!((summary.nees_mean, summary.nees_median), (Some(3.0), Some(4.0)));
    }

    #[test]
    fn an_empty_accumulator_has_no_summary() {
        assert_eq!(ErrorAccumulator::default().summary(), None);
    }
}
