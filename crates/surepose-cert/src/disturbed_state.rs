//! One tick from one concrete state, simulated in `f64`; represents and confirms counterexamples.

use surepose::control::NavigationVariables;
use surepose::geometry::{Angle, Body, Goal, Map, Point, Pose};
use surepose::kinematics::{DiffDrive, Integration, Twist, WheelPair};

use crate::controller::SampledController;
use crate::discrete_state::DiscreteState;
use crate::lyapunov::LyapunovFunction;

/// True robot state, controller state, and the disturbances of one tick. The goal pose is (0, 0, 0).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DisturbedState {
    /// True x \[m].
    pub x: f64,
    /// True y \[m].
    pub y: f64,
    /// True heading \[rad].
    pub heading: f64,
    /// Discrete state of the control law.
    pub discrete_state: DiscreteState,
    /// Trim tick count of the control law.
    pub trim_ticks: f64,
    /// Mean lateral distance in the control law \[m].
    pub lateral: f64,
    /// Estimated minus true x \[m].
    pub noise_x: f64,
    /// Estimated minus true y \[m].
    pub noise_y: f64,
    /// Estimated minus true heading \[rad].
    pub noise_heading: f64,
    /// Error of the right wheel speed at the rim \[m/s].
    pub noise_right: f64,
    /// Error of the left wheel speed at the rim \[m/s].
    pub noise_left: f64,
}

/// Result of one tick from a [`DisturbedState`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transition {
    /// True navigation variables before the tick.
    pub before: NavigationVariables<f64>,
    /// True navigation variables after the tick.
    pub after: NavigationVariables<f64>,
    /// Discrete state of the control law after the tick.
    pub discrete_state: DiscreteState,
    /// Trim tick count after the tick.
    pub trim_ticks: f64,
    /// Mean lateral distance after the tick \[m].
    pub lateral: f64,
    /// Commanded twist (v \[m/s], ω \[rad/s]).
    pub commanded: Twist<f64>,
    /// W before the tick.
    pub lyapunov_before: f64,
    /// W after the tick. A value above `lyapunov_before` violates the certificate.
    pub lyapunov_after: f64,
}

impl DisturbedState {
    /// Simulates one tick with the motion model of `surepose`.
    pub fn simulate<L: SampledController>(
        &self,
        controller: &L,
        drive: &DiffDrive<f64>,
        period: f64,
        lyapunov: &LyapunovFunction,
        limited: bool,
    ) -> Transition {
        let goal: Pose<Map, Goal, f64> = Pose::identity();
        let pose: Pose<Map, Body, f64> = Pose::new(self.x, self.y, Angle::from_radians(self.heading));
        let estimate: Pose<Map, Body, f64> = Pose::new(
            self.x + self.noise_x,
            self.y + self.noise_y,
            Angle::from_radians(self.heading + self.noise_heading),
        );
        let output = controller.compute(
            &NavigationVariables::from_poses(estimate, goal),
            self.discrete_state.memory(self.trim_ticks, self.lateral),
        );
        let commanded = if limited { controller.limit(output.twist) } else { output.twist };
        let rims = drive.wheel_speeds_from_twist(commanded);
        let rims = WheelPair::new(rims.right + self.noise_right, rims.left + self.noise_left);
        let moved =
            pose.integrate(drive.twist_from_wheel_speeds(rims).integrate_for(period), Integration::Arc);

        let (before, after) =
            (NavigationVariables::from_poses(pose, goal), NavigationVariables::from_poses(moved, goal));
        let discrete_state = DiscreteState::from_memory_f64(&output.state);
        // W is undefined before the first decision of the control law.
        let held = if self.discrete_state.turn_direction == 0 { discrete_state } else { self.discrete_state };
        Transition {
            before,
            after,
            discrete_state,
            trim_ticks: output.state.trim_ticks,
            lateral: output.state.lateral,
            commanded,
            lyapunov_before: lyapunov.at(&before, held),
            lyapunov_after: lyapunov.at(&after, discrete_state),
        }
    }

    /// Creates a state from true polar coordinates (ρ \[m], α and φ \[rad]) with zero noise.
    pub fn polar(rho: f64, alpha: f64, phi: f64, discrete_state: DiscreteState) -> Self {
        let at: Point<Map, f64> = Point::new(-rho * phi.cos(), -rho * phi.sin());
        Self {
            x: at.x,
            y: at.y,
            heading: phi - alpha,
            discrete_state,
            trim_ticks: 0.0,
            lateral: 0.0,
            noise_x: 0.0,
            noise_y: 0.0,
            noise_heading: 0.0,
            noise_right: 0.0,
            noise_left: 0.0,
        }
    }
}
