//! Builds the navigator from a configuration, for all programs.

use surepose::estimation::Belief;
use surepose::lidar::{BeamModelMatcher, LineAssociator, RangeFinder, ScanModel, ScanProcessor};
use surepose::localization::{AcceptanceCriteria, LocalSearch, Localizer, MonitorConfig};
use surepose::navigator::{Navigator, NavigatorConfig};
use surepose::param;
use surepose::safety::{CollisionConfig, ObstacleConfig, SupervisorConfig};
use surepose::time::Stamp;

use super::Config;

/// Events in the filter's history: over a second of odometry at 50 Hz with headings and walls at 10 Hz.
pub const HISTORY: usize = 128;

/// Largest number of beams of a scan.
pub const MAX_BEAMS: usize = 4096;

/// Localizer of a real or simulated robot.
pub type RobotLocalizer = Localizer<f64, HISTORY, MAX_BEAMS>;

/// Navigator of a real or simulated robot.
pub type RobotNavigator = Navigator<f64, HISTORY, MAX_BEAMS>;

/// Method that matches scans with the map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ScanMethod {
    /// Lines are extracted and associated: for buildings with long flat walls and an exact map.
    #[default]
    Lines,
    /// Every beam is compared with the map: for maps of many short walls, traced from a grid for instance.
    Beams,
}

/// Setup of a navigator that is not in the configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NavigatorSetup {
    /// Method that matches scans with the map.
    pub scan_method: ScanMethod,
    /// Standard deviation of the positions of the map's walls \[m]; 0 for an exact map. See
    /// [`Wall::position_std_of`](surepose::map::Wall::position_std_of).
    pub map_std: f64,
    /// Whether the robot has a laser and a map to compare its scans with.
    pub has_laser: bool,
    /// Whether any sensor but odometry measures the pose.
    pub is_aided: bool,
    /// Distance from the robot's center that stays free of obstacles \[m]. 0 disables the obstacle check; `None` takes
    /// [`Config::default_safety_radius`].
    pub safety_radius: Option<f64>,
    /// Whether a reached pose is held until the next goal.
    pub hold_goal: bool,
}

impl ScanMethod {
    /// Uncertainty of the map that all beams of a scan share, x \[m], y \[m] and heading \[rad]: rounding for exact walls, part
    /// of a cell for walls traced from a grid.
    pub fn map_std(self) -> [f64; 3] {
        match self {
            Self::Lines => [0.002, 0.002, 0.05_f64.to_radians()],
            Self::Beams => [0.03, 0.03, 0.3_f64.to_radians()],
        }
    }

    /// Standard deviations added to a pose from relocalization: x \[m], y \[m], heading \[rad]. They cover correlated
    /// association errors.
    fn relocalization_std(self) -> [f64; 3] {
        match self {
            Self::Lines => [0.0; 3],
            Self::Beams => [0.01, 0.01, 0.0035],
        }
    }

    fn model(self, [position, _, heading]: [f64; 3]) -> ScanModel<f64> {
        match self {
            Self::Lines => ScanModel::Lines(LineAssociator {
                model_variance: [position * position, heading * heading],
                ..LineAssociator::default()
            }),
            Self::Beams => ScanModel::BeamModel(beam_model()),
        }
    }
}

/// Beam model of a robot that takes several scans per second, on a map traced from a grid or a log.
///
/// Association errors are correlated over about four scans, so the standard deviations of an independent scan, 3 cm and
/// 0.3°, are doubled.
pub fn beam_model() -> BeamModelMatcher<f64> {
    BeamModelMatcher { min_hit_ratio: 0.4, scan_std: [0.06, 0.06, 0.6_f64.to_radians()] }
}

/// Shortest range; shorter returns are from the robot itself \[m].
const MIN_RANGE: f64 = 0.05;

/// Longest range; longer returns are discarded \[m].
const MAX_RANGE: f64 = 80.0;

/// Smallest time between two successes of the local search \[s]; a shorter one means a lost robot.
const LOCAL_SEARCH_INTERVAL: f64 = 0.8;

/// Distance between footprint and obstacles that stays free \[m].
const OBSTACLE_CLEARANCE: f64 = 0.08;

impl Config {
    /// Builds the navigator with `belief` at `stamp`.
    pub fn navigator(
        &self,
        setup: &NavigatorSetup,
        stamp: Stamp,
        belief: Belief<f64>,
    ) -> Box<RobotNavigator> {
        on_large_stack(|| {
            let estimator = self.estimator(stamp, belief);
            let estimator = match setup.scan_method {
                // Each line says how well its wall is known.
                ScanMethod::Lines => estimator,
                ScanMethod::Beams => estimator.with_map_std(setup.map_std),
            };
            let scan_processor = self.scan_processor(setup.scan_method);
            let localizer = Localizer::new(estimator, scan_processor, self.monitor(setup));
            Box::new(Navigator::new(self.navigator_config(setup), localizer))
        })
    }

