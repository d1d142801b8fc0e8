//! One closed-loop drive of the simulated robot: sensors, estimate, law, motors, until it rests at the goal.
//!
//! Every step is [`Navigator::step`](surepose::navigator::Navigator::step), the one that a real robot runs.

mod sample;
mod summary;
#[cfg(test)]
mod tests;

use surepose::control::{Controller, GoalStatus, NavigationVariables};
use surepose::estimation::DisagreeingSensor;
use surepose::geometry::{Goal, Map, Pose};
use surepose::kinematics::{Twist, WheelPair};
use surepose::localization::{LocalizationMonitor, SensorInput};
use surepose::navigator::{AbortReason, GoalResult, StepReport};
use surepose::optimal::fastest;
use surepose::param;
use surepose::safety::{BlockReason, Health, SafetyAction};
use surepose_config::RobotNavigator;

use crate::ErrorAccumulator;
use crate::robot::{Scenario, SimulatedRobot};

pub use sample::{ControlMode, Sample};
pub use summary::{RejectedCounts, SimulationOutcome, SimulationSummary};

/// Drives `scenario` to its end.
pub fn simulate(scenario: &Scenario, seed: u64) -> (Vec<Sample>, SimulationSummary) {
    let mut simulation = Simulation::new(scenario, seed);
    let samples = simulation.by_ref().collect();
    (samples, simulation.summary())
}

/// A drive under way: an iterator over its steps, which ends where the drive does.
#[derive(Clone, Debug)]
pub struct Simulation {
    robot: SimulatedRobot,
    controller: Controller<f64>,
    goal: Pose<Map, Goal, f64>,
    /// Turn rates that the wheels are commanded \[rad/s], and the twist that they give.
    wheels: WheelPair<f64>,
    commanded: Twist<f64>,
    status: GoalStatus,
    aborted: Option<AbortReason>,
    /// Whether the navigator reported the goal as reached.
    has_arrived: bool,
    /// Time at which a sensor first disagreed with the others \[s], and that sensor; `None` before.
    disagreement: Option<(f64, DisagreeingSensor)>,
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
    ///
    /// A goal that the walls rule out ends the simulation at once: see [`Scenario::check_clearance`].
    pub fn new(scenario: &Scenario, seed: u64) -> Self {
        let controller = scenario.config.controller();
        let goal_from_start = scenario.goal().inverse() * scenario.start();
        let fastest = fastest(goal_from_start, &controller.drive, controller.limits.wheel_speed);
        let mut robot = SimulatedRobot::new(scenario, seed);
        // A goal without room is blocked by a wall from the start.
        let refused = robot.set_goal(scenario.goal()).is_err();
        Self {
            robot,
            controller,
            goal: scenario.goal(),
            wheels: WheelPair::zero(),
            commanded: Twist::zero(),
            status: GoalStatus::Approaching,
            has_arrived: false,
            disagreement: None,
            aborted: refused.then_some(AbortReason::Blocked(BlockReason::Wall)),
            timeout: scenario.config.number(&param::TIMEOUT),
            optimal_time: fastest.time,
            outcome: refused.then_some(SimulationOutcome::Stopped),
            errors: ErrorAccumulator::default(),
            path_length: 0.0,
            closest_wall: f64::INFINITY,
            max_rim_speed: 0.0,
            max_rim_acceleration: 0.0,
            seed,
        }
    }

    /// Elapsed share of the time limit, in [0, 1].
    pub fn elapsed(&self) -> f64 {
        (self.robot.world().now().seconds() / self.timeout).clamp(0.0, 1.0)
    }

    /// Advances by one control period, also after the end: to see whether the robot stays there.
    pub fn tick(&mut self) -> Sample {
        self.tick_watched(|_, _| {})
    }

