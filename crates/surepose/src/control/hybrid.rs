//! Hybrid law: the global law far away, the local law at the goal, with hysteresis and a smooth transition.

use crate::kinematics::{DiffDrive, Twist};
use crate::param;
use crate::scalar::{Mask, Scalar};

use super::braking::BrakingProfile;
use super::deadband::Deadband;
use super::directed_error::DirectedError;
use super::gains::{ActuatorLimits, Gains};
use super::global::GlobalLaw;
use super::hysteresis::{self, Direction, HybridState};
use super::limits::Limits;
use super::local::LocalLaw;
use super::navigation_variables::NavigationVariables;
use super::output::{ActiveMode, ControlOutput};
use super::sidestep;
use super::tuning::{
    APPROACH_RADIUS, ARRIVED_RADIUS, ENTER_RADIUS, FULL_GAIN_ALPHA, FULL_GAIN_THETA, LEAVE_RADIUS,
    MIN_TURN_FACTOR, TRIM_THRESHOLD,
};

/// Hybrid law of [Tran2012] Sec. 4, for wheels with limits, a sampled loop and a noisy estimate.
///
/// ε is the capture radius, V the maximum speed and `a₊ = min(1, a)`. The distance to the goal ρ selects the law:
///
/// | where | law |
/// |---|---|
/// | ρ > ε | (23) with k_v → min(k_v, V/ρ), k_α → k_α(α), h → h·(ρ/2.7ε)²₊, and v = 0 where cos α < 0 |
/// | ρ < ε | (23) as above with ω·(ρ/ε)²: the path becomes straight; where cos α < 0, v is scaled by 1 − (ρ/ε)²: the robot backs up |
/// | ρ < 0.23ε | (28) with k_θ → k_θ/n at the n-th tick of trimming and ω·max(0.1, 1 − (ρ cos α/0.35ε)²); full ω where the heading error is below 0.02 rad |
///
/// The local law stays active until ρ > 0.85ε. A start below that distance begins with the local law. If a lateral error above
/// 0.25ε remains, the local law removes it by a sidestep: an S-shaped maneuver with the commanded heading rotated by 45°, and back. In
/// reverse, α, φ and v are those of a robot whose front and rear are exchanged.
///
/// # Guarantee
/// Without noise and in continuous time W = c·ln ρ + ½(α² + h_w·φ²) falls for ρ > ε with c = 2 and h_w = 0.1, at the fitted
/// gains. V_l of (26) does not grow while the local law is active, except in a sidestep, where |y| does not grow. In the transition between them nothing is proved.
/// Tested by `hybrid::global_law_descends`, `hybrid::local_law_descends`. The
/// certificate covers the sampled loop with noise.
///
/// # Departure
/// - k_v → min(k_v, V/ρ) bounds v by V. It is a positive factor on the part of the twist that k_v scales, and V̇_g
///   keeps its form with the smaller k_v. So the turn has priority, and the path is nearly straight, as the
///   time-optimal ones are.
/// - No driving away: where cos α < 0, (23) drives backwards and turns. Here the robot turns in place first, so that
///   the direction of travel stays as selected.
/// - k_α shrinks with its error, and k_θ/n, down to a floor, is the gain of a recursive mean. Estimate noise is
///   averaged, and large errors are still removed at once. V̇ ≤ 0 holds for every positive gain.
/// - With a deadband, the robot stands still instead of following noise: see [`Deadband`].
/// - With limited acceleration, gains shrink with the remaining distance: see [`BrakingProfile`].
/// - h grows with ρ: Ẇ with h(ρ) has the further term −½h′(ρ)·v·cos α·φ² ≤ 0.
/// - The paper's Ω_l has no hysteresis: at ρ < ε_P with a large heading error the global law rotates with the noise.
/// - A lateral error is an equilibrium of (28). A mean of 10 estimates detects it, and a sidestep removes it.
/// - The turning side and the direction of approach have hysteresis: see [`HybridState`].
#[derive(Clone, Copy, Debug, PartialEq)]
///
/// ```
/// use surepose::control::{Direction, HybridLaw, HybridState, Limits, NavigationVariables};
/// use surepose::geometry::{Angle, Pose};
/// use surepose::kinematics::DiffDrive;
///
/// let limits = Limits::symmetric(0.5, 1.0);
/// let law = HybridLaw::fitted(&DiffDrive::new(0.05, 0.4), &limits, 0.02, Direction::Forward);
/// let goal = Pose::new(1.0, 0.2, Angle::<f64>::zero());
/// let navigation = NavigationVariables::from_poses(Pose::identity(), goal);
/// let output = law.compute(&navigation, HybridState::new());
/// assert!(output.twist.v > 0.0 && output.twist.omega > 0.0); // ahead, and to the left
/// ```
pub struct HybridLaw<S> {
    /// Gains of both laws.
    pub gains: Gains<S>,
    /// Capture radius ε_P \[m], within which steering decreases and the local law takes over.
    pub capture_radius: S,
    /// Permitted direction of travel.
    pub direction: Direction,
    /// Actuator limits of the robot.
    pub actuator_limits: ActuatorLimits<S>,
    /// Deadband against noise; `None` disables it.
    pub deadband: Option<Deadband<S>>,
}

