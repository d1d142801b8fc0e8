//! The hybrid law: global far away, local at the goal, handed over smoothly, with a state that noise does not change.

use crate::kinematics::{DiffDrive, Twist};
use crate::scalar::Scalar;

use super::active_mode::ActiveMode;
use super::braking::BrakingProfile;
use super::deadband::Deadband;
use super::directed_error::DirectedError;
use super::gains::{ActuatorLimits, Gains};
use super::global::GlobalLaw;
use super::hysteresis::{self, Direction, HybridState};
use super::law::ControlOutput;
use super::limits::Limits;
use super::local::LocalLaw;
use super::navigation_variables::NavigationVariables;

/// The hybrid law of [Tran2012] Sec. 4, for wheels with limits, a sampled loop and a noisy estimate.
///
/// With `ε` the capture radius, `V` the largest speed and `a₊ = min(1, a)`, the distance from the goal decides:
///
/// | where | law |
/// |---|---|
/// | ρ > ε | (23) with k_v → min(k_v, V/ρ), k_α → k_α(α), h → h·(ρ/2.7ε)²₊, and v = 0 where cos α < 0 |
/// | ρ < ε | the same, its ω faded by (ρ/ε)²: the robot finishes the line it is on; where cos α < 0, v faded in by 1 − (ρ/ε)²: it backs up |
/// | ρ < 0.23ε | (28) with k_θ → k_θ/n at the n-th tick of trimming; it turns as far as it has arrived: ω·max(0.1, 1 − (ρ cos α/0.35ε)²), and wholly where the heading is within 0.02 rad |
///
/// (28) keeps the robot until ρ > 0.85ε; as it trims the heading, ρ² need only exceed what falls evenly to (0.58ε)² in 20
/// ticks. With the direction of approach reversed, α, φ and v are those of a robot whose tail is its nose.
///
/// # Guarantee
/// Without noise and in continuous time W = c·ln ρ + ½(α² + h_w·φ²) falls for ρ > ε with c = 2 and h_w = 0.1, at the fitted
/// gains, and V_l of (26) does not grow where the local law is in charge. Between the two, while steering fades,
/// nothing is proved. Tested by `hybrid::global_law_descends`, `hybrid::local_law_descends`. What holds sampled
/// and with noise is the certificate's to say.
///
/// # Departure
/// - k_v → min(k_v, V/ρ) bounds v by V. It is a positive factor on the part of the twist that k_v scales, and V̇_g
///   keeps its form with the smaller k_v. So the turn has the wheels first, and the path is nearly straight, as the
///   time-optimal ones are.
/// - No driving away: where cos α < 0, (23) drives backwards and turns. Here the robot turns on the spot first, so that
///   it does not reverse its travel: forward is forward.
/// - k_α shrinks with its error, and k_θ/n, down to a floor, is the gain of a recursive mean: noise of the estimate is
///   averaged, and large errors are still taken away at once. V̇ ≤ 0 holds for every positive gain.
/// - With a deadband, the robot rests rather than follow noise to and fro: see [`Deadband`].
/// - Where the wheels need time to slow down, gains shrink with the way that is left: see [`BrakingProfile`].
/// - h grows with ρ: Ẇ with h(ρ) has the further term −½h′(ρ)·v·cos α·φ² ≤ 0.
/// - The paper's Ω_l has no memory and lets the global law spin on noise at ρ < ε_P with a large heading error.
/// - The turning side and the direction of approach have hysteresis: see [`HybridState`].
#[derive(Clone, Copy, Debug, PartialEq)]
///
/// ```
/// use surepose::control::{Direction, HybridLaw, HybridState, Limits, NavigationVariables};
/// use surepose::geometry::{Angle, Pose};
/// use surepose::kinematics::DiffDrive;
///
/// let limits = Limits { wheel_speed: 0.5, wheel_acceleration: 1.0 };
/// let law = HybridLaw::fitted(&DiffDrive::new(0.05, 0.4), &limits, 0.02, Direction::Forward);
/// let goal = Pose::new(1.0, 0.2, Angle::<f64>::zero());
/// let navigation = NavigationVariables::from_poses(Pose::identity(), goal);
/// let output = law.compute(&navigation, HybridState::new());
/// assert!(output.twist.v > 0.0 && output.twist.omega > 0.0); // ahead, and to the left
/// ```
pub struct HybridLaw<S> {
    /// The gains.
    pub gains: Gains<S>,
    /// ε_P, within which steering fades and the local law takes over \[m].
    pub capture_radius: S,
    /// Which end goes first.
    pub direction: Direction,
    /// What the robot can do.
    pub actuator_limits: ActuatorLimits<S>,
    /// Where it rests rather than follow noise; `None` disables the deadband.
    pub deadband: Option<Deadband<S>>,
}

/// The default of ε_P \[m]: beyond it the noise of a laser localisation moves α by little.
const CAPTURE_RADIUS: f64 = 0.033;

