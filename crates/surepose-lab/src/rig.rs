//! The simulated robot with its senses and its estimate: what every experiment with the whole robot starts from.
//!
//! It runs the loop of the core, [`surepose::closed_loop`], in a world of `surepose-sim`.

mod scenario;
mod senses;
mod watch;

use surepose::closed_loop::{Controller, Progress, Sensed, Tick, tick};
use surepose::{
    Belief, Body, Goal, Health, Hypothesis, Map, Pose, Stamp, Tally, Travel, Verdict, Wall, Wheels,
};
use surepose_data::config::CompassMounting;
use surepose_data::wall_map::WallMap;
use surepose_sim::{Arena, Seed, Segment, World};

pub use scenario::{NoRoom, Reading, Scenario, Sensors};
pub use senses::{HISTORY, Localisation, localisation, scan_of, translated};
pub use watch::{SEARCH_RATE, Watch};

/// A robot in its world, with what it makes of it.
#[derive(Clone, Debug)]
pub struct Rig {
    world: World,
    compass: CompassMounting,
    localiser: Box<Localisation>,
    walls: Vec<Wall<f64>>,
    watch: Watch,
}

impl Rig {
    /// The robot of `scenario` at its start, with everything random drawn from `seed`.
    ///
    /// The robot is told where it starts with the error that the scenario allows.
    pub fn new(scenario: &Scenario, seed: u64) -> Self {
        let (start, seed) = (scenario.start(), Seed(seed));
        let told = Belief::new(mistaken(start, scenario.start_std, seed), scenario.start_std);
        let aided = scenario.sensors != Sensors::NONE;
        let walls = walls_between(scenario.arena.walls());
        Self {
            world: World::new(scenario.world(), start, seed),
            compass: scenario.config.compass(),
            localiser: localisation(&scenario.config, scenario.reading, told),
            watch: Watch::new(&scenario.config, aided, scenario.reading, &walls, Stamp::default()),
            walls,
        }
    }

    /// One tick of the closed loop: the wheels turn as `wheels` \[rad/s] for a period, and what is sensed meanwhile
    /// says how they turn next.
    pub fn tick(
        &mut self,
        controller: &Controller<f64>,
        progress: Progress<f64>,
        wheels: Wheels<f64>,
        goal: Pose<Map, Goal, f64>,
    ) -> Tick<f64> {
        self.live(wheels, controller.period, |rig, sensed| {
            let Self { localiser, walls, watch, .. } = rig;
            tick(controller, localiser, walls, progress, sensed, goal, watch)
        })
    }

    /// The same without a goal: where the robot is after its wheels turned as `wheels` \[rad/s] for `period` \[s].
    pub fn step(&mut self, wheels: Wheels<f64>, period: f64) -> Belief<f64> {
        let told = Travel::guessed(self.world.model().drive.rims_from_turns(wheels).scaled(period));
        self.live(wheels, period, |rig, sensed| {
            let Self { localiser, walls, watch, .. } = rig;
            localiser.sense(sensed, told, walls, watch)
        })
    }

    /// Lets a period pass, and then the robot think of what it sensed.
    fn live<T>(
        &mut self,
        wheels: Wheels<f64>,
        period: f64,
        think: impl FnOnce(&mut Self, &Sensed<'_, f64>) -> T,
    ) -> T {
        let sensed = self.world.step(wheels, period);
        let travel = self.localiser.estimator.travel(sensed.stamp, sensed.rims);
        let compass = self.compass;
        translated(&sensed, travel, &compass, |sensed| think(self, sensed))
    }

    /// The world, with the truth in it.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// Where the robot thinks it is.
    pub fn belief(&self) -> Belief<f64> {
        self.localiser.estimator.belief()
    }

    /// What the supervisor lets the wheels do.
    pub fn verdict(&self) -> Verdict {
        self.watch.verdict(self.world.now(), &self.belief())
    }

    /// How far the estimate can be trusted.
    pub fn health(&self) -> Health {
        self.watch.health(self.world.now(), &self.belief())
    }

    /// Where the robot may be, while it is lost.
    pub fn hypotheses(&self) -> impl Iterator<Item = &Hypothesis<f64>> {
        self.watch.hypotheses()
    }

    /// The walls of its map.
    pub fn walls(&self) -> &[Wall<f64>] {
        &self.walls
    }

    /// How often a wall that the laser saw corrected the estimate.
    pub fn sightings(&self) -> u32 {
        self.watch.sightings()
    }

    /// What became of the measurements.
    pub fn tally(&self) -> &Tally {
        self.localiser.estimator.tally()
    }
}

/// The wall map of an arena.
pub fn map_of(arena: &Arena) -> WallMap {
    let walls = arena.walls().iter().map(|Segment { start, end }| surepose_data::wall_map::Wall {
        name: None,
        from: [start.x, start.y],
        to: [end.x, end.y],
        covariance: None,
    });
    WallMap { name: Some(arena.name().to_owned()), walls: walls.collect() }
}

/// The walls of a map; one without length is left out.
pub fn walls_between(segments: &[Segment]) -> Vec<Wall<f64>> {
    segments.iter().filter_map(|wall| Wall::between(wall.start, wall.end).ok()).collect()
}

/// `pose`, as somebody would tell it who knows it with these standard deviations.
fn mistaken(pose: Pose<Map, Body, f64>, std: [f64; 3], seed: Seed) -> Pose<Map, Body, f64> {
    let mut noise = seed.stream("start");
    let [x, y, heading] = std.map(|std| std * noise.normal());
    Pose::new(pose.x + x, pose.y + y, pose.heading.turned(heading))
}
