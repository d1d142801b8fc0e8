//! Control law selection, and the three steps from the goal to a twist.

use crate::kinematics::Twist;
use crate::scalar::{Mask, Scalar};

use super::braking::BrakingProfile;
use super::deadband::Deadband;
use super::directed_error::DirectedError;
use super::gains::Gains;
use super::global::GlobalLaw;
use super::hybrid::HybridLaw;
use super::hysteresis::HybridState;
use super::local::LocalLaw;
use super::navigation_variables::NavigationVariables;
use super::output::{ActiveMode, ControlOutput};
use super::sidestep;
use super::tran2012::Tran2012Law;

/// Control law selected by the configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law<S> {
    /// `surepose`: both laws of the paper with a smooth transition, hysteresis and a bounded speed.
    Hybrid(HybridLaw<S>),
    /// `paper`: both laws on the paper's sets, without state.
    Tran2012(Tran2012Law<S>),
}

impl<S: Scalar> Law<S> {
    /// Computes the desired twist and the state for the next tick.
    ///
    /// The twist is finite for every input: it is zero where the goal is NaN or |v| + |ω| reaches 10³⁰.
    #[inline(always)]
    pub fn compute(&self, navigation: &NavigationVariables<S>, state: HybridState<S>) -> ControlOutput<S> {
        self.compute_with_braking(None, navigation, state)
    }

    /// Computes the twist as [`Law::compute`], with an optional braking profile; `None` disables it.
    #[inline(always)]
    pub fn compute_with_braking(
        &self,
        braking: Option<&BrakingProfile<S>>,
        navigation: &NavigationVariables<S>,
        state: HybridState<S>,
    ) -> ControlOutput<S> {
        let directed = self.select_direction(navigation, &state);
        let mode = self.select_mode(&directed, state);
        self.compute_for_mode(braking, &directed, mode)
    }

    /// Selects the direction of travel: the first step of [`Law::compute`].
    #[inline(always)]
    pub fn select_direction(
        &self,
        navigation: &NavigationVariables<S>,
        state: &HybridState<S>,
    ) -> DirectedError<S> {
        match self {
            Self::Hybrid(law) => law.select_direction(navigation, state),
            Self::Tran2012(law) => law.select_direction(navigation),
        }
    }

    /// Selects the active mode: the second step of [`Law::compute`].
    #[inline(always)]
    pub fn select_mode(&self, directed: &DirectedError<S>, state: HybridState<S>) -> ActiveMode<S> {
        match self {
            Self::Hybrid(law) => law.select_mode(directed, state),
            Self::Tran2012(law) => law.select_mode(directed, state),
        }
    }

    /// Computes the twist of the active mode: the third step of [`Law::compute`].
    ///
    /// The hybrid law applies `braking`; `None` disables it. The law of the paper ignores it.
    #[inline(always)]
    pub fn compute_for_mode(
        &self,
        braking: Option<&BrakingProfile<S>>,
        directed: &DirectedError<S>,
        mode: ActiveMode<S>,
    ) -> ControlOutput<S> {
        let ControlOutput { twist, state } = match (self, braking) {
            (Self::Hybrid(law), Some(braking)) => law.compute_for_mode_with_braking(braking, directed, mode),
            (Self::Hybrid(law), None) => law.compute_for_mode(directed, mode),
            (Self::Tran2012(law), _) => law.compute_for_mode(directed, mode),
        };
        // One comparison of the sum replaces two. The sum is NaN where a component is NaN, as with a NaN goal.
        let is_finite = (twist.v.abs() + twist.omega.abs()).lt(S::from_f64(1e30));
        ControlOutput { twist: Twist::select(is_finite, twist, Twist::zero()), state }
    }

    /// Returns the gains of the global and the local law.
    pub fn gains(&self) -> Gains<S> {
        match self {
            Self::Hybrid(law) => law.gains,
            Self::Tran2012(law) => law.gains,
        }
    }

    /// Evaluates the Lyapunov function of the active law for the current direction of travel.
    ///
    /// It is that of [`Law::lyapunov_by_mode`] except on the out leg of a sidestep, where it is ½y² + ½(θ_e − r)², with the lateral
    /// error y and the heading r of the leg.
    pub fn lyapunov(&self, navigation: &NavigationVariables<S>, state: &HybridState<S>) -> S {
        let ahead = NavigationVariables::select(state.reverse, navigation.reversed(), *navigation);
        let sidesteps = state.local_mode.and(S::from_f64(0.5).lt(sidestep::direction(state.sidestep).abs()));
        let lateral = ahead.rho * ahead.phi.sin_cos().0;
        let turn = ahead.heading_error().radians() - sidestep::heading(state.sidestep);
        let sidestep = (lateral.squared() + turn.squared()) * S::from_f64(0.5);
        S::select(sidesteps, sidestep, self.lyapunov_by_mode(navigation, state))
    }

    /// V_l of [Tran2012] Eq. (26) near the goal and V_g of Eq. (19) elsewhere, for the current direction of travel. The value jumps at the
    /// switch, and V_l may grow during a sidestep.
    pub fn lyapunov_by_mode(&self, navigation: &NavigationVariables<S>, state: &HybridState<S>) -> S {
        let Gains { k_v, k_alpha, h, k_theta } = self.gains();
        let ahead = NavigationVariables::select(state.reverse, navigation.reversed(), *navigation);
        let near = LocalLaw { k_v, k_theta }.lyapunov(&ahead);
        let far = GlobalLaw { k_v, k_alpha, h }.lyapunov(&ahead);
        S::select(state.local_mode, near, far)
    }
}

impl Law<f64> {
    /// Converts the constants to the scalar type `T`, rounded.
    #[inline(always)]
    pub fn cast<T: Scalar>(&self) -> Law<T> {
        match self {
            Self::Hybrid(law) => Law::Hybrid(HybridLaw {
                gains: law.gains.cast(),
                capture_radius: T::from_f64(law.capture_radius),
                direction: law.direction,
                actuator_limits: law.actuator_limits.cast(),
                deadband: law.deadband.map(Deadband::cast),
            }),
            Self::Tran2012(law) => Law::Tran2012(Tran2012Law {
                gains: law.gains.cast(),
                capture_radius: T::from_f64(law.capture_radius),
                capture_heading: T::from_f64(law.capture_heading),
            }),
        }
    }
}