    fn tick_watched(&mut self, watch: impl FnOnce(&SensorInput<'_, f64>, &StepReport<f64>)) -> Sample {
        let before = self.robot.world().pose();
        let report = self.robot.advance_watched(self.wheels, self.controller.period, watch);
        let twist = report.command.map_or(Twist::zero(), |command| command.twist);
        self.wheels = report.command.map_or(WheelPair::zero(), |command| command.wheels);
        self.note(&report, twist);
        let world = self.robot.world();
        let truth = world.pose();
        self.path_length += before.origin().distance(truth.origin());
        self.closest_wall = self.closest_wall.min(world.model().arena.clearance(truth.origin()));
        self.errors.add(report.belief.error(truth));
        self.errors.add_nees(report.belief.nees(truth));
        Sample::from_report(world, &report, &self.controller, self.goal)
    }

    /// Returns the next sample like the iterator, and passes the navigator's input and report to `watch`.
    pub fn next_watched(
        &mut self,
        watch: impl FnOnce(&SensorInput<'_, f64>, &StepReport<f64>),
    ) -> Option<Sample> {
        if self.outcome.is_some() {
            return None;
        }
        let sample = self.tick_watched(watch);
        self.outcome = self.ended();
        Some(sample)
    }

    /// The navigator.
    pub fn navigator(&self) -> &RobotNavigator {
        self.robot.navigator()
    }

    /// Action of the supervisor in the last step.
    pub fn action(&self) -> SafetyAction {
        self.robot.navigator().localizer().action()
    }

    /// Quality of the estimate after the last step.
    pub fn health(&self) -> Health {
        self.robot.navigator().localizer().health()
    }

    /// Reason for which the goal was aborted; `None` if it was not.
    pub fn abort_reason(&self) -> Option<AbortReason> {
        self.aborted
    }

    fn note(&mut self, report: &StepReport<f64>, twist: Twist<f64>) {
        let drive = &self.controller.drive;
        let speeds = drive.wheel_speeds_from_twist(twist);
        let change = drive.wheel_speeds_from_twist(twist - self.commanded);
        self.max_rim_speed = self.max_rim_speed.max(speeds.max_abs());
        self.max_rim_acceleration = self.max_rim_acceleration.max(change.max_abs() / self.controller.period);
        self.commanded = twist;
        if let Some(control) = &report.control {
            self.status = control.state.goal_checker.status(&self.controller.tolerance);
        }
        match report.result {
            Some(GoalResult::Aborted(reason)) => self.aborted = Some(reason),
            Some(GoalResult::Reached) => self.has_arrived = true,
            _ => {}
        }
        if let Some(sensor) = report.disagreement.filter(|_| self.disagreement.is_none()) {
            self.disagreement = Some((report.stamp.seconds(), sensor));
        }
    }

    /// Reason of a stop; `None` if the robot was not stopped. A robot that was pushed through a wall stopped at it.
    fn stop_reason(&self) -> Option<&'static str> {
        if self.closest_wall < 0.0 { Some("wall") } else { self.aborted.map(AbortReason::name) }
    }

    /// The figures up to now; a drive that has not ended counts as interrupted.
    pub fn summary(&self) -> SimulationSummary {
        let world = self.robot.world();
        let error = NavigationVariables::from_poses(world.pose(), self.goal);
        let judged = self.errors.clone().summary();
        let localizer = self.robot.navigator().localizer();
        let stats = localizer.measurement_stats();
        SimulationSummary {
            outcome: self.outcome.unwrap_or(SimulationOutcome::Interrupted),
            stop_reason: self.stop_reason(),
            reason: self.stop_reason(),
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
            walls: localizer.monitor().map_or(0, LocalizationMonitor::scan_updates),
            rejected: RejectedCounts::from_stats(stats),
            disagreeing_sensor: self.disagreement.map(|(_, sensor)| sensor.name()),
            inconsistent_from_s: self.disagreement.map(|(time, _)| time),
            seed: self.seed,
        }
    }

    /// Whether the true pose is within the goal's tolerance, whatever the estimate.
    fn is_at_goal(&self) -> bool {
        let error = NavigationVariables::from_poses(self.robot.world().pose(), self.goal);
        let tolerance = &self.controller.tolerance;
        error.rho <= tolerance.position && error.heading_error().radians().abs() <= tolerance.heading
    }

    /// Outcome of the drive; `None` before its end. At the goal, and after an abort, the motors must stand, too.
    fn ended(&self) -> Option<SimulationOutcome> {
        let world = self.robot.world();
        let stands = world.rim_speeds() == WheelPair::zero() && world.twist() == Twist::zero();
        if self.status == GoalStatus::Reached && self.has_arrived && self.aborted.is_none() && stands {
            Some(if self.is_at_goal() { SimulationOutcome::Reached } else { SimulationOutcome::Missed })
        } else if self.stop_reason().is_some() && stands {
            Some(SimulationOutcome::Stopped)
        } else {
            (world.now().seconds() >= self.timeout).then_some(SimulationOutcome::Timeout)
        }
    }
}

impl Iterator for Simulation {
    type Item = Sample;

    fn next(&mut self) -> Option<Sample> {
        self.next_watched(|_, _| {})
    }
}
