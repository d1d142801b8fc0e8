//! The supervisor at work: it hears of everything, and looks for the robot when that is lost.

use surepose::closed_loop::{LoopObserver, ScanEvent};
use surepose::{
    AcceptanceCriteria, BeamStats, BeamSubset, Belief, DelayedEkf, DiffDrive, GlobalLocalizer, GlobalStatus,
    Health, Hypothesis, LocalSearch, Measurement, MeasurementOutcome, MissedReturns, RejectReason,
    SafetyAction, Stamp, Stamped, Supervisor, SupervisorConfig, Wall, WheelOdometry, WheelPair, param,
};
use surepose_config::Config;

use super::scenario::ScanMethod;
use crate::distance_field::OwnedDistanceField;

/// Beams of a scan that are held against the map.
const BEAMS: usize = 128;

/// How fast a lost robot turns in place to see more \[rad/s].
pub const SEARCH_RATE: f64 = 0.8;

/// The most hypotheses.
const HYPOTHESES: usize = 24;

/// The supervisor, and the global localizer for when it is needed.
#[derive(Clone, Debug)]
pub struct LocalizationMonitor {
    supervisor: Supervisor<f64>,
    global_localizer: Box<GlobalLocalizer<f64, HYPOTHESES>>,
    distance_field: OwnedDistanceField,
    local_search: LocalSearch<f64>,
    /// When the robot was last found to have been pushed a little.
    displaced: Option<Stamp>,
    scan_method: ScanMethod,
    drive: DiffDrive<f64>,
    period: f64,
    /// Whether the global localizer is at work.
    searching: bool,
    /// How often what a scan told was used.
    laser_updates: u32,
}

/// How far off a pose is that was found on a map of short walls, besides what its covariance says: x, y \[m] and
/// heading \[rad].
const SHORT_WALLS_STD: [f64; 3] = [0.01, 0.01, 0.0035];

/// A push that was found out in less time \[s] after the last one was none: six scans, and a few that agree by chance.
const MIN_NUDGE_INTERVAL: f64 = 0.8;

/// How well a map is known where scans are read so, x, y \[m] and heading \[rad]: exactly but for rounding, or to a cell.
fn map_std(scan_method: ScanMethod) -> [f64; 3] {
    match scan_method {
        ScanMethod::Lines => [0.002, 0.002, 0.05_f64.to_radians()],
        ScanMethod::Beams => [0.03, 0.03, 0.3_f64.to_radians()],
    }
}

impl LocalizationMonitor {
    /// The monitor over a robot that starts at `stamp` among `walls`; `aided` where it has sensors that see where it is.
    pub fn new(
        config: &Config,
        aided: bool,
        scan_method: ScanMethod,
        walls: &[Wall<f64>],
        stamp: Stamp,
    ) -> Self {
        let usual = SupervisorConfig::default();
        let limits = SupervisorConfig {
            aiding_timeout: if aided { usual.aiding_timeout } else { f64::INFINITY },
            ..usual
        };
        // A robot that has turned in place has room for its wheels.
        let criteria = AcceptanceCriteria {
            min_clearance: 0.5 * config.drive().wheel_separation,
            ..AcceptanceCriteria::default()
        };
        let global_localizer = GlobalLocalizer::new(config.ekf(), criteria, stamp);
        Self {
            supervisor: Supervisor::new(limits, stamp),
            global_localizer: Box::new(global_localizer),
            distance_field: OwnedDistanceField::from_walls(walls),
            local_search: LocalSearch::from_scan_std(map_std(scan_method)),
            displaced: None,
            scan_method,
            drive: config.drive(),
            period: config.number(&param::PERIOD),
            searching: false,
            laser_updates: 0,
        }
    }

    /// How often a wall in a scan, or a whole scan, corrected the estimate.
    pub fn laser_updates(&self) -> u32 {
        self.laser_updates
    }

    /// What the wheels may do.
    pub fn action(&self, now: Stamp, belief: &Belief<f64>) -> SafetyAction {
        self.supervisor.action(now, belief)
    }

    /// How far the estimate can be trusted.
    pub fn health(&self, now: Stamp, belief: &Belief<f64>) -> Health {
        self.supervisor.health(now, belief)
    }

