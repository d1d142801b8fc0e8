//! Settings of the driver.

use surepose::estimation::Belief;
use surepose::geometry::Pose;
use surepose::map::Wall;
use surepose::time::Stamp;
use surepose_config::{Config, NavigatorSetup, ScanMethod};
use surepose_io::wall_map::{WallMap, walls_from_map};
use surepose_recorder::Session;

/// Uncertainty of a configured start pose: standard deviations of x, y \[m] and heading \[rad].
pub const START_STD: [f64; 3] = [0.1, 0.1, 0.1];

/// Configures a driver.
#[derive(Clone, Debug)]
pub struct NodeDriverSettings {
    /// Configuration of robot, control law and filter.
    pub config: Config,
    /// Wall map; `None` starts the map frame at the first odometry pose.
    pub map: Option<WallMap>,
    /// Method that matches scans with the map.
    pub scan_method: ScanMethod,
    /// Initial belief; `None` with a map starts global localization.
    pub start: Option<Belief<f64>>,
    /// Whether the driver uses headings of a compass.
    pub compass: bool,
    /// Whether the yaw rate of a gyroscope is used.
    pub gyroscope: bool,
    /// Distance from the path of the robot's center at which unmapped obstacles stop it \[m]; 0 disables the check.
    pub safety_radius: f64,
    /// Whether the robot holds a reached goal pose until the next goal or a cancel.
    pub hold: bool,
}

impl NodeDriverSettings {
    /// Creates the settings for the robot of `scenario`, with its map, its start and all sensors.
    #[cfg(feature = "simulate")]
    pub fn in_scenario(scenario: &surepose_sim::robot::Scenario) -> Self {
        Self {
            config: scenario.config.clone(),
            map: Some(surepose_sim::robot::wall_map_from_arena(&scenario.arena)),
            scan_method: scenario.scan_method,
            start: Some(Belief::new(scenario.start(), scenario.start_std)),
            compass: true,
            gyroscope: false,
            safety_radius: scenario.config.default_safety_radius(),
            hold: false,
        }
    }

    /// Session of a recording of the driver.
    pub fn session(&self) -> Session {
        let config = self.config.clone();
        Session::new(config, self.navigator_setup(), self.map.clone(), Stamp::default(), self.belief())
    }

    /// Belief before the first odometry; the origin, where the start is unknown.
    pub(super) fn belief(&self) -> Belief<f64> {
        self.start.unwrap_or(Belief::new(Pose::identity(), [0.0; 3]))
    }

    /// Whether messages of an inertial measurement unit are used.
    pub(crate) fn hears_imu(&self) -> bool {
        self.compass || self.gyroscope
    }

    /// Setup of the navigator.
    pub(super) fn navigator_setup(&self) -> NavigatorSetup {
        NavigatorSetup {
            scan_method: self.scan_method,
            map_std: self.map.as_ref().map_or(0.0, |map| Wall::position_std_of(&walls_from_map(map))),
            has_laser: self.map.is_some(),
            is_aided: self.compass || self.map.is_some(),
            safety_radius: Some(self.safety_radius),
            hold_goal: self.hold,
        }
    }
}
