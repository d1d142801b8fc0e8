//! One closed-loop drive of the simulated robot: sensors, estimate, law, motors, until it rests at the goal.
//!
//! Every tick is [`surepose::closed_loop::tick`], the one that a real robot runs; what the supervisor leaves of it turns
//! the wheels of a robot of `surepose-sim`.

mod collision;
mod command_gate;
mod sample;
mod summary;
#[cfg(test)]
mod tests;

use surepose::closed_loop::{Controller, ControllerState, Tick};
use surepose::{
    FaultReason, Goal, GoalStatus, Map, NavigationVariables, Pose, SafetyAction, Twist, WheelPair, param,
};

use crate::ErrorAccumulator;
use crate::optimal::fastest;
use crate::robot::{Scenario, SimulatedRobot};

pub use collision::stopping_trajectory;
pub use command_gate::{CommandGate, GOAL_TIMEOUT, limit_command};
pub use sample::{ControlMode, Sample};
pub use summary::{SimulationOutcome, SimulationSummary};

/// Drives `scenario` to its end.
pub fn simulate(scenario: &Scenario, seed: u64) -> (Vec<Sample>, SimulationSummary) {
    let mut simulation = Simulation::new(scenario, seed);
    let samples = simulation.by_ref().collect();
    (samples, simulation.summary())
}

/// A drive under way: an iterator over its ticks, which ends where the drive does.
#[derive(Clone, Debug)]
pub struct Simulation {
    simulated_robot: SimulatedRobot,
    controller: Controller<f64>,
    state: ControllerState<f64>,
    goal: Pose<Map, Goal, f64>,
    wheels: WheelPair<f64>,
    command_gate: CommandGate,
    can_search: bool,
    timeout: f64,
    optimal_time: f64,
    outcome: Option<SimulationOutcome>,
    errors: ErrorAccumulator,
    path_length: f64,
    closest_wall: f64,
    max_rim_speed: f64,
    max_rim_acceleration: f64,
    seed: u64,
}

impl Simulation {
    /// The drive of `scenario` with everything random drawn from `seed`.
    pub fn new(scenario: &Scenario, seed: u64) -> Self {
        let controller = scenario.config.controller();
        let goal_from_start = scenario.goal().inverse() * scenario.start();
        let fastest = fastest(goal_from_start, &controller.drive, controller.limits.wheel_speed);
        Self {
            simulated_robot: SimulatedRobot::new(scenario, seed),
            controller,
            state: ControllerState::new(),
            goal: scenario.goal(),
            wheels: WheelPair::new(0.0, 0.0),
            command_gate: CommandGate::default(),
            can_search: scenario.sensors.laser,
            timeout: scenario.config.number(&param::TIMEOUT),
            optimal_time: fastest.time,
            outcome: None,
            errors: ErrorAccumulator::default(),
            path_length: 0.0,
            closest_wall: f64::INFINITY,
            max_rim_speed: 0.0,
            max_rim_acceleration: 0.0,
            seed,
        }
    }

    /// How much of the time that it may take is over, in [0, 1].
    pub fn elapsed(&self) -> f64 {
        (self.simulated_robot.world().now().seconds() / self.timeout).clamp(0.0, 1.0)
    }

    /// Goes on for another tick, also after the end: to see whether the robot stays there.
    pub fn tick(&mut self) -> Sample {
        let before = self.simulated_robot.world().pose();
        let Tick { belief, step, .. } =
            self.simulated_robot.tick(&self.controller, self.state, self.wheels, self.goal);
        let now = self.simulated_robot.world().now().seconds();
        let last = self.state.limited;
        let step = self.command_gate.apply(
            self.simulated_robot.action(),
            &self.controller,
            step,
            last,
            now,
            self.can_search,
        );
        let world = self.simulated_robot.world();
        let step = self.command_gate.stop_for_walls(
            &world.model().arena,
            world.pose(),
            &self.controller,
            step,
            last,
        );
        self.state = step.state;
        self.wheels = step.wheels;

        let world = self.simulated_robot.world();
        let truth = world.pose();
        self.path_length += before.origin().distance(truth.origin());
        self.closest_wall = self.closest_wall.min(world.model().arena.clearance(truth.origin()));
        let drive = &self.controller.drive;
        let (rims, change) =
            (drive.wheel_speeds_from_twist(step.limited), drive.wheel_speeds_from_twist(step.limited - last));
        self.max_rim_speed = self.max_rim_speed.max(rims.max_abs());
        self.max_rim_acceleration = self.max_rim_acceleration.max(change.max_abs() / self.controller.period);
        self.errors.add(belief.error(truth));
        self.errors.add_nees(belief.nees(truth));
        Sample::from_step(world, &belief, &self.controller, &step, self.goal)
    }

