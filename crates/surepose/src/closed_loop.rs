//! The closed loop: what the robot senses, where it is, what it wants, how its wheels turn.
//!
//! [`tick`] is all of it, and a pure function of its arguments: no clock, no allocation, no failure, bounded work. It
//! has two halves, [`Localizer::update`] and [`Controller::step`]; what has no goal of its own, a replayed log or a
//! robot on a path, runs the first half alone. A [`LoopObserver`] stands beside: the supervisor, for one.

mod localizer;
mod observer;
mod path_controller;

pub use localizer::Localizer;
pub use observer::{LoopObserver, ScanEvent};
pub use path_controller::{PathController, PathProgress};

use crate::estimate::{Belief, Measurement, Stamp, Stamped, WheelOdometry};
use crate::frame::{Body, Goal, Map};
use crate::kinematics::{DiffDrive, MAX_WHEEL_RATE, Twist, WheelPair};
use crate::laser::{Scan, Wall};
use crate::law::{
    BrakingProfile, Direction, GoalChecker, GoalStatus, HybridLaw, HybridState, Law, Tolerance,
};
use crate::limit::Limits;
use crate::navigation::NavigationVariables;
use crate::pose::Pose;
use crate::scalar::{Float, Mask, Scalar};

/// One robot's controller: constants only, no hidden state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Controller<S> {
    /// The wheels' geometry.
    pub drive: DiffDrive<S>,
    /// The control law.
    pub law: Law<S>,
    /// How the robot slows down in time; by the law's gains alone if that is all the wheels need.
    pub braking: Option<BrakingProfile<S>>,
    /// What the wheels can do.
    pub limits: Limits<S>,
    /// What counts as being there.
    pub tolerance: Tolerance<S>,
    /// Time between ticks \[s].
    pub period: S,
}

/// What the controller carries from tick to tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControllerState<S: Scalar> {
    /// What the law remembers.
    pub hybrid: HybridState<S>,
    /// How far arriving has come.
    pub goal_checker: GoalChecker<S>,
    /// The limited twist of the last tick.
    pub limited: Twist<S>,
}

impl<S: Scalar> ControllerState<S> {
    /// At rest, nothing decided.
    pub fn new() -> Self {
        Self { hybrid: HybridState::new(), goal_checker: GoalChecker::new(), limited: Twist::zero() }
    }
}

/// What one control step decided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControlStep<S: Scalar> {
    /// The goal as seen.
    pub navigation: NavigationVariables<S>,
    /// What the law asks for.
    pub desired: Twist<S>,
    /// The twist within the limits.
    pub limited: Twist<S>,
    /// The turn rates of the wheels \[rad/s].
    pub wheels: WheelPair<S>,
    /// To pass to the next step.
    pub state: ControllerState<S>,
}

impl<S: Scalar> Controller<S> {
    /// The default law for a robot, a period \[s] and an end that goes first.
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

    /// From where the robot is to how its wheels turn, for one period.
    #[inline]
    pub fn step(
        &self,
        state: ControllerState<S>,
        map_from_body: Pose<Map, Body, S>,
        map_from_goal: Pose<Map, Goal, S>,
    ) -> ControlStep<S> {
        // Where is the goal, seen from here? The wheels rest once it is reached, and until a push takes it away.
        let navigation = NavigationVariables::from_poses(map_from_body, map_from_goal);
        let goal_checker = state.goal_checker.update(&navigation, &self.tolerance, self.period);

        // How should I move? The law asks, and slows down in time; the limits allow what the wheels can reach.
        let output = self.law.compute_with_braking(self.braking.as_ref(), &navigation, state.hybrid);
        let desired = Twist::select(goal_checker.reached(&self.tolerance), Twist::zero(), output.twist);
        let limited = self.limits.limit(&self.drive, desired, state.limited, self.period);

        // How do the wheels turn?
        let (limited, wheels, _) = zero_if_infeasible(&self.drive, limited);
        let state = ControllerState { hybrid: output.state, goal_checker, limited };
        ControlStep { navigation, desired, limited, wheels, state }
    }
}

/// A twist with the turn rates of its wheels \[rad/s], and where they are possible: elsewhere, with constants that no robot has
/// or a pose that is none, the wheels rest.
#[inline(always)]
fn zero_if_infeasible<S: Scalar>(drive: &DiffDrive<S>, twist: Twist<S>) -> (Twist<S>, WheelPair<S>, S::Mask) {
    let wheels = drive.wheel_rates_from_twist(twist);
    let turns = |rate: S| rate.abs().lt(S::from_f64(MAX_WHEEL_RATE));
    let feasible = turns(wheels.right).and(turns(wheels.left));
    let twist = Twist::select(feasible, twist, Twist::zero());
    (twist, WheelPair::select(feasible, wheels, WheelPair::zero()), feasible)
}

/// What the robot sensed since the last tick.
#[derive(Clone, Copy, Debug)]
pub struct SensorInput<'a, S> {
    /// Now.
    pub stamp: Stamp,
    /// How far the rims rolled since the last tick, and how well that is known.
    pub travel: WheelOdometry<S>,
    /// What arrived since the last tick, in any order, each with the time it was measured.
    pub readings: &'a [Stamped<SensorReading<'a, S>>],
}

/// What a sensor has to say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SensorReading<'a, S> {
    /// What the filter understands as it is: a heading, a landmark, a position.
    Measurement(Measurement<S>),
    /// A scan, whose walls are to be found on the map first.
    Scan(Scan<'a, S>),
}

/// One tick of the loop, seen from outside.
#[derive(Clone, Copy, Debug)]
pub struct Tick<S: Scalar> {
    /// Where the robot thinks it is.
    pub belief: Belief<S>,
    /// What the controller made of it.
    pub step: ControlStep<S>,
    /// Whether the goal is reached.
    pub status: GoalStatus,
}

/// Carries the estimate one tick forward and says how to turn the wheels.
///
/// What is refused, a scan that cannot be read too, is counted in the estimator's measurement statistics and changes nothing. `state` is
/// what the tick before gave, its `limited` what the wheels were really told: less, where the supervisor said so.
pub fn tick<S: Float, const N: usize, const BEAMS: usize>(
    controller: &Controller<S>,
    localizer: &mut Localizer<S, N, BEAMS>,
    walls: &[Wall<S>],
    state: ControllerState<S>,
    input: &SensorInput<'_, S>,
    map_from_goal: Pose<Map, Goal, S>,
    observer: &mut impl LoopObserver<S, N>,
) -> Tick<S> {
    // Where am I? Odometry predicts; each measurement and each wall seen, gated, corrects.
    let elapsed = S::from_f64(input.stamp.since(localizer.estimator.stamp()).max(0.0));
    let commanded =
        WheelOdometry::from_command(controller.drive.wheel_speeds_from_twist(state.limited).scaled(elapsed));
    let belief = localizer.update(input, commanded, walls, observer);

    // How do I turn my wheels towards the goal?
    let step = controller.step(state, belief.pose, map_from_goal);
    let status = step.state.goal_checker.status(&controller.tolerance);
    Tick { belief, step, status }
}