    /// The poses that the robot may have, while it is lost.
    pub fn hypotheses(&self) -> impl Iterator<Item = &Hypothesis<f64>> {
        self.global_localizer.hypotheses().filter(|_| self.searching)
    }

    /// Nothing is known of the pose from `now` on.
    pub fn lose(&mut self, now: Stamp) {
        self.supervisor.mark_lost();
        self.search(now);
    }

    fn search(&mut self, now: Stamp) {
        self.searching = true;
        self.global_localizer.reset(now);
    }

    /// The pose that was found, as sure as the map lets it be.
    fn inflated(&self, found: Belief<f64>) -> Belief<f64> {
        match self.scan_method {
            ScanMethod::Lines => found,
            // Beams given to the wrong one of two steps in a wall are so together.
            ScanMethod::Beams => {
                let std = [0, 1, 2].map(|i| found.covariance.std(i).hypot(SHORT_WALLS_STD[i]));
                Belief::new(found.pose, std)
            }
        }
    }

    fn localize_globally<const N: usize>(
        &mut self,
        estimator: &mut DelayedEkf<f64, N>,
        event: &ScanEvent<'_, f64>,
    ) {
        let ScanEvent { stamp, laser, scan, observation, walls } = *event;
        let (lines, field) = (observation.extracted.lines, self.distance_field.field());
        let found = self.global_localizer.update(stamp, laser, scan, lines, walls, field.as_ref());
        if let GlobalStatus::Localized(belief) = found {
            estimator.reset_at(self.global_localizer.stamp(), self.inflated(belief));
            self.supervisor.on_relocalized(estimator.stamp());
            self.searching = false;
        }
    }
}

impl<const N: usize> LoopObserver<f64, N> for LocalizationMonitor {
    fn on_odometry(
        &mut self,
        stamp: Stamp,
        commanded: WheelPair<f64>,
        travel: WheelOdometry<f64>,
        outcome: Result<(), RejectReason>,
    ) {
        self.supervisor.on_odometry(stamp, outcome);
        let rates = |rims| self.drive.wheel_angle_from_travel(rims).scaled(1.0 / self.period);
        self.supervisor.on_wheel_speeds(rates(commanded), rates(travel.travel));
        if self.searching {
            self.global_localizer.on_odometry(stamp, travel);
        }
    }

    fn on_measurement(&mut self, measurement: &Stamped<Measurement<f64>>, outcome: MeasurementOutcome) {
        self.supervisor.on_measurement(measurement.stamp, outcome, measurement.value.dimension());
        if let (Measurement::Line(_) | Measurement::Pose(_), MeasurementOutcome::Accepted { .. }) =
            (measurement.value, outcome)
        {
            self.laser_updates = self.laser_updates.saturating_add(1);
        }
        if let Measurement::Heading(heading) = measurement.value
            && self.searching
        {
            self.global_localizer.set_heading(Stamped::new(measurement.stamp, heading));
        }
    }

    /// Does the map explain the scan? If the robot is lost, where is it?
    fn on_scan(&mut self, estimator: &mut DelayedEkf<f64, N>, event: &ScanEvent<'_, f64>) {
        let Some(then) = estimator.belief_at(event.stamp) else { return };
        let Ok(beams) = BeamSubset::<f64, BEAMS>::from_scan(event.laser, event.scan) else { return };
        let Ok(missed) = MissedReturns::<f64, BEAMS>::from_scan(event.laser, event.scan) else { return };
        let (stats, nis) = self.local_search.evaluate(estimator.ekf(), &beams, &then, event.walls);
        let stats = BeamStats { missed_returns: missed.count(&then, event.walls), ..stats };
        self.supervisor.on_scan(&stats, nis);
        let now = estimator.stamp();
        if self.health(now, &estimator.belief()) != Health::Lost {
            return;
        }
        let is_displaced = !self.searching
            && !self.supervisor.contradicts_map(&stats)
            && self.displaced.is_none_or(|last| now.since(last) > MIN_NUDGE_INTERVAL);
        if is_displaced
            && let Some(found) = self.local_search.refine(estimator.ekf(), &beams, &then, event.walls)
        {
            estimator.reset_at(event.stamp, self.inflated(found));
            self.supervisor.on_relocalized(now);
            self.displaced = Some(now);
            return;
        }
        if !self.searching {
            self.search(now);
        }
        self.localize_globally(estimator, event);
    }
}
