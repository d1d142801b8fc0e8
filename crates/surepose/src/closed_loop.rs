//! The closed loop: what the robot senses, where it is, what it wants, how its wheels turn.
//!
//! [`tick`] is all of it, and a pure function of its arguments: no clock, no allocation, no failure, bounded work. It
//! has two halves, [`Localiser::sense`] and [`Controller::step`]; what has no goal of its own, a replayed log or a
//! robot on a path, runs the first half alone. A [`Witness`] stands beside: the supervisor, for one.

mod follower;
mod localiser;
mod witness;

pub use follower::{Followed, Follower};
pub use localiser::Localiser;
pub use witness::{Sight, Witness};

use crate::drive::{Drive, FASTEST, Twist, Wheels};
use crate::estimate::{Belief, Measurement, Stamp, Stamped, Travel};
use crate::frame::{Body, Goal, Map};
use crate::laser::{Scan, Wall};
use crate::law::{Arrival, Braking, Direction, HybridLaw, Law, Memory, Phase, Tolerance};
use crate::limit::Limits;
use crate::navigation::Navigation;
use crate::pose::Pose;
use crate::scalar::{Float, Mask, Scalar};

/// One robot's controller: constants only, no hidden state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Controller<S> {
    /// The wheels' geometry.
    pub drive: Drive<S>,
    /// The control law.
    pub law: Law<S>,
    /// How the robot slows down in time; by the law's gains alone if that is all the wheels need.
    pub braking: Option<Braking<S>>,
    /// What the wheels can do.
    pub limits: Limits<S>,
    /// What counts as being there.
    pub tolerance: Tolerance<S>,
    /// Time between ticks \[s].
    pub period: S,
}

/// What the controller carries from tick to tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress<S: Scalar> {
    /// What the law remembers.
    pub memory: Memory<S>,
    /// How far arriving has come.
    pub arrival: Arrival<S>,
    /// The twist granted last.
    pub granted: Twist<S>,
}

impl<S: Scalar> Progress<S> {
    /// At rest, nothing decided.
    pub fn fresh() -> Self {
        Self { memory: Memory::fresh(), arrival: Arrival::fresh(), granted: Twist::rest() }
    }
}

/// What one control step decided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step<S: Scalar> {
    /// The goal as seen.
    pub navigation: Navigation<S>,
    /// What the law asks for.
    pub wanted: Twist<S>,
    /// What the limits grant.
    pub granted: Twist<S>,
    /// The turn rates of the wheels \[rad/s].
    pub wheels: Wheels<S>,
    /// To pass to the next step.
    pub progress: Progress<S>,
}

impl<S: Scalar> Controller<S> {
    /// The default law for a robot, a period \[s] and an end that goes first.
    pub fn fitted(
        drive: Drive<S>,
        limits: Limits<S>,
        period: S,
        direction: Direction,
        tolerance: Tolerance<S>,
    ) -> Self {
        let law = HybridLaw::fitted(&drive, &limits, period, direction);
        let braking = Some(Braking::of(&drive, &limits));
        Self { drive, law: Law::Hybrid(law), braking, limits, tolerance, period }
    }

    /// From where the robot is to how its wheels turn, for one period.
    #[inline]
    pub fn step(
        &self,
        progress: Progress<S>,
        map_from_body: Pose<Map, Body, S>,
        map_from_goal: Pose<Map, Goal, S>,
    ) -> Step<S> {
        // Where is the goal, seen from here? The wheels rest once it is reached, and until a push takes it away.
        let navigation = Navigation::of(map_from_body, map_from_goal);
        let arrival = progress.arrival.after(&navigation, &self.tolerance, self.period);

        // How should I move? The law asks, and slows down in time; the limits grant what the wheels can reach.
        let decision = self.law.decide_in_time(self.braking.as_ref(), &navigation, progress.memory);
        let wanted = Twist::select(arrival.reached(&self.tolerance), Twist::rest(), decision.twist);
        let granted = self.limits.grant(&self.drive, wanted, progress.granted, self.period);

        // How do the wheels turn?
        let (granted, wheels, _) = possible(&self.drive, granted);
        let progress = Progress { memory: decision.memory, arrival, granted };
        Step { navigation, wanted, granted, wheels, progress }
    }
}

/// A twist with the turn rates of its wheels \[rad/s], and where they are possible: elsewhere, with constants that no robot has
/// or a pose that is none, the wheels rest.
#[inline(always)]
fn possible<S: Scalar>(drive: &Drive<S>, twist: Twist<S>) -> (Twist<S>, Wheels<S>, S::Mask) {
    let wheels = drive.rates_from_twist(twist);
    let turns = |rate: S| rate.abs().lt(S::of(FASTEST));
    let possible = turns(wheels.right).and(turns(wheels.left));
    let twist = Twist::select(possible, twist, Twist::rest());
    (twist, Wheels::select(possible, wheels, Wheels::rest()), possible)
}

/// What the robot sensed since the last tick.
#[derive(Clone, Copy, Debug)]
pub struct Sensed<'a, S> {
    /// Now.
    pub stamp: Stamp,
    /// How far the rims rolled since the last tick, and how well that is known.
    pub travel: Travel<S>,
    /// What arrived since the last tick, in any order, each with the time it was measured.
    pub signals: &'a [Stamped<Signal<'a, S>>],
}

/// What a sensor has to say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Signal<'a, S> {
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
    pub step: Step<S>,
    /// Whether the goal is reached.
    pub phase: Phase,
}

/// Carries the estimate one tick forward and says how to turn the wheels.
///
/// What is refused, a scan that cannot be read too, is counted in the estimator's tally and changes nothing. `progress` is
/// what the tick before gave, its `granted` what the wheels were really told: less, where the supervisor said so.
pub fn tick<S: Float, const N: usize, const BEAMS: usize>(
    controller: &Controller<S>,
    localiser: &mut Localiser<S, N, BEAMS>,
    walls: &[Wall<S>],
    progress: Progress<S>,
    sensed: &Sensed<'_, S>,
    map_from_goal: Pose<Map, Goal, S>,
    witness: &mut impl Witness<S, N>,
) -> Tick<S> {
    // Where am I? Odometry predicts; each measurement and each wall seen, gated, corrects.
    let elapsed = S::of(sensed.stamp.since(localiser.estimator.stamp()).max(0.0));
    let told = Travel::guessed(controller.drive.rims_from_twist(progress.granted).scaled(elapsed));
    let belief = localiser.sense(sensed, told, walls, witness);

    // How do I turn my wheels towards the goal?
    let step = controller.step(progress, belief.pose, map_from_goal);
    let phase = step.progress.arrival.phase(&controller.tolerance);
    Tick { belief, step, phase }
}