    /// Builds a localizer without supervision, for experiments on the estimate alone.
    pub fn unsupervised_localizer(
        &self,
        scan_method: ScanMethod,
        belief: Belief<f64>,
    ) -> Box<RobotLocalizer> {
        on_large_stack(|| {
            let estimator = self.estimator(Stamp::default(), belief);
            Box::new(Localizer::unsupervised(estimator, self.scan_processor(scan_method)))
        })
    }

    /// Default distance from the robot's center that stays free of obstacles \[m]: the circumscribed radius of the footprint
    /// and 8 cm.
    pub fn default_safety_radius(&self) -> f64 {
        self.footprint().circumscribed_radius() + OBSTACLE_CLEARANCE
    }

    /// Returns the constants of the collision check. `safety_radius` is that of [`NavigatorSetup`].
    pub fn collision(&self, safety_radius: Option<f64>) -> CollisionConfig<f64> {
        let footprint = self.footprint();
        let safety_radius = safety_radius.unwrap_or_else(|| self.default_safety_radius());
        CollisionConfig {
            footprint,
            wall_clearance: self.number(&param::WALL_CLEARANCE),
            obstacle_clearance: (safety_radius - footprint.circumscribed_radius()).max(0.0),
            travel_factor: self.number(&param::TRAVEL_FACTOR),
            response_time: self.number(&param::RESPONSE_TIME),
        }
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
        ScanProcessor::new(laser, scan_method.model(self.scan_model_std()))
    }

    /// Standard deviations of the constant errors of laser and map that a whole scan shares: x \[m], y \[m], heading \[rad].
    fn scan_model_std(&self) -> [f64; 3] {
        let considered = self.considered();
        let position = considered.laser_position.hypot(considered.wall);
        [position, position, considered.laser_heading]
    }

    fn navigator_config(&self, setup: &NavigatorSetup) -> NavigatorConfig<f64> {
        let safety_radius = setup.safety_radius.unwrap_or_else(|| self.default_safety_radius());
        let search_turn_rate = self.number(&param::SEARCH_TURN_RATE);
        NavigatorConfig {
            controller: self.controller(),
            actuator: self.actuator(),
            collision: self.collision(Some(safety_radius)),
            obstacles: ObstacleConfig {
                enabled: setup.has_laser && safety_radius > 0.0,
                scan_timeout: self.number(&param::SCAN_TIMEOUT),
                blind_timeout: self.number(&param::LASER_BLIND_TIMEOUT),
                min_valid_beams: self.number(&param::MIN_VALID_BEAMS),
                ..ObstacleConfig::default()
            },
            search_turn_rate: if setup.has_laser { search_turn_rate } else { 0.0 },
            goal_timeout: self.number(&param::GOAL_TIMEOUT),
            stall_timeout: self.number(&param::STALL_TIMEOUT),
            progress_timeout: self.number(&param::PROGRESS_TIMEOUT),
            hold_goal: setup.hold_goal,
        }
    }

    fn monitor(&self, setup: &NavigatorSetup) -> MonitorConfig<f64> {
        let aiding_timeout = self.number(&param::AIDING_TIMEOUT);
        let [x, y, heading] = self.scan_model_std();
        let shared = [x.hypot(setup.map_std), y.hypot(setup.map_std), heading];
        let with_shared = |std: [f64; 3]| core::array::from_fn(|i| std[i].hypot(shared[i]));
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
            // A robot that turns in place needs clearance for its wheels.
            acceptance: AcceptanceCriteria {
                min_clearance: 0.5 * self.drive().wheel_separation,
                ..AcceptanceCriteria::default()
            },
            local_search: LocalSearch::from_scan_std(with_shared(setup.scan_method.map_std())),
            relocalization_std: with_shared(setup.scan_method.relocalization_std()),
            local_search_interval: LOCAL_SEARCH_INTERVAL,
        }
    }
}

/// Runs `build` on a thread with a stack of 32 MiB.
///
/// Without allocation the core keeps all buffers, half a megabyte, in the value itself, and an unoptimized build copies it
/// several times. If no thread starts, `build` runs on the caller's.
fn on_large_stack<T: Send>(build: impl Fn() -> T + Sync) -> T {
    const STACK: usize = 32 << 20;
    let built = std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().stack_size(STACK).spawn_scoped(scope, &build);
        thread.ok().and_then(|thread| thread.join().ok())
    });
    built.unwrap_or_else(build)
}