impl<S: Scalar> HybridLaw<S> {
    /// Derives the law for a robot and a control `period` \[s], with the default capture radius.
    pub fn fitted(drive: &DiffDrive<S>, limits: &Limits<S>, period: S, direction: Direction) -> Self {
        Self {
            gains: Gains::for_loop(period, limits),
            capture_radius: S::from_f64(param::CAPTURE_RADIUS.default_si()),
            direction,
            actuator_limits: ActuatorLimits::from_limits(drive, limits, period),
            deadband: None,
        }
    }

    /// Computes the desired twist and the state for the next tick.
    #[inline(always)]
    pub fn compute(&self, navigation: &NavigationVariables<S>, state: HybridState<S>) -> ControlOutput<S> {
        let directed = self.select_direction(navigation, &state);
        self.compute_for_mode(&directed, self.select_mode(&directed, state))
    }

    /// Selects the direction of travel, and expresses the goal for that direction.
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

    /// Selects the active law and its angle error.
    #[inline(always)]
    pub fn select_mode(&self, directed: &DirectedError<S>, state: HybridState<S>) -> ActiveMode<S> {
        let (ahead, reverse) = (&directed.goal, directed.reverse);
        let was_near = state.local_mode.or(state.is_undecided());
        let local_mode = self.radii_squared(ahead.rho).lt(handover(was_near));
        let sidestep = sidestep::select_leg(local_mode, &state, self.capture_radius);
        let local_error = sidestep::heading(sidestep) - directed.heading_error.radians();
        let error = S::select(local_mode, local_error, ahead.alpha.radians());
        let (error, turn_direction) = hysteresis::unwrap_toward(error, state.turn_direction);
        // Compared only in local mode: elsewhere it would add an undecided comparison of intervals.
        let trims = S::select(local_mode, error.abs(), S::from_f64(1.0)).lt(S::from_f64(FULL_GAIN_THETA));
        let (trim_ticks, lateral) = sidestep::observe(trims, directed.aside(), &state);
        ActiveMode {
            error,
            state: HybridState {
                local_mode,
                reverse,
                turn_direction,
                trim_ticks,
                sidestep,
                lateral,
                ..state
            },
        }
    }

