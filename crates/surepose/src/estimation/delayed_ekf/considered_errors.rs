//! Constant errors of models and map that the filter considers.

use crate::estimation::considered::{
    ConsideredParameters, DisagreeingSensor, InnovationSums, Sensitivity, Variances,
};
use crate::scalar::Float;

use super::DelayedEkf;

impl<S: Float, const N: usize> DelayedEkf<S, N> {
    /// The filter with constant model errors of these standard deviations, which its covariance includes from now on.
    ///
    /// Deviations that are all 0, or not finite, change nothing.
    #[must_use]
    pub fn with_considered(self, parameters: &ConsideredParameters<S>) -> Self {
        let considered = parameters.variances();
        Self { sums: considered.map(|_| InnovationSums::new()), considered, ..self }
    }

    /// The filter with whole scans whose maps have positions of this standard deviation \[m], beyond the considered parameters.
    #[must_use]
    pub fn with_map_std(self, std: S) -> Self {
        if std.is_finite() && std > S::from_f64(0.0) {
            let considered =
                self.considered.unwrap_or(Variances::walls_only()).with_wall_variance(std.squared());
            return Self { considered: Some(considered), ..self };
        }
        self
    }

    /// Sensor that disagrees with the others beyond noise and considered parameters; `None` where all agree, and without
    /// considered parameters.
    pub fn disagreement(&self) -> Option<DisagreeingSensor> {
        self.sums
            .as_ref()
            .zip(self.considered.as_ref())
            .and_then(|(sums, variances)| sums.disagreement(variances))
    }

    /// Sensitivity after the first `count` entries, and variances of the parameters; `None` without considered parameters.
    pub(super) fn considered_after(&self, count: usize) -> Option<(&Sensitivity<S>, &Variances<S>)> {
        self.considered.as_ref().map(|variances| (self.history.sensitivity_after(count), variances))
    }

    /// As [`DelayedEkf::considered_after`], a copy to change.
    pub(super) fn sensitivity_after(&self, count: usize) -> Option<Sensitivity<S>> {
        self.considered_after(count).map(|(sensitivity, _)| *sensitivity)
    }
}