// Radii in capture radii. They were tuned on the bench trial, and the certificate judges them.
const ENTER: f64 = 0.23;
/// Beyond this the local law hands back, whatever it does; the squares of the radii fall evenly from this to the next in
/// so many ticks of trimming. So noise that makes it take over too early cannot make it hand back at once, and a robot
/// that noise has turned beside the goal is still called back to it.
const MAX_LEAVE: f64 = 0.85;
const LEAVE: f64 = 0.58;
const TRIM_TICKS_TO_LEAVE: f64 = 20.0;
const ARRIVED: f64 = 0.35;
/// What is left of the turn before the robot has arrived: noise that hides the arrival does not keep it from turning.
const MIN_TURN_FACTOR: f64 = 0.1;
const APPROACH: f64 = 2.7;
/// Bearing beyond which k_α is whole \[rad].
const FULL_GAIN_ALPHA: f64 = 0.08;
/// Heading error within which the local law trims; beyond it k_θ is whole \[rad].
const FULL_GAIN_THETA: f64 = 0.045;
/// Heading error within which the local law turns wherever it is \[rad]; beyond twice that, only where it has arrived.
const TRIM: f64 = 0.02;

impl<S: Scalar> HybridLaw<S> {
    /// The law that fits a robot and a period \[s], with the capture radius of the default configuration.
    pub fn fitted(drive: &DiffDrive<S>, limits: &Limits<S>, period: S, direction: Direction) -> Self {
        Self {
            gains: Gains::for_loop(period, limits),
            capture_radius: S::from_f64(CAPTURE_RADIUS),
            direction,
            actuator_limits: ActuatorLimits::from_limits(drive, limits, period),
            deadband: None,
        }
    }

    /// The twist for the goal as seen now, and the state for the next tick.
    #[inline(always)]
    pub fn compute(&self, navigation: &NavigationVariables<S>, state: HybridState<S>) -> ControlOutput<S> {
        let directed = self.select_direction(navigation, &state);
        self.compute_for_mode(&directed, self.select_mode(&directed, state))
    }

    /// Which end goes first, and what it sees.
    #[inline(always)]
    pub fn select_direction(
        &self,
        navigation: &NavigationVariables<S>,
        state: &HybridState<S>,
    ) -> DirectedError<S> {
        DirectedError::from_navigation(
            navigation,
            hysteresis::select_reverse(self.direction, navigation, self.gains.h, state),
        )
    }

    /// Which law is in charge, and of what error.
    #[inline(always)]
    pub fn select_mode(&self, directed: &DirectedError<S>, state: HybridState<S>) -> ActiveMode<S> {
        let (ahead, reverse) = (&directed.goal, directed.reverse);
        let local_mode = self.radii_squared(ahead.rho).lt(handover(state.local_mode, state.trim_ticks));
        let error = S::select(local_mode, -directed.heading_error.radians(), ahead.alpha.radians());
        let (error, turn_direction) = hysteresis::unwrap_toward(error, state.turn_direction);
        let (zero, one) = (S::from_f64(0.0), S::from_f64(1.0));
        // Compared where the local law is in charge only: elsewhere it would be one more undecided comparison of intervals.
        let trimming = S::select(local_mode, error.abs(), one).lt(S::from_f64(FULL_GAIN_THETA));
        let trim_ticks = S::select(trimming, state.trim_ticks + one, zero);
        ActiveMode { error, state: HybridState { local_mode, reverse, turn_direction, trim_ticks, ..state } }
    }

    /// The twist that the end which goes first wants of this law.
    #[inline(always)]
    pub fn compute_for_mode(&self, directed: &DirectedError<S>, mode: ActiveMode<S>) -> ControlOutput<S> {
        let (ahead, reverse, ActiveMode { error, state }) = (&directed.goal, directed.reverse, mode);
        let goal = self.goal_in_body(directed);
        let Twist { v, omega } = Twist::select(
            state.local_mode,
            self.local_twist(&goal, -error, state.trim_ticks),
            self.global_twist(&goal, ahead, error),
        );
        let onward = |along: S| S::select(reverse, -along, along);
        let (v, drive_direction) = match self.deadband {
            Some(deadband) => deadband.capped(self.capture_radius).apply(
                onward(v),
                onward(goal.ahead),
                state.drive_direction,
            ),
            None => (onward(v), state.drive_direction),
        };
        ControlOutput { twist: Twist::new(v, omega), state: HybridState { drive_direction, ..state } }
    }

