//! The navigator from a configuration: the one place, so that every program runs the same step.

use surepose::estimation::Belief;
use surepose::lidar::{BeamModelMatcher, LineAssociator, RangeFinder, ScanModel, ScanProcessor};
use surepose::localization::{AcceptanceCriteria, LocalSearch, Localizer, MonitorConfig};
use surepose::navigator::{Navigator, NavigatorConfig};
use surepose::param;
use surepose::safety::{CollisionConfig, Footprint, ObstacleConfig, SupervisorConfig};
use surepose::time::Stamp;

use super::Config;

/// Events that the filter remembers: over a second of odometry at 50 Hz with headings and walls at 10 Hz.
pub const HISTORY: usize = 128;

/// The largest number of beams of a scan.
pub const MAX_BEAMS: usize = 4096;

/// Localizer of a robot or of the simulated one.
pub type RobotLocalizer = Localizer<f64, HISTORY, MAX_BEAMS>;

/// Navigator of a robot or of the simulated one.
pub type RobotNavigator = Navigator<f64, HISTORY, MAX_BEAMS>;

/// How scans are compared with the map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ScanMethod {
    /// Lines are extracted and associated: for places with long flat walls and a map that has them exactly.
    #[default]
    Lines,
    /// Every beam is compared with the map: for maps of many short walls, traced from a grid for instance.
    Beams,
}

/// What of a navigator is known only where it is built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NavigatorSetup {
    /// How scans are compared with the map.
    pub scan_method: ScanMethod,
    /// Whether the robot has a laser and a map to compare its scans with.
    pub has_laser: bool,
    /// Whether any sensor but odometry measures the pose.
    pub is_aided: bool,
    /// Distance from the robot's middle that stays free of obstacles \[m]. 0 disables the obstacle check; `None` takes
    /// half the wheel separation and 10 cm.
    pub safety_radius: Option<f64>,
    /// Whether a reached pose is held until the next goal.
    pub hold_goal: bool,
}

impl ScanMethod {
    /// Uncertainty of the map that all beams of a scan share, x \[m], y \[m] and heading \[rad]: rounding for exact walls, part
    /// of a cell for walls traced from a grid.
    fn map_std(self) -> [f64; 3] {
        match self {
            Self::Lines => [0.002, 0.002, 0.05_f64.to_radians()],
            Self::Beams => [0.03, 0.03, 0.3_f64.to_radians()],
        }
    }

    /// What a pose that was found is uncertain by beyond its covariance: beams that are given to the wrong one of two steps
    /// in a wall are so together.
    fn relocalization_std(self) -> [f64; 3] {
        match self {
            Self::Lines => [0.0; 3],
            Self::Beams => [0.01, 0.01, 0.0035],
        }
    }

    fn model(self) -> ScanModel<f64> {
        match self {
            Self::Lines => ScanModel::Lines(LineAssociator::default()),
            // What puts one scan off, a beam given to the wrong of two walls a cell apart, puts the next ones off as well: of a
            // scan by itself 3 cm and 0.3° would do, and four in a row count as one.
            Self::Beams => ScanModel::BeamModel(BeamModelMatcher {
                min_hit_ratio: 0.4,
                scan_std: [0.06, 0.06, 0.6_f64.to_radians()],
            }),
        }
    }
}

/// Nearer returns are the robot's own \[m].
const MIN_RANGE: f64 = 0.05;

/// Farther returns are discarded \[m].
const MAX_RANGE: f64 = 80.0;

/// A second success of the local search within this time \[s] means a lost robot: six scans, and a few that agree by chance.
const LOCAL_SEARCH_INTERVAL: f64 = 0.8;

/// Distance beyond half the wheel separation that stays free of obstacles \[m].
const OBSTACLE_CLEARANCE: f64 = 0.1;

