//! Gyroscope: yaw rate with white noise and a bias that walks randomly.

use crate::random::Stream;

/// Parameters of a yaw-rate gyroscope, which reports the mean rate of every odometry period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GyroscopeModel {
    /// Standard deviation of the mean over one second \[rad/s]. Over a period T it is 1/√T times as large.
    pub noise: f64,
    /// Initial bias \[rad/s].
    pub bias: f64,
    /// Standard deviation of the change of the bias in one second \[rad/s].
    pub bias_walk: f64,
}

impl Default for GyroscopeModel {
    /// A calibrated micromechanical gyroscope: 0.01 °/s/√Hz, no initial bias, 0.002 °/s in one second.
    fn default() -> Self {
        Self { noise: 0.01_f64.to_radians(), bias: 0.0, bias_walk: 0.002_f64.to_radians() }
    }
}

/// State of a gyroscope.
#[derive(Clone, Debug)]
pub(crate) struct Gyroscope {
    drift: f64,
    noise: Stream,
}

impl Gyroscope {
    pub(crate) fn new(noise: Stream) -> Self {
        Self { drift: 0.0, noise }
    }

    /// Measures the mean yaw rate \[rad/s] of a turn by `turn` \[rad] in `period` \[s].
    pub(crate) fn read(&mut self, model: &GyroscopeModel, turn: f64, period: f64) -> f64 {
        self.drift += model.bias_walk * period.sqrt() * self.noise.normal();
        turn / period + model.bias + self.drift + model.noise / period.sqrt() * self.noise.normal()
    }
}

#[cfg(test)]
mod tests {
    use crate::random::Seed;

    use super::{Gyroscope, GyroscopeModel};

    /// Without noise the reading is rate and bias; the white part has the variance σ²/T at every period.
    #[test]
    fn reading_has_bias_and_white_noise() {
        let exact = GyroscopeModel { noise: 0.0, bias: 0.02, bias_walk: 0.0 };
        let mut gyroscope = Gyroscope::new(Seed(1).stream("gyroscope"));
        assert!((gyroscope.read(&exact, 0.05, 0.1) - 0.52).abs() < 1e-15);
        for period in [0.02, 0.1] {
            let noisy = GyroscopeModel { noise: 0.01, ..exact };
            let n = 20_000;
            let squares: f64 =
                (0..n).map(|_| (gyroscope.read(&noisy, 0.0, period) - 0.02).powi(2) * period).sum();
            let ratio = squares / f64::from(n) / 1e-4;
            assert!((ratio - 1.0).abs() < 4.0 * (2.0 / f64::from(n)).sqrt(), "{period}: {ratio}");
        }
    }

    /// After a time t the bias has the variance σ²·t, whatever the period.
    #[test]
    fn bias_walks_randomly() {
        let model = GyroscopeModel { noise: 0.0, bias: 0.0, bias_walk: 0.01 };
        let n = 2000_u32;
        for (period, steps) in [(0.02, 200), (0.1, 40)] {
            let mut squares = 0.0;
            for seed in 0..n {
                let mut gyroscope = Gyroscope::new(Seed(seed.into()).stream("gyroscope"));
                let last = (0..steps).map(|_| gyroscope.read(&model, 0.0, period)).last();
                squares += last.map_or(0.0, |last| last * last);
            }
            let ratio = squares / f64::from(n) / (1e-4 * 4.0);
            assert!((ratio - 1.0).abs() < 4.0 * (2.0 / f64::from(n)).sqrt(), "{period}: {ratio}");
        }
    }
}
