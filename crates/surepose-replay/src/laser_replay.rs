//! Laser replay shared by all formats: odometry predicts, scan matching corrects.

use surepose::estimation::{Belief, DelayedEkf, Ekf, Gate, Measurement, MeasurementOutcome, WheelOdometry};
use surepose::geometry::{Angle, Body, Map, Point, Pose};
use surepose::kinematics::{DiffDrive, Integration, Motion, Twist, WheelPair};
use surepose::lidar::{
    BeamMatch, BeamModelMatcher, BeamStats, LaserGeometry, RangeFinder, Scan, ScanEvent, ScanModel,
    ScanProcessor,
};
use surepose::localization::{
    AcceptanceCriteria, LocalSearch, Localizer, LoopObserver, MonitorConfig, Odometry, SensorInput,
    SensorReading,
};
use surepose::map::{MapView, Wall};
use surepose::param;
use surepose::safety::SupervisorConfig;
use surepose::time::{Stamp, Stamped};
use surepose_config::{Config, beam_model};
use surepose_io::owned_map::OwnedMap;
use surepose_io::recording::{self, laser_extrinsics};

/// Standard deviations of x \[m], y \[m] and θ \[rad] of the error common to all beams of a scan: twice those of a robot.
/// The errors of a map extracted from a log are correlated with those of its scans.
const SCAN_STD: [f64; 3] = [0.12, 0.12, 1.2_f64.to_radians()];

/// Normalized innovation squared of a consistent scan: the quantile 99 % of χ² with 3 degrees of freedom.
const CONSISTENT_NIS: f64 = 11.34;

/// Largest factor on the variance of odometry.
const MAX_NOISE_FACTOR: f64 = 64.0;

/// Maximum number of beams of a scan.
const MAX_BEAMS: usize = 2048;

/// Noise model and scan matching of a replay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LaserReplaySettings {
    /// Wheel separation of the noise model \[m]. For recordings of poses instead of wheels, it only relates
    /// the variance of heading to that of distance.
    pub wheel_separation: f64,
    /// Variance of a rim's travel per meter driven \[m²/m].
    pub rim_variance_per_metre: f64,
    /// Variance of a rim's travel per radian turned \[m²/rad].
    pub rim_variance_per_radian: f64,
    /// Standard deviation of a range \[m].
    pub range_std: f64,
    /// Standard deviation of a bearing \[rad].
    pub bearing_std: f64,
    /// Probability with which a consistent scan passes the gate.
    pub gate_probability: f64,
    /// Beam model of the scans, as a robot uses it on a map traced from a grid or a log.
    pub beam_model: BeamModelMatcher<f64>,
    /// Standard deviations of the start pose: x \[m], y \[m], θ \[rad].
    pub start_std: [f64; 3],
}

impl LaserReplaySettings {
    /// Returns the preset of laser recordings, which the user's values override.
    ///
    /// Odometry has a standard deviation of 12 cm and 12° over one meter, several times its usual error. Logs
    /// have jumps (in belgioioso 0.45 m and 32°), and the laser corrects the pose to centimeters.
    pub fn preset(name: &'static str) -> Config {
        Self::with_rim_variance(name, 0.03)
    }

    /// Returns the preset for this variance of a rim per meter and per radian \[m²].
    pub(super) fn with_rim_variance(name: &'static str, rim_variance: f64) -> Config {
        let values = [
            (&param::WHEEL_SEPARATION, 1.2),
            (&param::RIM_VARIANCE_PER_METER, rim_variance),
            (&param::RIM_VARIANCE_PER_RADIAN, rim_variance),
            (&param::LASER_RANGE_STD, 0.03),
            (&param::LASER_BEARING_STD, 0.3),
        ];
        Config::default().with_preset(name, &values)
    }

    /// Reads the settings of a configuration.
    pub fn from_config(config: &Config) -> Self {
        let number = |parameter| config.number(parameter);
        Self {
            wheel_separation: number(&param::WHEEL_SEPARATION),
            rim_variance_per_metre: number(&param::RIM_VARIANCE_PER_METER),
            rim_variance_per_radian: number(&param::RIM_VARIANCE_PER_RADIAN),
            range_std: number(&param::LASER_RANGE_STD),
            bearing_std: number(&param::LASER_BEARING_STD),
            gate_probability: number(&param::GATE_PROBABILITY),
            beam_model: BeamModelMatcher { scan_std: SCAN_STD, ..beam_model() },
            start_std: [0.02, 0.02, 0.5_f64.to_radians()],
        }
    }
}

