//! Local law near the goal: [Tran2012] Sec. 4.2, with corrected signs.

use crate::kinematics::Twist;
use crate::scalar::Scalar;

use super::navigation_variables::NavigationVariables;

/// Local law: turns the robot to the goal heading near the goal.
///
/// `v = k_v·ρ·cos α`, `ω = −k_θ·θ_e` with θ_e = φ − α.
///
/// | symbol | meaning | unit | range |
/// |---|---|---|---|
/// | `k_v` | gain of the distance | 1/s | > 0 |
/// | `k_theta` | gain of the heading error | 1/s | > 0 |
///
/// # Departure
/// [Tran2012] Eq. (27) has the sign of v·ρ·cos α wrong, and with it Eq. (28) the sign of v: as printed the robot drives
/// away from the goal. [`LocalLaw::as_printed`] is the printed law, for the reproduction.
///
/// # Guarantee
/// Without noise and in continuous time V̇_l = −k_v·ρ²·cos²α − k_θ·θ_e² ≤ 0: the robot stays within the distance
/// at which it entered. No more: every pose with cos α = 0, θ_e = 0 is an equilibrium, so the sideways error is
/// bounded by the capture radius and does not vanish.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalLaw<S> {
    /// k_v \[1/s].
    pub k_v: S,
    /// k_θ \[1/s].
    pub k_theta: S,
}

impl<S: Scalar> LocalLaw<S> {
    /// Computes the twist as printed in [Tran2012] Eq. (28), which diverges; for the reproduction only.
    #[must_use]
    pub fn as_printed(self) -> Self {
        Self { k_v: -self.k_v, k_theta: self.k_theta }
    }

    /// Computes the twist of [Tran2012] Eq. (28), with corrected sign.
    #[inline(always)]
    pub fn twist(&self, navigation: &NavigationVariables<S>) -> Twist<S> {
        let (_, cos) = navigation.alpha.sin_cos();
        self.twist_toward(navigation.rho * cos, navigation.heading_error().radians())
    }

    /// Computes the twist for a goal at the along-track distance `ahead` = ρ·cos α \[m]. The heading error \[rad] may be
    /// unwrapped beyond ±π.
    #[inline(always)]
    pub fn twist_toward(&self, ahead: S, heading_error: S) -> Twist<S> {
        Twist { v: self.k_v * ahead, omega: -(self.k_theta * heading_error) }
    }

    /// V_l = ½ρ² + ½θ_e², [Tran2012] Eq. (26).
    pub fn lyapunov(&self, navigation: &NavigationVariables<S>) -> S {
        let error = navigation.heading_error().radians();
        (navigation.rho.squared() + error.squared()) * S::from_f64(0.5)
    }

    /// V̇_l = −v·ρ·cos α + θ_e·ω under any `twist`: [Tran2012] Eq. (27) with corrected sign.
    pub fn lyapunov_rate(&self, navigation: &NavigationVariables<S>, twist: Twist<S>) -> S {
        let (_, cos) = navigation.alpha.sin_cos();
        navigation.heading_error().radians() * twist.omega - twist.v * navigation.rho * cos
    }
}