    /// The same for wheels that need time to slow down.
    ///
    /// Far away the drive waits where the turn needs time: both are slowed down alike, and the path stays the same. At the
    /// goal there is no drive left to slow down.
    #[inline(always)]
    pub fn compute_for_mode_with_braking(
        &self,
        braking: &BrakingProfile<S>,
        directed: &DirectedError<S>,
        mode: ActiveMode<S>,
    ) -> ControlOutput<S> {
        let (local_mode, one) = (mode.state.local_mode, S::from_f64(1.0));
        let Gains { k_v, k_alpha, h, k_theta } = self.gains;
        let turn = braking.angular_gain_factor(S::select(local_mode, k_theta, k_alpha), mode.error);
        let drive = S::select(local_mode, one, braking.linear_gain_factor(k_v, directed.goal.rho));
        let gains = Gains { k_v: k_v * drive, k_alpha, h, k_theta: k_theta * turn };
        let output = Self { gains, ..*self }.compute_for_mode(directed, mode);
        ControlOutput { twist: output.twist.scaled(S::select(local_mode, one, turn)), ..output }
    }

    /// ρ² in capture radii squared.
    #[inline(always)]
    fn radii_squared(&self, rho: S) -> S {
        (rho * (S::from_f64(1.0) / self.capture_radius)).squared()
    }

    #[inline(always)]
    fn goal_in_body(&self, directed: &DirectedError<S>) -> GoalInBody<S> {
        let DirectedError { goal, cos, sinc, .. } = *directed;
        let radii_squared = self.radii_squared(goal.rho);
        GoalInBody {
            cos,
            sinc,
            ahead: goal.rho * cos,
            radii_squared,
            per_radius: S::from_f64(1.0) / self.capture_radius,
        }
    }

    /// (23) scheduled, with `alpha` continued beyond ±π.
    #[inline(always)]
    fn global_twist(&self, goal: &GoalInBody<S>, ahead: &NavigationVariables<S>, alpha: S) -> Twist<S> {
        let global = GlobalLaw {
            // min(k_v, V/ρ), without a quotient that 0 would break.
            k_v: self.actuator_limits.speed / ahead.rho.max(self.actuator_limits.speed / self.gains.k_v),
            k_alpha: small_error_gain(
                alpha,
                FULL_GAIN_ALPHA,
                self.gains.k_alpha,
                self.actuator_limits.small_error_gain_alpha,
            ),
            h: (goal.radii_squared * (self.gains.h * S::from_f64(1.0 / (APPROACH * APPROACH))))
                .min(self.gains.h),
        };
        let fade = goal.radii_squared.min(S::from_f64(1.0));
        // Driving away, by as much as steering has faded: on the goal the robot backs up rather than turns round.
        let drive = goal.cos.max((S::from_f64(1.0) - fade) * goal.cos);
        let twist = global.twist_driven(ahead.rho, alpha, ahead.phi.radians(), drive, goal.sinc);
        Twist::new(twist.v, twist.omega * fade)
    }

    /// (28) scheduled, with the heading error continued beyond ±π.
    #[inline(always)]
    fn local_twist(&self, goal: &GoalInBody<S>, heading_error: S, trim_ticks: S) -> Twist<S> {
        // At the n-th tick of trimming n = `trim_ticks`; it is 0 where nothing is trimmed.
        let one = S::from_f64(1.0);
        let full = self.gains.k_theta;
        let local = LocalLaw {
            k_v: self.gains.k_v,
            k_theta: (full / trim_ticks.max(one)).max(self.actuator_limits.small_error_gain_theta.min(full)),
        };
        let twist = local.twist_toward(goal.ahead, heading_error);
        let limit = self.actuator_limits.turn_rate;
        let omega = twist.omega.clamp(-limit, limit);
        let arrived = one - (goal.ahead * (goal.per_radius * S::from_f64(1.0 / ARRIVED))).squared();
        let trimming = (S::from_f64(2.0) - heading_error.abs() * S::from_f64(1.0 / TRIM)).min(one);
        Twist::new(twist.v, omega * arrived.max(trimming).max(S::from_f64(MIN_TURN_FACTOR)))
    }
}

/// `full` at errors of `knee` \[rad] and above, at most `small` at small ones, a parabola between.
#[inline(always)]
fn small_error_gain<S: Scalar>(error: S, knee: f64, full: S, small: S) -> S {
    let small = small.min(full);
    (small + (full - small) * S::from_f64(1.0 / (knee * knee)) * error.squared()).min(full)
}

/// The goal in the robot's axes, and in capture radii.
struct GoalInBody<S> {
    cos: S,
    sinc: S,
    /// ρ·cos α \[m].
    ahead: S,
    /// ρ² in capture radii squared.
    radii_squared: S,
    /// 1/ε \[1/m].
    per_radius: S,
}

/// ρ² in capture radii squared below which the local law is in charge, having been or not, and having trimmed for so many
/// ticks.
#[inline(always)]
fn handover<S: Scalar>(was: S::Mask, trim_ticks: S) -> S {
    const LEAST: f64 = LEAVE * LEAVE;
    const PER_TRIM: f64 = (MAX_LEAVE * MAX_LEAVE - LEAST) / TRIM_TICKS_TO_LEAVE;
    let leave =
        (S::from_f64(MAX_LEAVE * MAX_LEAVE) - trim_ticks * S::from_f64(PER_TRIM)).max(S::from_f64(LEAST));
    S::select(was, leave, S::from_f64(ENTER * ENTER))
}
