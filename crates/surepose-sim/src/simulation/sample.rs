//! One tick of a drive, as a row of its time series.

use serde::Serialize;
use surepose::control::{Controller, ControllerState, GoalStatus, NavigationVariables};
use surepose::geometry::{Goal, Map, Pose};
use surepose::kinematics::Twist;
use surepose::navigator::StepReport;

use crate::World;

/// Active controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ControlMode {
    /// The global law.
    Far,
    /// The local law.
    Near,
    /// Inside the tolerance: the wheels rest.
    Holding,
}

/// The state of a drive at one tick; angles in degrees, as everywhere at the edge.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Sample {
    /// Time since the start.
    pub time_s: f64,
    /// True position.
    pub x_m: f64,
    /// True position.
    pub y_m: f64,
    /// True heading.
    pub heading_deg: f64,
    /// Estimated position.
    pub estimated_x_m: f64,
    /// Estimated position.
    pub estimated_y_m: f64,
    /// Estimated heading.
    pub estimated_heading_deg: f64,
    /// Variance of the estimated x.
    pub variance_x_m2: f64,
    /// Variance of the estimated y.
    pub variance_y_m2: f64,
    /// Covariance of the two.
    pub covariance_xy_m2: f64,
    /// Standard deviation of the estimated heading.
    pub heading_std_deg: f64,
    /// Normalised estimation error squared.
    pub nees: f64,
    /// True speed.
    pub v_m_s: f64,
    /// True turn rate.
    pub omega_deg_s: f64,
    /// Speed asked of the wheels.
    pub commanded_v_m_s: f64,
    /// Turn rate asked of the wheels.
    pub commanded_omega_deg_s: f64,
    /// True distance to the goal.
    pub goal_distance_m: f64,
    /// True heading minus the goal's.
    pub heading_error_deg: f64,
    /// The Lyapunov function of the law in charge, of the estimated pose: V_g far, V_l near.
    pub lyapunov: f64,
    /// Active controller.
    pub mode: ControlMode,
    /// Whether `lyapunov` is V_l: the local law has the robot, driving or holding.
    pub local: bool,
    /// Whether the tail goes first.
    pub reverse: bool,
}

impl Sample {
    /// The sample of one step.
    pub(super) fn from_report(
        world: &World,
        report: &StepReport<f64>,
        controller: &Controller<f64>,
        goal: Pose<Map, Goal, f64>,
    ) -> Self {
        let (truth, twist, belief) = (world.pose(), world.twist(), &report.belief);
        let (actual, estimated) = (NavigationVariables::from_poses(truth, goal), belief.pose);
        let commanded = report.command.map_or(Twist::zero(), |command| command.twist);
        let seen = NavigationVariables::from_poses(estimated, goal);
        let state = report.control.map_or_else(ControllerState::new, |control| control.state);
        Self {
            time_s: world.now().seconds(),
            x_m: truth.x,
            y_m: truth.y,
            heading_deg: truth.heading.degrees(),
            estimated_x_m: estimated.x,
            estimated_y_m: estimated.y,
            estimated_heading_deg: estimated.heading.degrees(),
            variance_x_m2: belief.covariance.entry(0, 0),
            variance_y_m2: belief.covariance.entry(1, 1),
            covariance_xy_m2: belief.covariance.entry(0, 1),
            heading_std_deg: belief.covariance.std(2).to_degrees(),
            nees: belief.nees(truth),
            v_m_s: twist.v,
            omega_deg_s: twist.omega.to_degrees(),
            commanded_v_m_s: commanded.v,
            commanded_omega_deg_s: commanded.omega.to_degrees(),
            goal_distance_m: actual.rho,
            heading_error_deg: actual.heading_error().degrees(),
            lyapunov: controller.law.lyapunov(&seen, &state.hybrid),
            mode: mode(controller, &state),
            local: state.hybrid.local_mode,
            reverse: state.hybrid.reverse,
        }
    }
}

fn mode(controller: &Controller<f64>, state: &ControllerState<f64>) -> ControlMode {
    match state.goal_checker.status(&controller.tolerance) {
        GoalStatus::Dwelling | GoalStatus::Reached => ControlMode::Holding,
        GoalStatus::Approaching if state.hybrid.local_mode => ControlMode::Near,
        GoalStatus::Approaching => ControlMode::Far,
    }
}