impl LaserReplaySettings {
    /// Returns the filter; δ is unused, because each travel comes with its variance.
    pub(super) fn ekf(&self) -> Ekf<f64> {
        let drive = DiffDrive::new(1.0, self.wheel_separation);
        Ekf { drive, delta: 0.0, integration: Integration::Arc }
    }

    /// Converts `motion` to rim travel with the variance of this odometry.
    pub(super) fn wheel_odometry(&self, motion: Motion<f64>) -> WheelOdometry<f64> {
        let rims = self.ekf().drive.wheel_speeds_from_twist(Twist::new(motion.length, motion.turn));
        let variance = self.rim_variance_per_metre * motion.length.abs()
            + self.rim_variance_per_radian * motion.turn.abs();
        WheelOdometry { travel: rims, variance: WheelPair::new(variance, variance) }
    }

    /// Returns the model of the laser that took a scan.
    pub(super) fn laser(&self, mount: recording::SensorPose) -> RangeFinder<f64> {
        RangeFinder {
            body_from_laser: laser_extrinsics(mount),
            range_std: self.range_std,
            bearing_std: self.bearing_std,
            range_min: MIN_RANGE,
            range_max: MAX_RANGE,
        }
    }
}

/// Converts a recorded scan to the core's type.
pub(super) fn scan_view(scan: &recording::ScanRecord) -> Scan<'_, f64> {
    let body_from_laser = laser_extrinsics(scan.mount);
    let geometry = LaserGeometry { body_from_laser, range_min: MIN_RANGE, range_max: MAX_RANGE };
    Scan::new(Angle::from_radians(scan.angle_min), scan.angle_increment, &scan.ranges).with_geometry(geometry)
}

/// Returns the ends of some beams of a scan taken at `pose` \[m].
pub(super) fn beam_ends(scan: &recording::ScanRecord, pose: Pose<Map, Body, f64>) -> Vec<(f64, f64)> {
    let map_from_laser = pose * laser_extrinsics(scan.mount);
    let returns =
        scan.ranges.iter().enumerate().step_by(DRAWN_BEAMS).filter(|(_, range)| **range < MAX_RANGE);
    let end = |(number, range): (usize, &f64)| {
        let (sin, cos) = scan.angle(number).sin_cos();
        let end = map_from_laser * Point::new(range * cos, range * sin);
        (end.x, end.y)
    };
    returns.map(end).collect()
}

/// Every beam of this number is drawn.
const DRAWN_BEAMS: usize = 4;

/// Estimator of a robot with a laser among known walls.
#[derive(Debug)]
pub(super) struct LaserReplay {
    pub(super) localizer: Box<Localizer<f64, 64, MAX_BEAMS>>,
    settings: LaserReplaySettings,
    walls: Vec<Wall<f64>>,
    /// Map of the global search; `None` without supervision.
    map: Option<OwnedMap>,
    /// Factor on the variance of odometry.
    noise_factor: f64,
}

/// Result of processing a scan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum ScanOutcome {
    /// Matched; with the decision of the filter.
    Evaluated(MeasurementOutcome, BeamStats<f64>),
    /// Too few beams are on walls of the map.
    LowOverlap,
    /// No wall of the map is in view.
    NoOverlap,
    /// The scan's time is outside the history; the estimator counts it.
    OutsideHistory,
    /// The scan is malformed.
    Invalid,
}

impl ScanOutcome {
    /// Returns the reason under which a report counts a scan that did not reach the filter; `None` if it did.
    pub(super) fn skip_reason(&self) -> Option<&'static str> {
        match self {
            Self::Evaluated(..) | Self::OutsideHistory => None,
            Self::LowOverlap => Some("unconvincing_scan"),
            Self::NoOverlap => Some("no_wall_in_sight"),
            Self::Invalid => Some("unusable_scan"),
        }
    }
}

/// Fraction of the returns that are on walls.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ScanOverlap {
    sum: f64,
    scans: f64,
}

