//! The controller: from the estimated pose to the wheels' turn rates, for one period.

use crate::geometry::{Body, Goal, Map, Pose};
use crate::kinematics::{DiffDrive, MAX_WHEEL_RATE, Twist, WheelPair};
use crate::scalar::{Mask, Scalar};

use super::braking::BrakingProfile;
use super::goal_checker::{GoalChecker, Tolerance};
use super::hybrid::HybridLaw;
use super::hysteresis::{Direction, HybridState};
use super::law::Law;
use super::limits::Limits;
use super::navigation_variables::NavigationVariables;

/// Controller of one robot: constants only; the state is passed in and out.
#[derive(Clone, Copy, Debug, PartialEq)]
///
/// ```
/// use surepose::control::{Controller, ControllerState, Direction, Limits, Tolerance};
/// use surepose::geometry::{Angle, Pose};
/// use surepose::kinematics::{DiffDrive, Integration};
///
/// let (drive, period) = (DiffDrive::new(0.05, 0.4), 0.02);
/// let limits = Limits::symmetric(0.5, 1.0);
/// let tolerance = Tolerance { position: 0.01, heading: 0.02, dwell: 0.5, hysteresis: 1.5 };
/// let controller = Controller::fitted(drive, limits, period, Direction::Auto, tolerance);
/// let (mut pose, mut state) = (Pose::<_, _, f64>::identity(), ControllerState::new());
/// let goal = Pose::new(1.0, 0.5, Angle::from_degrees(90.0));
/// for _ in 0..1000 {
///     let step = controller.step(state, pose, goal);
///     pose = pose.integrate(step.limited.integrate_for(period), Integration::Arc);
///     state = step.state;
/// }
/// assert!(pose.origin().distance(goal.origin()) < 0.01);
/// ```
pub struct Controller<S> {
    /// Geometry of the drive.
    pub drive: DiffDrive<S>,
    /// Control law.
    pub law: Law<S>,
    /// Braking profile; `None` leaves the deceleration to the gains.
    pub braking: Option<BrakingProfile<S>>,
    /// Limits of the wheels.
    pub limits: Limits<S>,
    /// Tolerance of the goal.
    pub tolerance: Tolerance<S>,
    /// Control period \[s].
    pub period: S,
}

/// State of the controller from one step to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControllerState<S: Scalar> {
    /// State of the control law.
    pub hybrid: HybridState<S>,
    /// State of the goal checker.
    pub goal_checker: GoalChecker<S>,
    /// Twist that was commanded in the last step, within the limits.
    pub limited: Twist<S>,
}

impl<S: Scalar> ControllerState<S> {
    /// Robot at rest, no decision taken.
    pub fn new() -> Self {
        Self { hybrid: HybridState::new(), goal_checker: GoalChecker::new(), limited: Twist::zero() }
    }
}

impl<S: Scalar> Default for ControllerState<S> {
    fn default() -> Self {
        Self::new()
    }
}

/// Decision of the control law, before limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControlDecision<S: Scalar> {
    /// Goal in navigation variables.
    pub navigation: NavigationVariables<S>,
    /// Desired twist; zero once the goal is reached.
    pub desired: Twist<S>,
    /// State of the control law for the next step.
    pub hybrid: HybridState<S>,
    /// State of the goal checker for the next step.
    pub goal_checker: GoalChecker<S>,
}

/// Result of one control step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControlStep<S: Scalar> {
    /// Goal in navigation variables.
    pub navigation: NavigationVariables<S>,
    /// Desired twist.
    pub desired: Twist<S>,
    /// Twist within the limits.
    pub limited: Twist<S>,
    /// The wheels' turn rates \[rad/s] for that twist.
    pub wheels: WheelPair<S>,
    /// State for the next step.
    pub state: ControllerState<S>,
}

impl<S: Scalar> Controller<S> {
    /// Controller with the default law, fitted to the robot and to the period \[s].
    pub fn fitted(
        drive: DiffDrive<S>,
        limits: Limits<S>,
        period: S,
        direction: Direction,
        tolerance: Tolerance<S>,
    ) -> Self {
        let law = HybridLaw::fitted(&drive, &limits, period, direction);
        let braking = Some(BrakingProfile::from_limits(&drive, &limits));
        Self { drive, law: Law::Hybrid(law), braking, limits, tolerance, period }
    }

    /// Computes and limits the twist of one period, without obstacles.
    #[inline]
    pub fn step(
        &self,
        state: ControllerState<S>,
        map_from_body: Pose<Map, Body, S>,
        map_from_goal: Pose<Map, Goal, S>,
    ) -> ControlStep<S> {
        let decision = self.decide(state, map_from_body, map_from_goal);
        let limited = self.limits.limit(&self.drive, decision.desired, state.limited, self.period);
        self.finish(decision, limited)
    }

    /// Computes the desired twist; zero once the goal is reached, until the robot leaves the tolerance.
    #[inline(always)]
    pub fn decide(
        &self,
        state: ControllerState<S>,
        map_from_body: Pose<Map, Body, S>,
        map_from_goal: Pose<Map, Goal, S>,
    ) -> ControlDecision<S> {
        let navigation = NavigationVariables::from_poses(map_from_body, map_from_goal);
        let goal_checker = state.goal_checker.update(&navigation, &self.tolerance, self.period);
        let output = self.law.compute_with_braking(self.braking.as_ref(), &navigation, state.hybrid);
        let desired = Twist::select(goal_checker.reached(&self.tolerance), Twist::zero(), output.twist);
        ControlDecision { navigation, desired, hybrid: output.state, goal_checker }
    }

    /// Completes the step from `decision` and its limited twist.
    #[inline(always)]
    pub fn finish(&self, decision: ControlDecision<S>, limited: Twist<S>) -> ControlStep<S> {
        let (limited, wheels, _) = zero_if_infeasible(&self.drive, limited);
        let ControlDecision { navigation, desired, hybrid, goal_checker } = decision;
        ControlStep {
            navigation,
            desired,
            limited,
            wheels,
            state: ControllerState { hybrid, goal_checker, limited },
        }
    }
}

/// A twist with the wheels' turn rates \[rad/s] and where these are feasible. Elsewhere, with invalid constants or a NaN
/// pose, twist and rates are zero.
#[inline(always)]
pub(crate) fn zero_if_infeasible<S: Scalar>(
    drive: &DiffDrive<S>,
    twist: Twist<S>,
) -> (Twist<S>, WheelPair<S>, S::Mask) {
    let wheels = drive.wheel_rates_from_twist(twist);
    let turns = |rate: S| rate.abs().lt(S::from_f64(MAX_WHEEL_RATE));
    let feasible = turns(wheels.right).and(turns(wheels.left));
    let twist = Twist::select(feasible, twist, Twist::zero());
    (twist, WheelPair::select(feasible, wheels, WheelPair::zero()), feasible)
}
