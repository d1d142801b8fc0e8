//! What a driver is told before it flies.

use surepose::Belief;
use surepose_config::Config;
use surepose_io::wall_map::WallMap;
use surepose_sim::robot::{ScanMethod, Scenario, wall_map_from_arena};

/// How well a start that somebody named is known: standard deviations of x, y \[m] and heading \[rad].
pub const START_STD: [f64; 3] = [0.1, 0.1, 0.1];

/// What the driver flies by.
#[derive(Clone, Debug)]
pub struct NodeDriverSettings {
    /// The robot, its law and its filter.
    pub config: Config,
    /// The walls, where they are known; without them the map is what odometry starts in.
    pub map: Option<WallMap>,
    /// How scans are laid on them.
    pub scan_method: ScanMethod,
    /// Where the robot starts and how well that is known; without it, and with walls, it looks for itself.
    pub start: Option<Belief<f64>>,
    /// Whether it hears a compass.
    pub compass: bool,
    /// The robot stops before what its laser sees, and no map knows, so near to the way of its middle \[m]; 0 for not at all.
    pub safety_radius: f64,
    /// Whether a pose that was reached is held, and taken up again after a push, until another goal or a cancel.
    pub hold: bool,
}

/// More room than half the track \[m].
const SAFETY_MARGIN: f64 = 0.1;

impl NodeDriverSettings {
    /// For the robot of `scenario`: it knows the arena and the start, and has all senses.
    pub fn in_scenario(scenario: &Scenario) -> Self {
        Self {
            config: scenario.config.clone(),
            map: Some(wall_map_from_arena(&scenario.arena)),
            scan_method: scenario.scan_method,
            start: Some(Belief::new(scenario.start(), scenario.start_std)),
            compass: true,
            safety_radius: Self::default_safety_radius(&scenario.config),
            hold: false,
        }
    }

    /// The room that a robot's middle needs unless somebody says otherwise: half the track, and 10 cm \[m].
    pub fn default_safety_radius(config: &Config) -> f64 {
        0.5 * config.drive().wheel_separation + SAFETY_MARGIN
    }
}
