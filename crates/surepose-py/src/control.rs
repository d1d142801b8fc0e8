//! The controller alone: from a pose and a goal to a twist within the limits.

use pyo3::prelude::*;
use surepose::control::{ControlStep, Controller, ControllerState, GoalStatus};

use crate::checks::{self, PoseArgument};
use crate::settings::{PyConfig, config_of};

/// Control law, goal check and limits of a configuration, without an estimate.
///
/// The controller has a state: call `step` once per period, and `reset` before a new goal.
#[pyclass(name = "Controller", module = "surepose")]
pub(crate) struct PyController {
    controller: Controller<f64>,
    state: ControllerState<f64>,
}

#[pymethods]
impl PyController {
    #[new]
    #[pyo3(signature = (config=None))]
    fn new(config: Option<PyRef<'_, PyConfig>>) -> Self {
        let controller = config_of(config.as_deref()).controller();
        Self { controller, state: ControllerState::new() }
    }

    /// Computes the twist of the next period for the robot at `pose` and a `goal`, both (x, y, heading) [m, m, rad].
    fn step(&mut self, pose: PoseArgument, goal: PoseArgument) -> PyResult<PyControlStep> {
        let step = self.controller.step(self.state, checks::pose("pose", pose)?, checks::pose("goal", goal)?);
        self.state = step.state;
        let lyapunov = self.controller.law.lyapunov(&step.navigation, &step.state.hybrid);
        let status = step.state.goal_checker.status(&self.controller.tolerance);
        Ok(PyControlStep { step, lyapunov, is_reached: status == GoalStatus::Reached })
    }

    /// Forgets the state: the next step is the first one.
    fn reset(&mut self) {
        self.state = ControllerState::new();
    }

    /// Control period [s].
    #[getter]
    fn period(&self) -> f64 {
        self.controller.period
    }
}

/// Result of one control step.
#[pyclass(name = "ControlStep", module = "surepose", frozen)]
pub(crate) struct PyControlStep {
    pub(crate) step: ControlStep<f64>,
    pub(crate) lyapunov: f64,
    pub(crate) is_reached: bool,
}

#[pymethods]
impl PyControlStep {
    /// Speed [m/s], within the limits.
    #[getter]
    fn v(&self) -> f64 {
        self.step.limited.v
    }

    /// Turn rate [rad/s], within the limits.
    #[getter]
    fn omega(&self) -> f64 {
        self.step.limited.omega
    }

    /// Speed [m/s] and turn rate [rad/s] that the law asks for, before the limits.
    #[getter]
    fn desired(&self) -> (f64, f64) {
        (self.step.desired.v, self.step.desired.omega)
    }

    /// Turn rates of the right and the left wheel [rad/s].
    #[getter]
    fn wheel_rates(&self) -> (f64, f64) {
        (self.step.wheels.right, self.step.wheels.left)
    }

    /// Distance to the goal ρ [m], its bearing α [rad] and the direction of approach φ [rad]: [Tran2012] Eq. (3).
    #[getter]
    fn navigation(&self) -> (f64, f64, f64) {
        let navigation = &self.step.navigation;
        (navigation.rho, navigation.alpha.radians(), navigation.phi.radians())
    }

    /// Lyapunov function of the active law: V_g far from the goal, V_l near it.
    #[getter]
    fn lyapunov(&self) -> f64 {
        self.lyapunov
    }

    /// Whether the local law is active.
    #[getter]
    fn is_local(&self) -> bool {
        self.step.state.hybrid.local_mode
    }

    /// Whether the robot drives in reverse.
    #[getter]
    fn is_reverse(&self) -> bool {
        self.step.state.hybrid.reverse
    }

    /// Whether the goal was held for the dwell time.
    #[getter]
    fn is_reached(&self) -> bool {
        self.is_reached
    }
}