    /// Computes the twist of the active mode.
    #[inline(always)]
    pub fn compute_for_mode(&self, directed: &DirectedError<S>, mode: ActiveMode<S>) -> ControlOutput<S> {
        let (ahead, reverse, ActiveMode { error, state }) = (&directed.goal, directed.reverse, mode);
        let goal = self.goal_in_body(directed, &state);
        let Twist { v, omega } = Twist::select(
            state.local_mode,
            self.local_twist(&goal, -error, &state),
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

    /// Computes the twist of the active mode with gains reduced by the braking profile.
    ///
    /// In global mode v and ω are scaled by one factor, so that the path does not change. In local mode only k_θ is
    /// reduced.
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

    /// Returns ρ² in units of ε².
    #[inline(always)]
    fn radii_squared(&self, rho: S) -> S {
        (rho * (S::from_f64(1.0) / self.capture_radius)).squared()
    }

    #[inline(always)]
    fn goal_in_body(&self, directed: &DirectedError<S>, state: &HybridState<S>) -> GoalInBody<S> {
        let DirectedError { goal, cos, sinc, .. } = *directed;
        let radii_squared = self.radii_squared(goal.rho);
        GoalInBody {
            cos,
            sinc,
            ahead: S::select(
                state.local_mode,
                goal.rho * cos + sidestep::direction(state.sidestep) * directed.aside(),
                goal.rho * cos,
            ),
            radii_squared,
            per_radius: S::from_f64(1.0) / self.capture_radius,
        }
    }

    /// Computes (23) with scheduled gains; `alpha` is unwrapped beyond ±π.
    #[inline(always)]
    fn global_twist(&self, goal: &GoalInBody<S>, ahead: &NavigationVariables<S>, alpha: S) -> Twist<S> {
        let global = GlobalLaw {
            // min(k_v, V/ρ), without a division by zero at ρ = 0.
            k_v: self.actuator_limits.speed / ahead.rho.max(self.actuator_limits.speed / self.gains.k_v),
            k_alpha: small_error_gain(
                alpha,
                FULL_GAIN_ALPHA,
                self.gains.k_alpha,
                self.actuator_limits.small_error_gain_alpha,
            ),
            h: (goal.radii_squared * (self.gains.h * S::from_f64(1.0 / (APPROACH_RADIUS * APPROACH_RADIUS))))
                .min(self.gains.h),
        };
        let fade = goal.radii_squared.min(S::from_f64(1.0));
        // v < 0 grows as steering decreases: at the goal the robot backs up instead of turning around.
        let drive = goal.cos.max((S::from_f64(1.0) - fade) * goal.cos);
        let twist = global.twist_driven(ahead.rho, alpha, ahead.phi.radians(), drive, goal.sinc);
        Twist::new(twist.v, twist.omega * fade)
    }

    /// Computes (28) with scheduled gains; `heading_error` is unwrapped beyond ±π, and relative to the sidestep.
    #[inline(always)]
    fn local_twist(&self, goal: &GoalInBody<S>, heading_error: S, state: &HybridState<S>) -> Twist<S> {
        // `trim_ticks` is n at the n-th tick of trimming, and 0 outside trimming.
        let one = S::from_f64(1.0);
        let full = self.gains.k_theta;
        let local = LocalLaw {
            k_v: self.gains.k_v,
            k_theta: (full / state.trim_ticks.max(one))
                .max(self.actuator_limits.small_error_gain_theta.min(full)),
        };
        let twist = local.twist_toward(goal.ahead, heading_error);
        let limit = self.actuator_limits.turn_rate;
        let omega = twist.omega.clamp(-limit, limit);
        let arrived = one - (goal.ahead * (goal.per_radius * S::from_f64(1.0 / ARRIVED_RADIUS))).squared();
        let trimming = (S::from_f64(2.0) - heading_error.abs() * S::from_f64(1.0 / TRIM_THRESHOLD)).min(one);
        // In a sidestep the robot turns in place at full rate, and drives at the heading of the leg only.
        let sidesteps = sidestep::activity(state.sidestep);
        let turn = arrived.max(trimming).max(S::from_f64(MIN_TURN_FACTOR)).max(sidesteps);
        Twist::new(twist.v * trimming.max(one - sidesteps), omega * turn)
    }
}

/// Interpolates a gain by a parabola: at most `small` at zero error, `full` at errors ≥ `knee` \[rad].
#[inline(always)]
fn small_error_gain<S: Scalar>(error: S, knee: f64, full: S, small: S) -> S {
    let small = small.min(full);
    (small + (full - small) * S::from_f64(1.0 / (knee * knee)) * error.squared()).min(full)
}

/// Goal in the body frame, and its distance in units of ε.
struct GoalInBody<S> {
    cos: S,
    sinc: S,
    /// Remaining distance ρ·cos α \[m]; in a sidestep ρ·(cos α ± sin α), to the axis of the goal.
    ahead: S,
    /// ρ² in units of ε².
    radii_squared: S,
    /// 1/ε \[1/m].
    per_radius: S,
}

/// Returns the squared switching radius in units of ε²; `was_near` is the previous mode.
#[inline(always)]
fn handover<S: Scalar>(was_near: S::Mask) -> S {
    S::select(was_near, S::from_f64(LEAVE_RADIUS * LEAVE_RADIUS), S::from_f64(ENTER_RADIUS * ENTER_RADIUS))
}
