//! χ² gate of the normalized innovation of a measurement.

use crate::scalar::Scalar;

/// Maximum accepted normalized innovation squared, by the dimension of a measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gate<S> {
    thresholds: [S; 3],
}

impl<S: Scalar> Gate<S> {
    /// Gate that accepts a consistent measurement with `probability`, limited to [0.5, 1 − 1e-12].
    pub fn new(probability: f64) -> Self {
        let probability = if probability.is_nan() { 0.99 } else { probability.clamp(0.5, 1.0 - 1e-12) };
        Self { thresholds: [1, 2, 3].map(|dof| S::from_f64(quantile(dof, probability))) }
    }

    /// Gate that rejects no finite measurement.
    pub fn disabled() -> Self {
        Self { thresholds: [S::from_f64(1e30); 3] }
    }

    /// Maximum accepted normalized innovation squared of a measurement with `dimension` components (1, 2 or 3).
    #[inline]
    pub fn threshold(&self, dimension: usize) -> S {
        self.thresholds[dimension.clamp(1, 3) - 1]
    }
}

/// χ² quantile for 1, 2 or 3 degrees of freedom, by bisection of the distribution function.
fn quantile(degrees: u8, probability: f64) -> f64 {
    let (mut low, mut high) = (0.0, 100.0);
    for _ in 0..64 {
        let middle = 0.5 * (low + high);
        if distribution(degrees, middle) < probability {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

fn distribution(degrees: u8, x: f64) -> f64 {
    let tail = libm::exp(-0.5 * x);
    let inner = libm::erf(libm::sqrt(0.5 * x));
    match degrees {
        1 => inner,
        2 => 1.0 - tail,
        _ => inner - libm::sqrt(2.0 * x / core::f64::consts::PI) * tail,
    }
}

#[cfg(test)]
mod tests {
    use super::Gate;

    /// Published χ² table at 99 %.
    #[test]
    fn thresholds_are_the_tabulated_quantiles() {
        let gate = Gate::<f64>::new(0.99);
        for (dimension, tabulated) in [(1, 6.635), (2, 9.210), (3, 11.345)] {
            assert!((gate.threshold(dimension) - tabulated).abs() < 5e-4, "{dimension} rows");
        }
    }
}