impl ScanOverlap {
    /// Adds a scan; a scan on no wall adds 0.
    pub(super) fn add(&mut self, seen: &ScanOutcome) {
        self.scans += 1.0;
        if let ScanOutcome::Evaluated(_, stats) = seen {
            self.sum += stats.hit_ratio();
        }
    }

    /// Returns the mean over scans; `None` without scans.
    pub(super) fn mean(self) -> Option<f64> {
        (self.scans > 0.0).then(|| self.sum / self.scans)
    }
}

impl LaserReplay {
    /// Starts at `pose` at `stamp`.
    pub(super) fn new(
        walls: Vec<Wall<f64>>,
        settings: LaserReplaySettings,
        stamp: Stamp,
        pose: Pose<Map, Body, f64>,
    ) -> Self {
        let gate = Gate::new(settings.gate_probability);
        let belief = Belief::new(pose, settings.start_std);
        // Unlimited in time, because some replays count records instead of seconds; the number of events
        // limits it.
        let estimator = DelayedEkf::new(settings.ekf(), gate, f64::INFINITY, stamp, belief);
        // Each scan brings the mounting of its laser.
        let laser = settings.laser(recording::SensorPose::default());
        let scan_processor = ScanProcessor::new(laser, ScanModel::BeamModel(settings.beam_model));
        let localizer = Box::new(Localizer::unsupervised(estimator, scan_processor));
        Self { localizer, settings, walls, map: None, noise_factor: 1.0 }
    }

    /// Starts at `pose` at `stamp`, supervised and with relocalization, for scans about a meter apart.
    pub(super) fn supervised(
        walls: Vec<Wall<f64>>,
        settings: LaserReplaySettings,
        stamp: Stamp,
        pose: Pose<Map, Body, f64>,
    ) -> Self {
        let Self { localizer, settings, walls, .. } = Self::new(walls, settings, stamp, pose);
        let (estimator, scan_processor) = (*localizer.estimator(), localizer.scan_processor().clone());
        let map = Some(OwnedMap::from_walls(walls.clone()));
        let localizer = Localizer::new(estimator, scan_processor, sparse_monitor(&settings));
        Self { localizer: Box::new(localizer), settings, walls, map, noise_factor: 1.0 }
    }

    /// Replaces the map.
    pub(super) fn set_map(&mut self, walls: Vec<Wall<f64>>) {
        self.walls = walls;
    }

    /// Predicts by `motion` until `stamp`.
    pub(super) fn predict(&mut self, stamp: Stamp, motion: Motion<f64>) {
        // The report includes rejections from the estimator's statistics.
        self.roll(stamp, self.settings.wheel_odometry(motion));
    }

    fn roll(&mut self, stamp: Stamp, mut travel: WheelOdometry<f64>) {
        travel.variance = travel.variance.scaled(self.noise_factor);
        let input = SensorInput { stamp, odometry: Odometry::WithVariance(travel), readings: &[] };
        self.localizer.update(&input, travel, &MapView::empty(), &mut ());
    }

    /// Predicts by `motion` over a gap, in whose time the robot may have moved by `unseen` in addition.
    pub(super) fn predict_over_gap(&mut self, stamp: Stamp, motion: Motion<f64>, unseen: Motion<f64>) {
        let mut travel = self.settings.wheel_odometry(motion);
        let additional = self.settings.wheel_odometry(unseen).variance;
        travel.variance =
            WheelPair::new(travel.variance.right + additional.right, travel.variance.left + additional.left);
        self.roll(stamp, travel);
    }

    /// Beam model of the next scan.
    pub(super) fn beam_model(&self) -> BeamModelMatcher<f64> {
        self.settings.beam_model
    }

    /// Walls of the map.
    pub(super) fn walls(&self) -> &[Wall<f64>] {
        &self.walls
    }

    /// Adapts the odometry noise to the innovation of a scan, within [`MAX_NOISE_FACTOR`].
    ///
    /// An innovation beyond the 99 % quantile of χ² with 3 degrees of freedom, or a contradicting scan, doubles the standard
    /// deviation; a consistent one reduces it again.
    pub(super) fn adapt_odometry_noise(&mut self, seen: &ScanOutcome) {
        let is_consistent = match seen {
            ScanOutcome::Evaluated(MeasurementOutcome::Accepted { nis }, _) => *nis < CONSISTENT_NIS,
            _ => false,
        };
        let change = if is_consistent { 0.7 } else { 4.0 };
        self.noise_factor = (self.noise_factor * change).clamp(1.0, MAX_NOISE_FACTOR);
    }