    /// What the supervisor says.
    pub fn action(&self) -> SafetyAction {
        self.simulated_robot.action()
    }

    /// Why the robot was stopped, where it was.
    fn stop_reason(&self) -> Option<&'static str> {
        let timed_out = self.command_gate.timed_out(self.simulated_robot.world().now().seconds());
        let by_wall = self.command_gate.is_stopped_for_wall() || self.closest_wall < 0.0;
        if by_wall { Some("wall") } else { timed_out.map(FaultReason::name) }
    }

    /// The figures up to now; a drive that has not ended counts as stopped.
    pub fn summary(&self) -> SimulationSummary {
        let world = self.simulated_robot.world();
        let error = NavigationVariables::from_poses(world.pose(), self.goal);
        let judged = self.errors.clone().summary();
        let stats = self.simulated_robot.measurement_stats();
        SimulationSummary {
            outcome: self.outcome.unwrap_or(SimulationOutcome::Stopped),
            stop_reason: self.stop_reason(),
            time_s: world.now().seconds(),
            final_position_error_m: error.rho,
            final_heading_error_deg: error.heading_error().degrees().abs(),
            final_speed_m_s: world.twist().v.abs(),
            final_turn_rate_deg_s: world.twist().omega.to_degrees().abs(),
            position_rmse_m: judged.map(|judged| judged.position_rmse),
            heading_rmse_deg: judged.map(|judged| judged.heading_rmse.to_degrees()),
            nees_mean: judged.and_then(|judged| judged.nees_mean),
            path_length_m: self.path_length,
            optimal_time_s: self.optimal_time,
            closest_wall_m: self.closest_wall,
            wheel_speed_max_m_s: self.max_rim_speed,
            wheel_acceleration_max_m_s2: self.max_rim_acceleration,
            accepted: stats.accepted,
            walls: self.simulated_robot.laser_updates(),
            rejected: stats.rejected_total(),
            seed: self.seed,
        }
    }

    /// Whether the robot is within the goal's tolerance in truth, whatever it believes.
    fn is_at_goal(&self) -> bool {
        let error = NavigationVariables::from_poses(self.simulated_robot.world().pose(), self.goal);
        let tolerance = &self.controller.tolerance;
        error.rho <= tolerance.position && error.heading_error().radians().abs() <= tolerance.heading
    }

    /// Whether, and how, the drive is over: at the goal the motors must stand, too.
    fn ended(&self) -> Option<SimulationOutcome> {
        let world = self.simulated_robot.world();
        let stands = world.rim_speeds() == WheelPair::new(0.0, 0.0) && world.twist() == Twist::zero();
        let phase = self.state.goal_checker.status(&self.controller.tolerance);
        if phase == GoalStatus::Reached && stands {
            Some(if self.is_at_goal() { SimulationOutcome::Reached } else { SimulationOutcome::Missed })
        } else if self.stop_reason().is_some() && (stands || !self.command_gate.is_stopped_for_wall()) {
            Some(SimulationOutcome::Stopped)
        } else {
            (world.now().seconds() >= self.timeout).then_some(SimulationOutcome::Timeout)
        }
    }
}

impl Iterator for Simulation {
    type Item = Sample;

    fn next(&mut self) -> Option<Sample> {
        if self.outcome.is_some() {
            return None;
        }
        let sample = self.tick();
        self.outcome = self.ended();
        Some(sample)
    }
}
