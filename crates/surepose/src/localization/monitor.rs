//! Supervision of the estimate, and relocalization of a displaced or lost robot.
//!
//! [`LocalizationMonitor`] combines the [`Supervisor`], which evaluates the estimate, with two searches that correct
//! it: [`LocalSearch`] for a displaced robot and [`GlobalLocalizer`] for a lost one.

use crate::estimation::{
    Belief, DelayedEkf, Ekf, Measurement, MeasurementOutcome, OdometryOutcome, WheelOdometry,
};
use crate::kinematics::{DiffDrive, WheelPair};
use crate::lidar::{BeamStats, BeamSubset, MissedReturns, ScanEvent};
use crate::map::MapView;
use crate::safety::{Health, SafetyAction, Supervisor, SupervisorConfig};
use crate::scalar::Float;
use crate::time::{Stamp, Stamped};

use super::global_localizer::{AcceptanceCriteria, GlobalLocalizer, GlobalStatus, Hypothesis};
use super::local_search::LocalSearch;
use super::slip_monitor::SlipMonitor;

/// Maximum number of beams of a scan that are compared with the map.
const BEAMS: usize = 128;

/// Normalized innovation squared per row of a scan above which wheels may have slipped: the quantile 1 − 10⁻⁶ of χ² with 3
/// rows.
const SLIP_NIS: f64 = 30.7 / 3.0;

/// Configuration of the monitor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MonitorConfig<S> {
    /// Thresholds of the supervisor.
    pub supervisor: SupervisorConfig<S>,
    /// Criteria for accepting a pose of the global search.
    pub acceptance: AcceptanceCriteria<S>,
    /// Parameters of the local search.
    pub local_search: LocalSearch<S>,
    /// Standard deviations of x \[m], y \[m] and θ \[rad] added to the covariance of a relocalized pose: the
    /// uncertainty of the map beyond beam noise. 0 adds nothing.
    pub relocalization_std: [S; 3],
    /// Minimum time between two successes of the local search \[s]. A second success within it declares the robot lost.
    pub local_search_interval: f64,
}

impl<S: Float> Default for MonitorConfig<S> {
    /// Configuration for a map that is exact up to rounding, and sensors at 10 Hz.
    fn default() -> Self {
        let scan_std = [0.002, 0.002, 0.000_872_664_626].map(S::from_f64);
        Self {
            supervisor: SupervisorConfig::default(),
            acceptance: AcceptanceCriteria::default(),
            local_search: LocalSearch::from_scan_std(scan_std),
            relocalization_std: [S::from_f64(0.0); 3],
            local_search_interval: 0.8,
        }
    }
}

/// Supervisor and relocalization of one robot.
///
/// `HYPOTHESES` and `KEYFRAMES` are the capacities of the global search.
#[derive(Clone, Debug)]
pub struct LocalizationMonitor<S, const HYPOTHESES: usize, const KEYFRAMES: usize> {
    config: MonitorConfig<S>,
    drive: DiffDrive<S>,
    supervisor: Supervisor<S>,
    global: GlobalLocalizer<S, HYPOTHESES, KEYFRAMES>,
    slip: SlipMonitor<S>,
    is_searching: bool,
    /// Time of the last success of the local search.
    last_push: Option<Stamp>,
    scan_updates: u32,
}