impl Config {
    /// The navigator of a robot, with `belief` at `stamp`.
    pub fn navigator(
        &self,
        setup: &NavigatorSetup,
        stamp: Stamp,
        belief: Belief<f64>,
    ) -> Box<RobotNavigator> {
        let estimator = self.estimator(stamp, belief);
        let scan_processor = self.scan_processor(setup.scan_method);
        let localizer = Localizer::new(estimator, scan_processor, self.monitor(setup));
        Box::new(Navigator::new(self.navigator_config(setup), localizer))
    }

    /// The localizer of a robot without supervision: for experiments that judge the estimate alone.
    pub fn unsupervised_localizer(
        &self,
        scan_method: ScanMethod,
        belief: Belief<f64>,
    ) -> Box<RobotLocalizer> {
        let estimator = self.estimator(Stamp::default(), belief);
        Box::new(Localizer::unsupervised(estimator, self.scan_processor(scan_method)))
    }

    /// Distance from the robot's middle that stays free of obstacles unless it is given \[m].
    pub fn default_safety_radius(&self) -> f64 {
        0.5 * self.drive().wheel_separation + OBSTACLE_CLEARANCE
    }

    fn scan_processor(&self, scan_method: ScanMethod) -> ScanProcessor<f64, MAX_BEAMS> {
        let laser = self.laser();
        let laser = RangeFinder {
            body_from_laser: laser.body_from_laser,
            range_std: laser.range_std,
            bearing_std: laser.bearing_std,
            range_min: MIN_RANGE,
            range_max: MAX_RANGE,
        };
        ScanProcessor::new(laser, scan_method.model())
    }

    fn navigator_config(&self, setup: &NavigatorSetup) -> NavigatorConfig<f64> {
        let footprint_radius = self.number(&param::FOOTPRINT_RADIUS);
        let safety_radius = setup.safety_radius.unwrap_or_else(|| self.default_safety_radius());
        let search_turn_rate = self.number(&param::SEARCH_TURN_RATE);
        NavigatorConfig {
            controller: self.controller(),
            collision: CollisionConfig {
                footprint: Footprint::Circle(footprint_radius),
                wall_clearance: self.number(&param::WALL_CLEARANCE),
                obstacle_clearance: (safety_radius - footprint_radius).max(0.0),
                travel_factor: self.number(&param::TRAVEL_FACTOR),
                response_time: self.number(&param::RESPONSE_TIME),
            },
            obstacles: ObstacleConfig {
                enabled: setup.has_laser && safety_radius > 0.0,
                scan_timeout: self.number(&param::SCAN_TIMEOUT),
                ..ObstacleConfig::default()
            },
            search_turn_rate: if setup.has_laser { search_turn_rate } else { 0.0 },
            goal_timeout: self.number(&param::GOAL_TIMEOUT),
            hold_goal: setup.hold_goal,
        }
    }

    fn monitor(&self, setup: &NavigatorSetup) -> MonitorConfig<f64> {
        let aiding_timeout = self.number(&param::AIDING_TIMEOUT);
        MonitorConfig {
            supervisor: SupervisorConfig {
                odometry_timeout: self.number(&param::ODOMETRY_TIMEOUT),
                aiding_timeout: if setup.is_aided { aiding_timeout } else { f64::INFINITY },
                min_hit_ratio: self.number(&param::MIN_HIT_RATIO),
                max_behind_wall_ratio: self.number(&param::MAX_BEHIND_WALL_RATIO),
                max_mean_nis: self.number(&param::MAX_MEAN_NIS),
                max_wheel_rate_error: self.number(&param::MAX_WHEEL_RATE_ERROR),
                slow_std: self.number(&param::SLOW_STD),
                stop_std: self.number(&param::STOP_STD),
                ..SupervisorConfig::default()
            },
            // A robot that has turned in place has room for its wheels.
            acceptance: AcceptanceCriteria {
                min_clearance: 0.5 * self.drive().wheel_separation,
                ..AcceptanceCriteria::default()
            },
            local_search: LocalSearch::from_scan_std(setup.scan_method.map_std()),
            relocalization_std: setup.scan_method.relocalization_std(),
            local_search_interval: LOCAL_SEARCH_INTERVAL,
        }
    }
}