    /// Predicts by `motion` of one record until `stamp`, of which a part with the standard deviation `timing_std` belongs to
    /// the other side of a scan.
    pub(super) fn predict_with_timing(&mut self, stamp: Stamp, motion: Motion<f64>, timing_std: f64) {
        let mut travel = self.settings.wheel_odometry(motion);
        let moved = [motion.length, motion.turn * self.settings.wheel_separation * 0.5];
        // The length is the mean of both rims, the turn their difference.
        let variance = moved.iter().map(|moved| 2.0 * (moved * timing_std).powi(2)).sum::<f64>();
        travel.variance = WheelPair::new(travel.variance.right + variance, travel.variance.left + variance);
        self.roll(stamp, travel);
    }

    /// Corrects the belief by a scan taken at `stamp`.
    pub(super) fn correct(&mut self, stamp: Stamp, scan: &recording::ScanRecord) -> ScanOutcome {
        let is_remembered = self.localizer.estimator().belief_at(stamp).is_some();
        let mut last_scan = LastScan::default();
        self.localizer.process(
            &Stamped::new(stamp, SensorReading::Scan(scan_view(scan))),
            &self.map.as_ref().map_or_else(|| MapView::from_walls(&self.walls), OwnedMap::view),
            &mut last_scan,
        );
        match (last_scan.beam_match, last_scan.outcome) {
            (None, _) if !is_remembered => ScanOutcome::OutsideHistory,
            (None, _) => ScanOutcome::Invalid,
            (Some(BeamMatch { stats, .. }), _) if stats.hits == 0 => ScanOutcome::NoOverlap,
            (Some(BeamMatch { stats, .. }), Some(outcome)) => ScanOutcome::Evaluated(outcome, stats),
            (Some(_), None) => ScanOutcome::LowOverlap,
        }
    }
}

/// Largest mean of the normalized innovation squared per row, of a map extracted from a log.
const MAX_MEAN_NIS: f64 = 20.0;

/// Monitor for scans that are seconds and about a meter apart, where the clock may count records instead of seconds.
///
/// Two scans against the map make the robot lost, and two explained by one pose alone find it again, because each shows another
/// part of the map. Time-outs are off.
fn sparse_monitor(settings: &LaserReplaySettings) -> MonitorConfig<f64> {
    let scan_std = settings.beam_model.scan_std;
    MonitorConfig {
        supervisor: SupervisorConfig {
            odometry_timeout: f64::INFINITY,
            aiding_timeout: f64::INFINITY,
            max_wheel_rate_error: f64::INFINITY,
            slow_std: f64::INFINITY,
            stop_std: f64::INFINITY,
            min_hit_ratio: settings.beam_model.min_hit_ratio,
            max_behind_wall_ratio: 0.5,
            max_mean_nis: MAX_MEAN_NIS,
            max_scan_excess: 2,
            max_outlier_excess: 2,
            ..SupervisorConfig::default()
        },
        acceptance: AcceptanceCriteria { min_scans: 2, min_rotation: 0.0, ..AcceptanceCriteria::default() },
        local_search: LocalSearch::from_scan_std(scan_std),
        relocalization_std: scan_std,
        local_search_interval: 0.0,
    }
}

/// Result of the last scan.
#[derive(Default)]
struct LastScan {
    outcome: Option<MeasurementOutcome>,
    beam_match: Option<BeamMatch<f64>>,
}

impl LoopObserver<f64> for LastScan {
    fn on_measurement(&mut self, _: &Stamped<Measurement<f64>>, outcome: MeasurementOutcome) {
        self.outcome = Some(outcome);
    }

    fn on_scan(&mut self, event: &ScanEvent<'_, f64>) {
        self.beam_match = event.observation.beam_match;
    }
}

/// Minimum range \[m]; nearer returns are from the robot itself.
pub(super) const MIN_RANGE: f64 = 0.02;

/// Maximum range \[m]; beyond, a heading error of 1° moves a return by more than 0.5 m.
pub(super) const MAX_RANGE: f64 = 30.0;
