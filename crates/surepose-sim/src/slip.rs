//! Wheel slip: ratio between the travel measured by the encoder and the true travel.

use surepose::kinematics::WheelPair;

use crate::random::Stream;

/// Independent white noise per wheel, proportional to the travel, as Q of [Tran2012] Eq. (15) models it.
///
/// One factor holds for one odometry period; periods are independent. The variance of a distance therefore
/// depends on the period, here as in the paper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slip {
    /// Variance δ of the relative travel error of one period.
    pub delta: f64,
}

impl Slip {
    /// Draws the slip factors of one period.
    pub fn factors(&self, noise: &mut Stream) -> WheelPair<f64> {
        let std = self.delta.sqrt();
        WheelPair::new(1.0 + std * noise.normal(), 1.0 + std * noise.normal())
    }

    /// Applies the slip of one period to a travel \[m].
    ///
    /// To first order in √δ, the direction of the conversion does not matter. `World` converts encoder travel
    /// to true travel; a prescribed course converts true travel to encoder travel.
    pub fn apply(&self, travel: WheelPair<f64>, noise: &mut Stream) -> WheelPair<f64> {
        let factors = self.factors(noise);
        WheelPair::new(travel.right * factors.right, travel.left * factors.left)
    }
}

#[cfg(test)]
mod tests {
    use surepose::kinematics::WheelPair;

    use crate::random::Seed;

    use super::Slip;

    #[test]
    fn relative_error_has_variance_delta_on_each_wheel() {
        let mut noise = Seed(3).stream("slip");
        let slip = Slip { delta: 0.0025 };
        let n = 20_000;
        let (mut right, mut left, mut both) = (0.0, 0.0, 0.0);
        for _ in 0..n {
            let travel = slip.apply(WheelPair::new(0.03, -0.01), &mut noise);
            let (r, l) = (travel.right / 0.03 - 1.0, travel.left / -0.01 - 1.0);
            right += r * r;
            left += l * l;
            both += r * l;
        }
        // Bounds of four standard errors: √(2/n) for a variance, 1/√n for a correlation.
        let n = f64::from(n);
        for variance in [right / n, left / n] {
            assert!((variance / 0.0025 - 1.0).abs() < 4.0 * (2.0 / n).sqrt(), "{variance}");
        }
        assert!((both / n / 0.0025).abs() < 4.0 / n.sqrt());
    }
}
