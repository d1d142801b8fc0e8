//! The paper's hybrid law as the paper has it, signs mended: for comparison and for its figures.

use crate::kinematics::Twist;
use crate::scalar::{Mask, Scalar};

use super::directed_error::DirectedError;
use super::gains::Gains;
use super::global::GlobalLaw;
use super::hysteresis::HybridState;
use super::local::LocalLaw;
use super::navigation_variables::NavigationVariables;
use super::output::{ActiveMode, ControlOutput};

/// [Tran2012] Sec. 4: the local law on Ω_l = {ρ < ε_P, |φ − α| < ε_θ}, the global law elsewhere. It remembers nothing.
///
/// # Departure
/// (28) with its sign mended, see [`LocalLaw`]. The paper gives no ε_θ: one below π leaves the robot to the global
/// law on top of the goal, where α is noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tran2012Law<S> {
    /// The gains.
    pub gains: Gains<S>,
    /// ε_P \[m].
    pub capture_radius: S,
    /// ε_θ \[rad].
    pub capture_heading: S,
}

impl<S: Scalar> Tran2012Law<S> {
    /// The global law of these gains.
    #[inline(always)]
    pub fn global(&self) -> GlobalLaw<S> {
        GlobalLaw { k_v: self.gains.k_v, k_alpha: self.gains.k_alpha, h: self.gains.h }
    }

    /// The local law of these gains.
    #[inline(always)]
    pub fn local(&self) -> LocalLaw<S> {
        LocalLaw { k_v: self.gains.k_v, k_theta: self.gains.k_theta }
    }

    /// The twist for the goal as seen now. Of the state only `local_mode` is set, for those who plot the switch.
    #[inline(always)]
    pub fn compute(&self, navigation: &NavigationVariables<S>, state: HybridState<S>) -> ControlOutput<S> {
        let directed = self.select_direction(navigation);
        self.compute_for_mode(&directed, self.select_mode(&directed, state))
    }

    /// What the nose sees: it always goes first.
    #[inline(always)]
    pub fn select_direction(&self, navigation: &NavigationVariables<S>) -> DirectedError<S> {
        DirectedError::from_navigation(navigation, S::Mask::splat(false))
    }

    /// Which law is in charge.
    #[inline(always)]
    pub fn select_mode(&self, directed: &DirectedError<S>, state: HybridState<S>) -> ActiveMode<S> {
        let (goal, heading_error) = (&directed.goal, directed.heading_error.radians());
        let local_mode = goal.rho.lt(self.capture_radius).and(heading_error.abs().lt(self.capture_heading));
        let error = S::select(local_mode, -heading_error, goal.alpha.radians());
        ActiveMode { error, state: HybridState { local_mode, ..state } }
    }

    /// The twist for what the nose sees.
    #[inline(always)]
    pub fn compute_for_mode(&self, directed: &DirectedError<S>, mode: ActiveMode<S>) -> ControlOutput<S> {
        let (DirectedError { goal, cos, sinc, .. }, ActiveMode { error, state }) = (*directed, mode);
        let local = self.local().twist_toward(goal.rho * cos, -error);
        let global = self.global().twist_driven(goal.rho, error, goal.phi.radians(), cos, sinc);
        ControlOutput { twist: Twist::select(state.local_mode, local, global), state }
    }
}
