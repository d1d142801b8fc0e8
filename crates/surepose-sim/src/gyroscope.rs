//! Gyroscope: yaw rate with white noise and a bias that walks randomly.

use crate::random::Stream;

/// Parameters of a yaw-rate gyroscope, which reports the mean rate of every odometry period.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GyroscopeModel {
    /// Standard deviation of a reading \[rad/s], white.
    pub std: f64,
    /// Mean of the initial bias \[rad/s].
    pub bias: f64,
    /// Standard deviation of the initial bias \[rad/s].
    pub bias_std: f64,
    /// Standard deviation of the change of the bias in one second \[rad/s].
    pub bias_walk: f64,
}

/// State of a gyroscope.
#[derive(Clone, Debug)]
pub(crate) struct GyroscopeState {
    /// Bias less its mean \[rad/s]; `None` before the first reading.
    drift: Option<f64>,
    noise: Stream,
}

impl GyroscopeState {
    pub(crate) fn new(noise: Stream) -> Self {
        Self { drift: None, noise }
    }

    /// Measures the mean yaw rate \[rad/s] of a turn by `turn` \[rad] in `period` \[s].
    pub(crate) fn read(&mut self, model: &GyroscopeModel, turn: f64, period: f64) -> f64 {
        let initial = self.drift.unwrap_or_else(|| model.bias_std * self.noise.normal());
        let drift = initial + model.bias_walk * period.sqrt() * self.noise.normal();
        self.drift = Some(drift);
        turn / period + model.bias + drift + model.std * self.noise.normal()
    }
}

#[cfg(test)]
mod tests {
    use crate::random::Seed;

    use super::{GyroscopeModel, GyroscopeState};

    /// Without noise the reading is rate and bias; the white part has the variance σ².
    #[test]
    fn reading_has_bias_and_white_noise() {
        let exact = GyroscopeModel { bias: 0.02, ..GyroscopeModel::default() };
        let mut gyroscope = GyroscopeState::new(Seed(1).stream("gyroscope"));
        assert!((gyroscope.read(&exact, 0.05, 0.1) - 0.52).abs() < 1e-15);
        let noisy = GyroscopeModel { std: 0.01, ..exact };
        let n = 20_000;
        let squares: f64 = (0..n).map(|_| (gyroscope.read(&noisy, 0.0, 0.1) - 0.02).powi(2)).sum();
        let ratio = squares / f64::from(n) / 1e-4;
        assert!((ratio - 1.0).abs() < 4.0 * (2.0 / f64::from(n)).sqrt(), "{ratio}");
    }

    /// After a time t the bias has the variance σ₀² + σ²·t, whatever the period.
    #[test]
    fn bias_walks_randomly() {
        let model = GyroscopeModel { bias_walk: 0.01, bias_std: 0.01, ..GyroscopeModel::default() };
        let n = 2000_u32;
        for (period, steps) in [(0.02, 200), (0.1, 40)] {
            let mut squares = 0.0;
            for seed in 0..n {
                let mut gyroscope = GyroscopeState::new(Seed(seed.into()).stream("gyroscope"));
                let last = (0..steps).map(|_| gyroscope.read(&model, 0.0, period)).last();
                squares += last.map_or(0.0, |last| last * last);
            }
            let ratio = squares / f64::from(n) / (1e-4 * 5.0);
            assert!((ratio - 1.0).abs() < 4.0 * (2.0 / f64::from(n)).sqrt(), "{period}: {ratio}");
        }
    }
}
