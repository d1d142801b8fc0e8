//! The simulated robot with its senses and its estimate: what every experiment with the whole robot starts from.
//!
//! It runs the loop of the core, [`surepose::closed_loop`], in a world of `surepose-sim`.

mod monitor;
mod scenario;
mod sensors;

use crate::{Arena, Seed, WallSegment, World};
use surepose::closed_loop::{Controller, ControllerState, SensorInput, Tick, tick};
use surepose::{
    Belief, Body, Goal, Health, Hypothesis, Map, MeasurementStats, Pose, SafetyAction, Stamp, Wall,
    WheelOdometry, WheelPair,
};
use surepose_config::CompassParameters;
use surepose_io::wall_map::WallMap;

pub use monitor::{LocalizationMonitor, SEARCH_RATE};
pub use scenario::{InsufficientClearance, ScanMethod, Scenario, Sensors};
pub use sensors::{HISTORY, SimLocalizer, new_localizer, scan_view, with_sensor_input};

/// A robot in its world, with what it makes of it.
#[derive(Clone, Debug)]
pub struct SimulatedRobot {
    world: World,
    compass: CompassParameters,
    localizer: Box<SimLocalizer>,
    walls: Vec<Wall<f64>>,
    monitor: LocalizationMonitor,
}

impl SimulatedRobot {
    /// The robot of `scenario` at its start, with everything random drawn from `seed`.
    ///
    /// The robot is told where it starts with the error that the scenario allows.
    pub fn new(scenario: &Scenario, seed: u64) -> Self {
        let (start, seed) = (scenario.start(), Seed(seed));
        let initial = Belief::new(perturbed(start, scenario.start_std, seed), scenario.start_std);
        let aided = scenario.sensors != Sensors::NONE;
        let walls = walls_from_segments(scenario.arena.walls());
        Self {
            world: World::new(scenario.world(), start, seed),
            compass: scenario.config.compass(),
            localizer: new_localizer(&scenario.config, scenario.scan_method, initial),
            monitor: LocalizationMonitor::new(
                &scenario.config,
                aided,
                scenario.scan_method,
                &walls,
                Stamp::default(),
            ),
            walls,
        }
    }

    /// One tick of the closed loop: the wheels turn as `wheels` \[rad/s] for a period, and what is sensed meanwhile
    /// says how they turn next.
    pub fn tick(
        &mut self,
        controller: &Controller<f64>,
        state: ControllerState<f64>,
        wheels: WheelPair<f64>,
        goal: Pose<Map, Goal, f64>,
    ) -> Tick<f64> {
        self.advance(wheels, controller.period, |simulated_robot, sensed| {
            let Self { localizer, walls, monitor, .. } = simulated_robot;
            tick(controller, localizer, walls, state, sensed, goal, monitor)
        })
    }

    /// The same without a goal: where the robot is after its wheels turned as `wheels` \[rad/s] for `period` \[s].
    pub fn step(&mut self, wheels: WheelPair<f64>, period: f64) -> Belief<f64> {
        let commanded = WheelOdometry::from_command(
            self.world.model().drive.wheel_travel_from_angle(wheels).scaled(period),
        );
        self.advance(wheels, period, |simulated_robot, sensed| {
            let Self { localizer, walls, monitor, .. } = simulated_robot;
            localizer.update(sensed, commanded, walls, monitor)
        })
    }

    /// Lets a period pass, and then the robot think of what it sensed.
    fn advance<T>(
        &mut self,
        wheels: WheelPair<f64>,
        period: f64,
        update: impl FnOnce(&mut Self, &SensorInput<'_, f64>) -> T,
    ) -> T {
        let sensed = self.world.step(wheels, period);
        let travel = self.localizer.estimator.wheel_odometry(sensed.stamp, sensed.rims);
        let compass = self.compass;
        with_sensor_input(&sensed, travel, &compass, |sensed| update(self, sensed))
    }

    /// The world, with the truth in it.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// Where the robot thinks it is.
    pub fn belief(&self) -> Belief<f64> {
        self.localizer.estimator.belief()
    }

    /// What the supervisor lets the wheels do.
    pub fn action(&self) -> SafetyAction {
        self.monitor.action(self.world.now(), &self.belief())
    }

    /// How far the estimate can be trusted.
    pub fn health(&self) -> Health {
        self.monitor.health(self.world.now(), &self.belief())
    }

    /// Where the robot may be, while it is lost.
    pub fn hypotheses(&self) -> impl Iterator<Item = &Hypothesis<f64>> {
        self.monitor.hypotheses()
    }

    /// The walls of its map.
    pub fn walls(&self) -> &[Wall<f64>] {
        &self.walls
    }

    /// How often a wall that the laser saw corrected the estimate.
    pub fn laser_updates(&self) -> u32 {
        self.monitor.laser_updates()
    }

    /// What became of the measurements.
    pub fn measurement_stats(&self) -> &MeasurementStats {
        self.localizer.estimator.measurement_stats()
    }
}

/// The wall map of an arena.
pub fn wall_map_from_arena(arena: &Arena) -> WallMap {
    let walls = arena.walls().iter().map(|WallSegment { start, end }| surepose_io::wall_map::MapWall {
        name: None,
        from: [start.x, start.y],
        to: [end.x, end.y],
        covariance: None,
    });
    WallMap { name: Some(arena.name().to_owned()), walls: walls.collect() }
}

/// The walls of a map; one without length is left out.
pub fn walls_from_segments(segments: &[WallSegment]) -> Vec<Wall<f64>> {
    segments.iter().filter_map(|wall| Wall::between(wall.start, wall.end).ok()).collect()
}

/// `pose`, as somebody would tell it who knows it with these standard deviations.
fn perturbed(pose: Pose<Map, Body, f64>, std: [f64; 3], seed: Seed) -> Pose<Map, Body, f64> {
    let mut noise = seed.stream("start");
    let [x, y, heading] = std.map(|std| std * noise.normal());
    Pose::new(pose.x + x, pose.y + y, pose.heading.rotated_by(heading))
}
