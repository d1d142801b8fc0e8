//! The paper's hybrid law as the paper has it, signs mended: for comparison and for its figures.

use crate::drive::Twist;
use crate::navigation::Navigation;
use crate::scalar::{Mask, Scalar};

use super::Decision;
use super::commitment::Memory;
use super::engaged::Engaged;
use super::facing::Facing;
use super::gains::Gains;
use super::global::GlobalLaw;
use super::local::LocalLaw;

/// [Tran2012] Sec. 4: the local law on Ω_l = {ρ < ε_P, |φ − α| < ε_θ}, the global law elsewhere. It remembers nothing.
///
/// # Departure
/// (28) with its sign mended, see [`LocalLaw`]. The paper gives no ε_θ: one below π leaves the robot to the global
/// law on top of the goal, where α is noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaperLaw<S> {
    /// The gains.
    pub gains: Gains<S>,
    /// ε_P \[m].
    pub capture_radius: S,
    /// ε_θ \[rad].
    pub capture_heading: S,
}

impl<S: Scalar> PaperLaw<S> {
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

    /// The twist for the goal as seen now. Of the memory only `near` is set, for those who plot the switch.
    #[inline(always)]
    pub fn decide(&self, navigation: &Navigation<S>, memory: Memory<S>) -> Decision<S> {
        let facing = self.face(navigation);
        self.steer(&facing, self.engage(&facing, memory))
    }

    /// What the nose sees: it always goes first.
    #[inline(always)]
    pub fn face(&self, navigation: &Navigation<S>) -> Facing<S> {
        Facing::of(navigation, S::Mask::splat(false))
    }

    /// Which law is in charge.
    #[inline(always)]
    pub fn engage(&self, facing: &Facing<S>, memory: Memory<S>) -> Engaged<S> {
        let (goal, heading_error) = (&facing.goal, facing.heading_error.radians());
        let near = goal.rho.lt(self.capture_radius).and(heading_error.abs().lt(self.capture_heading));
        let error = S::select(near, -heading_error, goal.alpha.radians());
        Engaged { error, memory: Memory { near, ..memory } }
    }

    /// The twist for what the nose sees.
    #[inline(always)]
    pub fn steer(&self, facing: &Facing<S>, engaged: Engaged<S>) -> Decision<S> {
        let (Facing { goal, cos, sinc, .. }, Engaged { error, memory }) = (*facing, engaged);
        let local = self.local().twist_toward(goal.rho * cos, -error);
        let global = self.global().twist_driven(goal.rho, error, goal.phi.radians(), cos, sinc);
        Decision { twist: Twist::select(memory.near, local, global), memory }
    }
}
