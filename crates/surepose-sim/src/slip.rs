//! Slip: what stands between how far a wheel rolled by its encoder and how far its rim came.

use surepose::kinematics::WheelPair;

use crate::random::Stream;

/// Independent white noise of each wheel, proportional to its travel: what Q of [Tran2012] Eq. (15) describes.
///
/// One factor holds for one odometry period; periods are independent. The variance of a distance therefore depends
/// on the period, in the paper's model as here.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slip {
    /// δ, the variance of the relative error of one period's travel.
    pub delta: f64,
}

impl Slip {
    /// One period's factors between a wheel's two travels.
    pub fn factors(&self, noise: &mut Stream) -> WheelPair<f64> {
        let std = self.delta.sqrt();
        WheelPair::new(1.0 + std * noise.normal(), 1.0 + std * noise.normal())
    }

    /// What one of the two travels of a period makes of the other.
    ///
    /// To first order in √δ it does not matter which is given: a world turns encoder travel into true travel, a
    /// prescribed course true travel into encoder travel.
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
        // Four standard errors: √(2/n) of a variance, 1/√n of a correlation.
        let n = f64::from(n);
        for variance in [right / n, left / n] {
            assert!((variance / 0.0025 - 1.0).abs() < 4.0 * (2.0 / n).sqrt(), "{variance}");
        }
        assert!((both / n / 0.0025).abs() < 4.0 / n.sqrt());
    }
}
