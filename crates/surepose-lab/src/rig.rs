//! The simulated robot with its senses and its estimate: what every experiment with the whole robot starts from.

mod perception;
mod scenario;
mod watch;

use surepose::{
    Belief, Body, Estimator, Health, Hypothesis, Map, Pose, Stamp, Tally, Travel, Verdict, Wall, Wheels,
};
use surepose_sim::{Seed, World};

pub use perception::Perception;
pub use scenario::{Reading, Scenario, Sensors};
pub use watch::{SEARCH_RATE, Sight, Watch};

/// How many events the filter remembers: over a second of odometry at 50 Hz with headings and walls at 10 Hz.
const HISTORY: usize = 128;

/// A robot in its world, with what it makes of it.
#[derive(Clone, Debug)]
pub struct Rig {
    world: World,
    estimator: Estimator<f64, HISTORY>,
    perception: Perception,
    watch: Watch,
}

impl Rig {
    /// The robot of `scenario` at its start, with everything random drawn from `seed`.
    ///
    /// The robot is told where it starts with the error that the scenario allows.
    pub fn new(scenario: &Scenario, seed: u64) -> Self {
        let (start, seed) = (scenario.start(), Seed(seed));
        let told = mistaken(start, scenario.start_std, seed);
        Self {
            world: World::new(scenario.world(), start, seed),
            estimator: scenario.config.estimator(Stamp::default(), Belief::new(told, scenario.start_std)),
            perception: Perception::new(&scenario.config, scenario.arena.walls(), scenario.reading),
            watch: Watch::new(
                &scenario.config,
                scenario.sensors != Sensors::NONE,
                scenario.reading,
                Stamp::default(),
            ),
        }
    }

    /// Lets the wheels turn as `wanted` \[rad/s] for `period` \[s] and makes of what is sensed what can be made.
    pub fn step(&mut self, wanted: Wheels<f64>, period: f64) -> Belief<f64> {
        let sensed = self.world.step(wanted, period);
        let mut travel = self.estimator.ekf().travel(sensed.rims);
        let outcome = self.estimator.roll_by(sensed.stamp, travel);
        if outcome.is_err() {
            // The refusal is in the tally. What was asked of the wheels is a guess at least, as vague as it is long.
            let rims = wanted.scaled(self.world.model().drive.wheel_radius * period);
            travel = Travel { rims, variance: Wheels::new(rims.right * rims.right, rims.left * rims.left) };
            let _counted = self.estimator.roll_by(sensed.stamp, travel);
        }
        let radius = self.world.model().drive.wheel_radius;
        self.watch.rolled(sensed.stamp, travel, outcome);
        self.watch.followed(wanted, travel.rims.scaled(1.0 / (radius * period)));
        self.perception.correct(&mut self.estimator, &sensed, &mut self.watch);
        self.estimator.belief()
    }

    /// The world, with the truth in it.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// Where the robot thinks it is.
    pub fn belief(&self) -> Belief<f64> {
        self.estimator.belief()
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
        self.perception.walls()
    }

    /// What became of the measurements.
    pub fn tally(&self) -> &Tally {
        self.estimator.tally()
    }
}

/// `pose`, as somebody would tell it who knows it with these standard deviations.
fn mistaken(pose: Pose<Map, Body, f64>, std: [f64; 3], seed: Seed) -> Pose<Map, Body, f64> {
    let mut noise = seed.stream("start");
    let [x, y, heading] = std.map(|std| std * noise.normal());
    Pose::new(pose.x + x, pose.y + y, pose.heading.turned(heading))
}
