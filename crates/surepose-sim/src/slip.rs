//! Wheel slip: white noise between encoder and true travel, and wheels that spin on the floor.

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

/// Grip of the wheels on the floor. The encoders report the turn of the wheels, slip included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Traction {
    /// Fraction of the wheel travel that does not move the robot, in [0, 1).
    pub slip_ratio: f64,
    /// Maximum acceleration that the floor transmits to a contact point \[m/s²]. ∞: the wheels never spin or skid.
    pub acceleration: f64,
}

impl Default for Traction {
    /// Full grip.
    fn default() -> Self {
        Self { slip_ratio: 0.0, acceleration: f64::INFINITY }
    }
}

/// Speeds of the contact points over the floor \[m/s].
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ContactPoints(WheelPair<f64>);

impl ContactPoints {
    /// True travel \[m] of the contact points for the wheel travel \[m] of `time` \[s].
    pub(crate) fn travel(&mut self, model: &Traction, wheels: WheelPair<f64>, time: f64) -> WheelPair<f64> {
        if *model == Traction::default() {
            return wheels;
        }
        let grip = 1.0 - model.slip_ratio;
        let right = model.skid(&mut self.0.right, wheels.right * grip, time);
        let left = model.skid(&mut self.0.left, wheels.left * grip, time);
        WheelPair::new(right, left)
    }
}

impl Traction {
    /// Accelerates a contact point to the speed of its wheel, within the limit; returns its travel \[m].
    fn skid(&self, speed: &mut f64, wheel: f64, time: f64) -> f64 {
        let (before, change) = (*speed, wheel / time - *speed);
        let ramp = (change.abs() / self.acceleration).min(time);
        *speed = if ramp < time { wheel / time } else { before + self.acceleration.copysign(change) * time };
        0.5 * (before + *speed) * ramp + *speed * (time - ramp)
    }
}

#[cfg(test)]
mod tests {
    use surepose::kinematics::WheelPair;

    use crate::random::Seed;

    use super::{ContactPoints, Slip, Traction};

    /// A wheel that spins up to v at once loses v²/(2·a), and as much again when it is blocked.
    #[test]
    fn traction_limit_costs_travel() {
        let model = Traction { acceleration: 0.5, ..Traction::default() };
        let (mut points, mut ahead) = (ContactPoints::default(), 0.0);
        for _ in 0..100 {
            ahead += points.travel(&model, WheelPair::new(0.003, -0.003), 0.01).right;
        }
        assert!((ahead - (0.3 - 0.3 * 0.3 / (2.0 * 0.5))).abs() < 1e-12, "{ahead}");
        let skid: f64 = (0..100).map(|_| points.travel(&model, WheelPair::zero(), 0.01).left).sum();
        assert!((skid + 0.3 * 0.3 / (2.0 * 0.5)).abs() < 1e-12, "{skid}");
        assert_eq!(points.travel(&model, WheelPair::zero(), 0.01), WheelPair::zero());
    }

    #[test]
    fn slip_ratio_scales_the_travel() {
        let model = Traction { slip_ratio: 0.2, ..Traction::default() };
        let travel = ContactPoints::default().travel(&model, WheelPair::new(0.01, -0.02), 0.01);
        assert!((travel.right - 0.008).abs() < 1e-15 && (travel.left + 0.016).abs() < 1e-15, "{travel:?}");
    }

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
