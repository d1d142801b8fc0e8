//! The goal as the end of the robot sees it that goes first: what a law steers by.

use crate::geometry::Angle;
use crate::scalar::Scalar;

use super::navigation_variables::NavigationVariables;

/// The goal, with the robot turned round in thought where its tail goes first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectedError<S: Scalar> {
    /// The goal ahead of the end that goes first.
    pub goal: NavigationVariables<S>,
    /// cos α of that goal.
    pub cos: S,
    /// sin α/α.
    pub sinc: S,
    /// θ_e, how far the robot is turned from the commanded heading: the same for both ends.
    pub heading_error: Angle<S>,
    /// The tail goes first.
    pub reverse: S::Mask,
}

impl<S: Scalar> DirectedError<S> {
    /// The goal of `navigation`, tail first where `reverse`.
    #[inline(always)]
    pub fn from_navigation(navigation: &NavigationVariables<S>, reverse: S::Mask) -> Self {
        let goal = NavigationVariables::select(reverse, navigation.reversed(), *navigation);
        let (cos, sinc) = goal.alpha.radians().cos_sinc_bounded();
        Self { goal, cos, sinc, heading_error: navigation.heading_error(), reverse }
    }
}
