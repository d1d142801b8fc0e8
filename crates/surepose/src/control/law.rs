//! The control law in use, and the three steps by which it computes a twist.

use crate::kinematics::Twist;
use crate::scalar::Scalar;

use super::active_mode::ActiveMode;
use super::braking::BrakingProfile;
use super::deadband::Deadband;
use super::directed_error::DirectedError;
use super::gains::Gains;
use super::global::GlobalLaw;
use super::hybrid::HybridLaw;
use super::hysteresis::HybridState;
use super::local::LocalLaw;
use super::navigation_variables::NavigationVariables;
use super::tran2012::Tran2012Law;

/// What a law wants, and what it remembers for the next tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControlOutput<S: Scalar> {
    /// The wanted twist, before limits.
    pub twist: Twist<S>,
    /// What to pass to the next tick.
    pub state: HybridState<S>,
}

/// The law in use, by name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law<S> {
    /// `surepose`: both laws of the paper with smooth hand-over, hysteresis and a bounded speed.
    Hybrid(HybridLaw<S>),
    /// `paper`: both laws on the paper's sets, without memory.
    Tran2012(Tran2012Law<S>),
}

impl<S: Scalar> Law<S> {
    /// The twist for the goal as seen now, and the state for the next tick.
    ///
    /// Finite for every input: a goal whose place is not a number, or that asks for 10³⁰ m/s, is answered with rest.
    #[inline(always)]
    pub fn compute(&self, navigation: &NavigationVariables<S>, state: HybridState<S>) -> ControlOutput<S> {
        self.compute_with_braking(None, navigation, state)
    }

    /// The same for wheels that need time to slow down, if they do.
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

    /// The first step of [`Law::compute`]: which end goes first, and what it sees.
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

    /// The second step: which law is in charge.
    #[inline(always)]
    pub fn select_mode(&self, directed: &DirectedError<S>, state: HybridState<S>) -> ActiveMode<S> {
        match self {
            Self::Hybrid(law) => law.select_mode(directed, state),
            Self::Tran2012(law) => law.select_mode(directed, state),
        }
    }

    /// The third: its twist, slowed down in time where the law knows how.
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
        // One sum for two comparisons: small where both are, and not a number where one of them is not. A goal that is nowhere
        // makes v so.
        let is_finite = (twist.v.abs() + twist.omega.abs()).lt(S::from_f64(1e30));
        ControlOutput { twist: Twist::select(is_finite, twist, Twist::zero()), state }
    }

    /// The gains of both its laws.
    pub fn gains(&self) -> Gains<S> {
        match self {
            Self::Hybrid(law) => law.gains,
            Self::Tran2012(law) => law.gains,
        }
    }

    /// The Lyapunov function of the law in charge, for the end of the robot that goes first: V_l of [Tran2012]
    /// Eq. (26) near the goal, V_g of Eq. (19) elsewhere.
    ///
    /// The two are different functions: at the switch the value jumps.
    pub fn lyapunov(&self, navigation: &NavigationVariables<S>, state: &HybridState<S>) -> S {
        let Gains { k_v, k_alpha, h, k_theta } = self.gains();
        let ahead = NavigationVariables::select(state.reverse, navigation.reversed(), *navigation);
        let local_mode = LocalLaw { k_v, k_theta }.lyapunov(&ahead);
        let far = GlobalLaw { k_v, k_alpha, h }.lyapunov(&ahead);
        S::select(state.local_mode, local_mode, far)
    }
}

impl Law<f64> {
    /// The same constants, rounded to another format.
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
