//! What a driver is told before it flies.

use surepose::estimation::Belief;
use surepose_config::{Config, NavigatorSetup, ScanMethod};
use surepose_io::wall_map::WallMap;

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

impl NodeDriverSettings {
    /// For the robot of `scenario`, which has its map, its start and all sensors.
    #[cfg(feature = "simulate")]
    pub fn in_scenario(scenario: &surepose_sim::robot::Scenario) -> Self {
        Self {
            config: scenario.config.clone(),
            map: Some(surepose_sim::robot::wall_map_from_arena(&scenario.arena)),
            scan_method: scenario.scan_method,
            start: Some(Belief::new(scenario.start(), scenario.start_std)),
            compass: true,
            safety_radius: scenario.config.default_safety_radius(),
            hold: false,
        }
    }

    /// What the navigator is built from.
    pub(super) fn navigator_setup(&self) -> NavigatorSetup {
        NavigatorSetup {
            scan_method: self.scan_method,
            has_laser: self.map.is_some(),
            is_aided: self.compass || self.map.is_some(),
            safety_radius: Some(self.safety_radius),
            hold_goal: self.hold,
        }
    }
}
