//! The simulated robot: the core's [`Navigator`](surepose::navigator::Navigator) in a simulated [`World`].

mod invalid_end;
mod scenario;
mod sensors;

use surepose::estimation::Belief;
use surepose::geometry::{Body, Goal, Map, Pose};
use surepose::kinematics::WheelPair;
use surepose::lidar::ScanTiming;
use surepose::localization::SensorInput;
use surepose::map::Wall;
use surepose::navigator::StepReport;
use surepose::time::Stamp;
use surepose_config::{CompassParameters, RobotNavigator};
use surepose_io::owned_map::{GoalProblem, OwnedMap};
use surepose_io::wall_map::{MapWall, WallMap};

use crate::{Arena, Seed, WallSegment, World};

pub use crate::arena::walls_from_segments;
pub use invalid_end::{InvalidEnd, InvalidEndReason, ScenarioEnd};
pub use scenario::{Scenario, Sensors};
pub use sensors::{scan_view, with_sensor_input};

/// A robot in its world, with its navigator and its map.
#[derive(Clone, Debug)]
pub struct SimulatedRobot {
    world: World,
    compass: CompassParameters,
    timing: ScanTiming,
    navigator: Box<RobotNavigator>,
    map: OwnedMap,
}

impl SimulatedRobot {
    /// The robot of `scenario` at its start, with everything random drawn from `seed`.
    ///
    /// Its initial belief has the error that the scenario allows.
    pub fn new(scenario: &Scenario, seed: u64) -> Self {
        let (start, seed) = (scenario.start(), Seed(seed));
        let initial = Belief::new(perturbed(start, scenario.start_std, seed), scenario.start_std);
        let setup = scenario.navigator_setup();
        Self {
            world: World::new(scenario.world(), scenario.true_start(), seed),
            compass: scenario.config.compass(),
            timing: scenario.config.laser().timing,
            navigator: scenario.config.navigator(&setup, Stamp::default(), initial),
            map: scenario.robot_map(),
        }
    }

    /// Sends the navigator to `goal`.
    ///
    /// # Errors
    /// [`GoalProblem`], if the walls rule the goal out.
    pub fn set_goal(&mut self, goal: Pose<Map, Goal, f64>) -> Result<(), GoalProblem> {
        let here = self.navigator.localizer().belief().pose.origin();
        self.map.check_goal(&self.navigator.config().collision, Some(here), goal)?;
        // The navigator repeats the check of the clearance, which has passed.
        let _previous = self.navigator.set_goal(&self.map.view(), goal);
        Ok(())
    }

    /// Turns the wheels at `wheels` \[rad/s] for `period` \[s], and steps the navigator with what the sensors reported.
    pub fn advance(&mut self, wheels: WheelPair<f64>, period: f64) -> StepReport<f64> {
        self.advance_watched(wheels, period, |_, _| {})
    }

    /// Runs [`SimulatedRobot::advance`], and passes the navigator's input and report to `watch`.
    pub fn advance_watched(
        &mut self,
        wheels: WheelPair<f64>,
        period: f64,
        watch: impl FnOnce(&SensorInput<'_, f64>, &StepReport<f64>),
    ) -> StepReport<f64> {
        let output = self.world.step(wheels, period);
        let Self { navigator, map, compass, timing, .. } = self;
        with_sensor_input(&output, compass, timing, |input| {
            let report = navigator.step(&map.view(), input);
            watch(input, &report);
            report
        })
    }

    /// The world, with the truth in it.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// The navigator.
    pub fn navigator(&self) -> &RobotNavigator {
        &self.navigator
    }

    /// The walls of its map.
    pub fn walls(&self) -> &[Wall<f64>] {
        self.map.walls()
    }
}

/// The wall map of an arena.
pub fn wall_map_from_arena(arena: &Arena) -> WallMap {
    let walls = arena.walls().iter().map(|WallSegment { start, end }| MapWall {
        name: None,
        from: [start.x, start.y],
        to: [end.x, end.y],
        covariance: None,
    });
    WallMap { name: Some(arena.name().to_owned()), walls: walls.collect() }
}

/// `pose` with errors of these standard deviations: x \[m], y \[m], heading \[rad].
fn perturbed(pose: Pose<Map, Body, f64>, std: [f64; 3], seed: Seed) -> Pose<Map, Body, f64> {
    let mut noise = seed.stream("start");
    let [x, y, heading] = std.map(|std| std * noise.normal());
    Pose::new(pose.x + x, pose.y + y, pose.heading.rotated_by(heading))
}
