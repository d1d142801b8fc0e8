//! Hybrid law as in [Tran2012], with corrected signs, for comparison and figures.

use crate::kinematics::Twist;
use crate::scalar::{Mask, Scalar};

use super::directed_error::DirectedError;
use super::gains::Gains;
use super::global::GlobalLaw;
use super::hysteresis::HybridState;
use super::local::LocalLaw;
use super::navigation_variables::NavigationVariables;
use super::output::{ActiveMode, ControlOutput};

/// [Tran2012] Sec. 4: the local law on Ω_l = {ρ < ε_P, |φ − α| < ε_θ}, the global law elsewhere. It has no state.
///
/// # Departure
/// (28) with corrected sign, see [`LocalLaw`]. The paper gives no ε_θ: one below π leaves the robot to the global
/// law on top of the goal, where α is noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tran2012Law<S> {
    /// Gains of both laws.
    pub gains: Gains<S>,
    /// ε_P \[m].
    pub capture_radius: S,
    /// ε_θ \[rad].
    pub capture_heading: S,
}

impl<S: Scalar> Tran2012Law<S> {
    /// Returns the global law with these gains.
    #[inline(always)]
    pub fn global(&self) -> GlobalLaw<S> {
        GlobalLaw { k_v: self.gains.k_v, k_alpha: self.gains.k_alpha, h: self.gains.h }
    }

    /// Returns the local law with these gains.
    #[inline(always)]
    pub fn local(&self) -> LocalLaw<S> {
        LocalLaw { k_v: self.gains.k_v, k_theta: self.gains.k_theta }
    }

    /// Computes the twist for the goal; of the state it sets only `local_mode`, for plots of the switch.
    #[inline(always)]
    pub fn compute(&self, navigation: &NavigationVariables<S>, state: HybridState<S>) -> ControlOutput<S> {
        let directed = self.select_direction(navigation);
        self.compute_for_mode(&directed, self.select_mode(&directed, state))
    }

    /// Expresses the goal for forward travel, the only direction.
    #[inline(always)]
    pub fn select_direction(&self, navigation: &NavigationVariables<S>) -> DirectedError<S> {
        DirectedError::from_navigation(navigation, S::Mask::splat(false))
    }

    /// Selects the active law.
    #[inline(always)]
    pub fn select_mode(&self, directed: &DirectedError<S>, state: HybridState<S>) -> ActiveMode<S> {
        let (goal, heading_error) = (&directed.goal, directed.heading_error.radians());
        let local_mode = goal.rho.lt(self.capture_radius).and(heading_error.abs().lt(self.capture_heading));
        let error = S::select(local_mode, -heading_error, goal.alpha.radians());
        ActiveMode { error, state: HybridState { local_mode, trim_ticks: S::from_f64(0.0), ..state } }
    }

    /// Computes the twist of the active law.
    #[inline(always)]
    pub fn compute_for_mode(&self, directed: &DirectedError<S>, mode: ActiveMode<S>) -> ControlOutput<S> {
        let (DirectedError { goal, cos, sinc, .. }, ActiveMode { error, state }) = (*directed, mode);
        let local = self.local().twist_toward(goal.rho * cos, -error);
        let global = self.global().twist_driven(goal.rho, error, goal.phi.radians(), cos, sinc);
        ControlOutput { twist: Twist::select(state.local_mode, local, global), state }
    }
}
