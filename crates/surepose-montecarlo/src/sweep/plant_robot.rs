//! One robot of a plant sweep: the shipped step without localization, on a base that is not ideal.

use surepose::control::{ActuatorState, ControllerState, GoalStatus};
use surepose::geometry::{Body, Goal, Map, Pose};
use surepose::kinematics::{Integration, Twist, WheelPair};
use surepose::navigator::AbortReason;
use surepose::safety::{LyapunovValue, MotionMonitor, ProgressMonitor};
use surepose::time::Stamp;
use surepose_sim::{ContactPoints, Plant, Stream};

use super::plant_spec::PlantSweep;

/// Largest step of the base \[s], as in the simulator.
const MAX_SUBSTEP: f64 = 0.01;

/// State of the robot and of its base.
pub(super) struct PlantRobot<'a> {
    sweep: &'a PlantSweep,
    substeps: u32,
    now: Stamp,
    /// True pose, relative to the goal.
    pub(super) pose: Pose<Map, Body, f64>,
    plant: Plant,
    contact: ContactPoints,
    state: ControllerState<f64>,
    limited: Twist<f64>,
    actuator: ActuatorState<f64>,
    motion: MotionMonitor<f64>,
    progress: ProgressMonitor<f64>,
    noise: Stream,
}

impl<'a> PlantRobot<'a> {
    /// Robot at rest at `start`.
    pub(super) fn new(sweep: &'a PlantSweep, start: Pose<Map, Body, f64>, noise: Stream) -> Self {
        Self {
            sweep,
            substeps: (sweep.controller.period / MAX_SUBSTEP - 1e-9).ceil().max(1.0) as u32,
            now: Stamp::default(),
            pose: start,
            plant: Plant::default(),
            contact: ContactPoints::default(),
            state: ControllerState::new(),
            limited: Twist::zero(),
            actuator: ActuatorState::new(),
            motion: MotionMonitor::new(),
            progress: ProgressMonitor::new(),
            noise,
        }
    }

    /// Advances by one control period; returns the path length \[m], negative in reverse, and why the goal was
    /// aborted.
    ///
    /// The sequence is that of [`Navigator::step`](surepose::navigator::Navigator::step): predict, decide, limit,
    /// execute, and compare commands with odometry.
    pub(super) fn step(&mut self) -> (f64, Option<AbortReason>) {
        let PlantSweep { controller, actuator, .. } = self.sweep;
        let goal: Pose<Map, Goal, f64> = Pose::identity();
        let estimate = self.estimate();
        let predicted = self.actuator.predict(actuator, estimate);
        let decision = controller.decide(self.state, predicted, goal);
        let limited =
            controller.limits.limit(&controller.drive, decision.desired, self.limited, controller.period);
        let step = controller.finish(decision, limited);
        self.limited = step.limited;
        let command = self.actuator.execute(
            actuator,
            &controller.drive,
            &controller.limits,
            step.limited,
            controller.period,
        );
        self.state = step.state;
        let hybrid = &step.state.hybrid;
        let value = controller.law.lyapunov_by_mode(&step.navigation, hybrid);
        let value = LyapunovValue { value, is_local: hybrid.local_mode };
        let status = step.state.goal_checker.status(&controller.tolerance);
        self.progress.update(status, value, controller.period);
        let (length, measured) = self.drive(command);
        let expected = self.actuator.expected_speed(actuator, command);
        let expected = controller.drive.wheel_speeds_from_twist(expected);
        self.motion.update(expected, measured, controller.period);
        (length, self.abort_reason())
    }

    /// Pose that the controller receives.
    fn estimate(&mut self) -> Pose<Map, Body, f64> {
        let (noise, pose) = (&self.sweep.noise, self.pose);
        let mut draw = |std: f64| std * self.noise.normal();
        Pose::new(
            pose.x + draw(noise.position),
            pose.y + draw(noise.position),
            pose.heading.rotated_by(draw(noise.heading)),
        )
    }

    /// Executes `command` for one period; returns the path length \[m] and the rim travel that the encoders report
    /// \[m].
    fn drive(&mut self, command: Twist<f64>) -> (f64, WheelPair<f64>) {
        let PlantSweep { controller, drive, plant, traction, noise, .. } = self.sweep;
        let rates = controller.drive.wheel_rates_from_twist(command);
        self.plant.send(plant, self.now, rates);
        let factor = WheelPair::new(
            1.0 + noise.wheels * self.noise.normal(),
            1.0 + noise.wheels * self.noise.normal(),
        );
        let time = controller.period / f64::from(self.substeps);
        let (begin, mut length, mut turned) = (self.now, 0.0, WheelPair::zero());
        for substep in 1..=self.substeps {
            let WheelPair { right, left } = self.plant.advance(plant, drive, self.now, time);
            let turn = WheelPair::new(right.mean * time, left.mean * time);
            turned = WheelPair::new(turned.right + turn.right, turned.left + turn.left);
            let slipped = WheelPair::new(turn.right * factor.right, turn.left * factor.left);
            let travel = self.contact.travel(traction, drive.wheel_travel_from_angle(slipped), time);
            let motion = drive.motion_from_travel(travel);
            self.pose = self.pose.integrate(motion, Integration::Arc);
            length += motion.length;
            self.now = begin.after(f64::from(substep) * time);
        }
        (length, controller.drive.wheel_travel_from_angle(turned))
    }

    /// Reason for which the navigator would abort the goal; `None` if it would not.
    fn abort_reason(&self) -> Option<AbortReason> {
        let is_stagnant = self.progress.stagnant_for() >= self.sweep.progress_timeout;
        let fault = self.motion.fault(self.sweep.stall_timeout).map(AbortReason::Motion);
        let status = self.state.goal_checker.status(&self.sweep.controller.tolerance);
        let fault = fault.filter(|_| status == GoalStatus::Approaching);
        fault.or_else(|| is_stagnant.then_some(AbortReason::NoProgress))
    }
}
