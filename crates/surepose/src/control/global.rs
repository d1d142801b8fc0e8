//! Global law: approach from any pose, [Tran2012] Sec. 4.1.

use crate::kinematics::Twist;
use crate::scalar::Scalar;

use super::navigation_variables::NavigationVariables;

/// Global law: drives the robot from any pose to the goal pose.
///
/// `v = k_v·ρ·cos α`, `ω = k_α·α + k_v·cos α·sinc α·(α + h·φ)`, [Tran2012] Eq. (23).
///
/// | symbol | meaning | unit | range |
/// |---|---|---|---|
/// | `k_v` | gain of the distance | 1/s | > 0 |
/// | `k_alpha` | gain of the bearing (the paper's Sec. 5.1 prints k_φ) | 1/s | > 0 |
/// | `h` | weight of the direction of approach | – | ≥ 0 |
///
/// # Domain
/// Every input: ρ cancels in ω, and sin α/α is continued to 1.
///
/// # Guarantee
/// Without noise and in continuous time V̇_g = −k_v·ρ²·cos²α − k_α·α² ≤ 0. The certificate covers sampling
/// and noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GlobalLaw<S> {
    /// k_v \[1/s].
    pub k_v: S,
    /// k_α \[1/s].
    pub k_alpha: S,
    /// h.
    pub h: S,
}

impl<S: Scalar> GlobalLaw<S> {
    /// Computes the twist of [Tran2012] Eq. (23).
    #[inline(always)]
    pub fn twist(&self, navigation: &NavigationVariables<S>) -> Twist<S> {
        let alpha = navigation.alpha.radians();
        let (_, cos, sinc) = alpha.sin_cos_sinc();
        self.twist_driven(navigation.rho, alpha, navigation.phi.radians(), cos, sinc)
    }

    /// Computes Eq. (23) with `drive` in place of cos α; `alpha` \[rad] may exceed ±π.
    ///
    /// V̇_g = −k_v·ρ²·drive·cos α − k_α·α²: it descends wherever `drive` has the sign of cos α or is 0. The terms
    /// with φ cancel whatever `drive` is.
    #[inline(always)]
    pub fn twist_driven(&self, rho: S, alpha: S, phi: S, drive: S, sinc: S) -> Twist<S> {
        let approach = self.k_v * drive;
        Twist { v: approach * rho, omega: self.k_alpha * alpha + approach * sinc * (alpha + self.h * phi) }
    }

    /// V_g = ½ρ² + ½(α² + hφ²), [Tran2012] Eq. (19).
    pub fn lyapunov(&self, navigation: &NavigationVariables<S>) -> S {
        let (alpha, phi) = (navigation.alpha.radians(), navigation.phi.radians());
        (navigation.rho.squared() + alpha.squared() + self.h * phi.squared()) * S::from_f64(0.5)
    }

    /// V̇_g under any `twist`, from the rates of [Tran2012] Eq. (2); only for ρ > 0.
    pub fn lyapunov_rate(&self, navigation: &NavigationVariables<S>, twist: Twist<S>) -> S {
        let (rho_rate, alpha_rate, phi_rate) = navigation.rates(twist);
        let (alpha, phi) = (navigation.alpha.radians(), navigation.phi.radians());
        navigation.rho * rho_rate + alpha * alpha_rate + self.h * phi * phi_rate
    }
}