impl<S: Float, const HYPOTHESES: usize, const KEYFRAMES: usize>
    LocalizationMonitor<S, HYPOTHESES, KEYFRAMES>
{
    /// Monitor of an estimate that is trusted at `stamp`.
    pub fn new(config: MonitorConfig<S>, ekf: Ekf<S>, stamp: Stamp) -> Self {
        Self {
            config,
            drive: ekf.drive,
            supervisor: Supervisor::new(config.supervisor, stamp),
            global: GlobalLocalizer::new(ekf, config.acceptance, stamp),
            slip: SlipMonitor::new(),
            is_searching: false,
            last_push: None,
            scan_updates: 0,
        }
    }

    /// Trusts the estimate from `stamp` on and clears the history.
    pub fn reset(&mut self, stamp: Stamp) {
        self.supervisor = Supervisor::new(self.config.supervisor, stamp);
        self.slip = SlipMonitor::new();
        self.is_searching = false;
        self.last_push = None;
    }

    /// Declares the robot lost and starts the global search.
    pub fn mark_lost(&mut self, now: Stamp) {
        self.supervisor.mark_lost();
        self.is_searching = true;
        self.global.reset(now);
    }

    /// Quality of the estimate, and the safety action for the wheels.
    pub fn judge(&self, now: Stamp, belief: &Belief<S>) -> (Health, SafetyAction) {
        self.supervisor.judge(now, belief)
    }

    /// Candidate poses of a lost robot; empty while the robot is not lost.
    pub fn hypotheses(&self) -> impl Iterator<Item = &Hypothesis<S>> {
        self.global.hypotheses().filter(|_| self.is_searching)
    }

    /// Relative standard deviation of odometry that slip adds at `stamp`.
    pub(super) fn slip_std(&self, stamp: Stamp) -> S {
        self.slip.relative_std(stamp)
    }

    /// Number of accepted corrections by scans: lines, or whole scans.
    pub fn scan_updates(&self) -> u32 {
        self.scan_updates
    }

    /// Processes an odometry interval that ends at `stamp`: commanded wheel travel \[m], odometry in use, and the
    /// outcome of the measured odometry.
    pub(super) fn on_odometry(
        &mut self,
        stamp: Stamp,
        elapsed: f64,
        commanded: WheelPair<S>,
        odometry: WheelOdometry<S>,
        outcome: OdometryOutcome,
    ) {
        self.supervisor.on_odometry(stamp, outcome == OdometryOutcome::Used);
        if elapsed > 0.0 {
            let rates =
                |travel| self.drive.wheel_angle_from_travel(travel).scaled(S::from_f64(1.0 / elapsed));
            self.supervisor.on_wheel_speeds(rates(commanded), rates(odometry.travel));
        }
        self.slip.on_odometry(self.drive.motion_from_travel(odometry.travel));
        if self.is_searching {
            self.global.on_odometry(stamp, odometry);
        }
    }

    /// Processes a measurement and its outcome.
    pub(super) fn on_measurement(&mut self, measured: &Stamped<Measurement<S>>, outcome: MeasurementOutcome) {
        self.supervisor.on_measurement(measured.stamp, outcome, measured.value.dimension());
        let is_scan = matches!(measured.value, Measurement::Line(_) | Measurement::Pose(_));
        if is_scan && matches!(outcome, MeasurementOutcome::Accepted { .. }) {
            self.scan_updates = self.scan_updates.saturating_add(1);
        }
        match measured.value {
            Measurement::Heading(heading) if self.is_searching => {
                self.global.set_heading(Stamped::new(measured.stamp, heading));
            }
            _ => {}
        }
    }

    /// Compares a scan with the map, and relocalizes a displaced or lost robot.
    pub(super) fn on_scan<const N: usize>(
        &mut self,
        estimator: &mut DelayedEkf<S, N>,
        event: &ScanEvent<'_, S>,
    ) {
        let ScanEvent { stamp, laser, scan, belief, map, .. } = event;
        let Ok(beams) = BeamSubset::<S, BEAMS>::from_scan(laser, scan) else { return };
        let Ok(missed) = MissedReturns::<S, BEAMS>::from_scan(laser, scan) else { return };
        let search = &self.config.local_search;
        let (stats, scan_nis) = search.evaluate(estimator.ekf(), &beams, belief, map.walls);
        let stats = BeamStats { missed_returns: missed.count(belief, map.walls), ..stats };
        self.supervisor.on_scan(&stats, scan_nis);
        let now = estimator.stamp();
        // Clutter and slip look alike; the search tells them apart, because it finds no better pose among clutter.
        if scan_nis < S::from_f64(SLIP_NIS) && self.supervisor.agrees_with_map(&stats) {
            self.slip.on_agreement();
        } else if let Some(found) = self.search_after_slip(estimator.ekf(), &beams, belief, map) {
            estimator.reset_at(*stamp, self.with_map_uncertainty(found));
            self.supervisor.on_relocalized(now);
            self.slip.on_slip(now);
            return;
        } else if scan_nis >= S::from_f64(SLIP_NIS) {
            // The displacement may be too small for the search, or too fast: odometry counts less, and scans correct it.
            self.slip.on_suspicion(now);
        }
        if self.supervisor.health(now, &estimator.belief()) != Health::Lost {
            return;
        }
        let may_be_pushed = !self.is_searching
            && self.supervisor.agrees_with_map(&stats)
            && self.last_push.is_none_or(|last| now.since(last) > self.config.local_search_interval);
        let refine = || search.refine(estimator.ekf(), &beams, belief, map.walls);
        let found = if may_be_pushed { refine() } else { None };
        if let Some(found) = found {
            estimator.reset_at(*stamp, self.with_map_uncertainty(found));
            self.supervisor.on_relocalized(now);
            self.last_push = Some(now);
            return;
        }
        if !self.is_searching {
            self.mark_lost(now);
        }
        self.search(estimator, event);
    }

    /// Pose of a robot whose wheels slipped since a scan last agreed with the map.
    fn search_after_slip(
        &self,
        ekf: &Ekf<S>,
        beams: &BeamSubset<S, BEAMS>,
        belief: &Belief<S>,
        map: &MapView<'_, S>,
    ) -> Option<Belief<S>> {
        let prior_std = self.slip.displacement_std().filter(|_| !self.is_searching)?;
        let search = LocalSearch { prior_std, ..self.config.local_search };
        search.refine_after_slip(ekf, beams, belief, map.walls)
    }

    /// One step of the global search.
    fn search<const N: usize>(&mut self, estimator: &mut DelayedEkf<S, N>, event: &ScanEvent<'_, S>) {
        let lines = event.observation.extracted.lines;
        let status = self.global.update(
            event.stamp,
            event.laser,
            event.scan,
            lines,
            event.map.walls,
            event.map.distance_field.as_ref(),
        );
        if let GlobalStatus::Localized(belief) = status {
            estimator.reset_at(self.global.stamp(), self.with_map_uncertainty(belief));
            self.supervisor.on_relocalized(estimator.stamp());
            self.is_searching = false;
        }
    }

    fn with_map_uncertainty(&self, found: Belief<S>) -> Belief<S> {
        let extra = self.config.relocalization_std;
        if extra.iter().all(|std| *std <= S::from_f64(0.0)) {
            return found;
        }
        let std = [0, 1, 2].map(|i| (found.covariance.std(i).squared() + extra[i].squared()).sqrt());
        Belief::new(found.pose, std)
    }
}
