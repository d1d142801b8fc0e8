//! How should I move? The control laws of [Tran2012] Sec. 4, each with its Lyapunov function beside it.

mod arrival;
mod braking;
mod commitment;
mod engaged;
mod facing;
mod follow;
mod gains;
mod global;
mod hybrid;
mod local;
mod paper;
mod rest;

use crate::navigation::Navigation;
use crate::scalar::Scalar;

pub use arrival::{Arrival, Phase, Tolerance};
pub use braking::Braking;
pub use commitment::{Direction, Memory};
pub use engaged::Engaged;
pub use facing::Facing;
pub use follow::{FollowLaw, Following, Offset};
pub use gains::{Actuation, Gains};
pub use global::GlobalLaw;
pub use hybrid::HybridLaw;
pub use local::LocalLaw;
pub use paper::PaperLaw;
pub use rest::Rest;

use crate::drive::Twist;

/// What a law wants, and what it remembers for the next tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decision<S: Scalar> {
    /// The wanted twist, before limits.
    pub twist: Twist<S>,
    /// What to pass to the next tick.
    pub memory: Memory<S>,
}

/// The law in use, by name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law<S> {
    /// `surepose`: both laws of the paper with smooth hand-over, hysteresis and a bounded speed.
    Hybrid(HybridLaw<S>),
    /// `paper`: both laws on the paper's sets, without memory.
    Paper(PaperLaw<S>),
}

impl<S: Scalar> Law<S> {
    /// The twist for the goal as seen now, and the memory for the next tick.
    ///
    /// Finite for every input: a goal whose place is not a number, or that asks for 10³⁰ m/s, is answered with rest.
    #[inline(always)]
    pub fn decide(&self, navigation: &Navigation<S>, memory: Memory<S>) -> Decision<S> {
        self.decide_in_time(None, navigation, memory)
    }

    /// The same for wheels that need time to slow down, if they do.
    #[inline(always)]
    pub fn decide_in_time(
        &self,
        braking: Option<&Braking<S>>,
        navigation: &Navigation<S>,
        memory: Memory<S>,
    ) -> Decision<S> {
        let facing = self.face(navigation, &memory);
        let engaged = self.engage(&facing, memory);
        self.steer(braking, &facing, engaged)
    }

    /// The first step of [`Law::decide`]: which end goes first, and what it sees.
    #[inline(always)]
    pub fn face(&self, navigation: &Navigation<S>, memory: &Memory<S>) -> Facing<S> {
        match self {
            Self::Hybrid(law) => law.face(navigation, memory),
            Self::Paper(law) => law.face(navigation),
        }
    }

    /// The second step: which law is in charge.
    #[inline(always)]
    pub fn engage(&self, facing: &Facing<S>, memory: Memory<S>) -> Engaged<S> {
        match self {
            Self::Hybrid(law) => law.engage(facing, memory),
            Self::Paper(law) => law.engage(facing, memory),
        }
    }

    /// The third: its twist, slowed down in time where the law knows how.
    #[inline(always)]
    pub fn steer(
        &self,
        braking: Option<&Braking<S>>,
        facing: &Facing<S>,
        engaged: Engaged<S>,
    ) -> Decision<S> {
        let Decision { twist, memory } = match (self, braking) {
            (Self::Hybrid(law), Some(braking)) => law.steer_in_time(braking, facing, engaged),
            (Self::Hybrid(law), None) => law.steer(facing, engaged),
            (Self::Paper(law), _) => law.steer(facing, engaged),
        };
        // One sum for two comparisons: small where both are, and not a number where one of them is not. A goal that is nowhere
        // makes v so.
        let seen = (twist.v.abs() + twist.omega.abs()).lt(S::of(1e30));
        Decision { twist: Twist::select(seen, twist, Twist::rest()), memory }
    }

    /// The gains of both its laws.
    pub fn gains(&self) -> Gains<S> {
        match self {
            Self::Hybrid(law) => law.gains,
            Self::Paper(law) => law.gains,
        }
    }

    /// The Lyapunov function of the law in charge, for the end of the robot that goes first: V_l of [Tran2012]
    /// Eq. (26) near the goal, V_g of Eq. (19) elsewhere.
    ///
    /// The two are different functions: at the switch the value jumps.
    pub fn lyapunov(&self, navigation: &Navigation<S>, memory: &Memory<S>) -> S {
        let Gains { k_v, k_alpha, h, k_theta } = self.gains();
        let ahead = Navigation::select(memory.reverse, navigation.reversed(), *navigation);
        let near = LocalLaw { k_v, k_theta }.lyapunov(&ahead);
        let far = GlobalLaw { k_v, k_alpha, h }.lyapunov(&ahead);
        S::select(memory.near, near, far)
    }
}

impl Law<f64> {
    /// The same constants, rounded to another format.
    #[inline(always)]
    pub fn cast<T: Scalar>(&self) -> Law<T> {
        match self {
            Self::Hybrid(law) => Law::Hybrid(HybridLaw {
                gains: law.gains.cast(),
                capture_radius: T::of(law.capture_radius),
                direction: law.direction,
                actuation: law.actuation.cast(),
                rest: law.rest.map(Rest::cast),
            }),
            Self::Paper(law) => Law::Paper(PaperLaw {
                gains: law.gains.cast(),
                capture_radius: T::of(law.capture_radius),
                capture_heading: T::of(law.capture_heading),
            }),
        }
    }
}
