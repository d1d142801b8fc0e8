//! Navigation error for the selected direction of travel.

use crate::geometry::Angle;
use crate::scalar::Scalar;

use super::navigation_variables::NavigationVariables;

/// Goal relative to the leading end; in reverse, front and rear are exchanged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectedError<S: Scalar> {
    /// Goal relative to the leading end.
    pub goal: NavigationVariables<S>,
    /// cos α of `goal`.
    pub cos: S,
    /// sin α/α.
    pub sinc: S,
    /// Heading error θ_e; equal for both directions of travel.
    pub heading_error: Angle<S>,
    /// Whether the robot drives in reverse.
    pub reverse: S::Mask,
}

impl<S: Scalar> DirectedError<S> {
    /// Expresses `navigation` for the leading end, which is the rear where `reverse` is true.
    #[inline(always)]
    pub fn from_navigation(navigation: &NavigationVariables<S>, reverse: S::Mask) -> Self {
        let goal = NavigationVariables::select(reverse, navigation.reversed(), *navigation);
        let (cos, sinc) = goal.alpha.radians().cos_sinc_bounded();
        Self { goal, cos, sinc, heading_error: navigation.heading_error(), reverse }
    }

    /// ρ sin α: lateral distance of the goal \[m], positive on the left of the leading end.
    #[inline(always)]
    pub(super) fn aside(&self) -> S {
        self.goal.rho * (self.goal.alpha.radians() * self.sinc)
    }
}
