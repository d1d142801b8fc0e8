//! Supervisor of the estimate: slows the robot down or stops it for a named reason.
//!
//! Its inputs are the outcomes of odometry, measurements and scans, and the speeds of the wheels. Its outputs are the quality of
//! the estimate ([`Health`]) and the action for the wheels ([`SafetyAction`], with a [`FaultReason`]). The lost state is latched:
//! only [`Supervisor::on_relocalized`] ends it.

mod config;

use crate::estimation::{Belief, MeasurementOutcome, RejectReason};
use crate::kinematics::WheelPair;
use crate::lidar::BeamStats;
use crate::scalar::Float;
use crate::time::Stamp;

pub use config::SupervisorConfig;

/// Quality of the estimate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Health {
    /// Measurements agree with the estimate.
    Healthy,
    /// Some measurements contradict the estimate, or none was accepted for a while.
    Degraded,
    /// The pose is unknown.
    Lost,
}

/// Action of the supervisor on the wheels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SafetyAction {
    /// No change.
    Proceed,
    /// The speed is reduced.
    Slowdown(FaultReason),
    /// The robot stops.
    Stop(FaultReason),
}

/// Reason for which the supervisor slows the robot down or stops it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum FaultReason {
    /// Scans contradict the map at the estimated pose.
    Lost,
    /// No usable odometry within the time-out.
    OdometryTimeout,
    /// No accepted measurement of the pose within the time-out.
    DeadReckoningOnly,
    /// Measurements disagree with the estimate by more than their noise.
    Inconsistent,
    /// The standard deviation of the position is too large.
    Uncertain,
    /// The wheels do not follow their commands.
    WheelTrackingError,
}

impl FaultReason {
    /// The name used in reports and JSON.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Lost => "lost",
            Self::OdometryTimeout => "odometry_timeout",
            Self::DeadReckoningOnly => "dead_reckoning_only",
            Self::Inconsistent => "inconsistent",
            Self::Uncertain => "uncertain",
            Self::WheelTrackingError => "wheel_tracking_error",
        }
    }
}

impl SafetyAction {
    /// Factor on the speed of both wheels, 0 to 1; the path does not change.
    pub fn speed_scale<S: Float>(self) -> S {
        S::from_f64(match self {
            Self::Proceed => 1.0,
            Self::Slowdown(_) => 0.3,
            Self::Stop(_) => 0.0,
        })
    }
}

/// Supervisor: counters and running means of the recent past. Every call takes a few operations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Supervisor<S> {
    config: SupervisorConfig<S>,
    /// Times of the last usable odometry and of the last accepted measurement.
    last_odometry: Stamp,
    last_accepted: Stamp,
    /// Excess of contradicting over agreeing scans, and of outliers over accepted measurements; at least 0.
    scans_against: u16,
    measurements_against: u16,
    /// Running means: normalized innovation squared per row of measurements and of whole scans, and tracking error of the
    /// wheels \[rad/s].
    mean_nis: S,
    scan_nis: S,
    wheel_rate_error: S,
    lost: bool,
}

impl<S: Float> Supervisor<S> {
    /// Supervisor without a fault at `stamp`.
    pub fn new(config: SupervisorConfig<S>, stamp: Stamp) -> Self {
        Self {
            config,
            last_odometry: stamp,
            last_accepted: stamp,
            scans_against: 0,
            measurements_against: 0,
            mean_nis: S::from_f64(1.0),
            scan_nis: S::from_f64(1.0),
            wheel_rate_error: S::from_f64(0.0),
            lost: false,
        }
    }

    /// Notes odometry up to `stamp`, and whether the filter used it. An earlier stamp means that the clock was set back.
    pub fn on_odometry(&mut self, stamp: Stamp, is_used: bool) {
        if is_used {
            self.last_odometry = stamp;
            self.last_accepted = self.last_accepted.min(stamp);
        }
    }

    /// Notes the outcome of a measurement with `rows` rows, taken at `stamp`.
    pub fn on_measurement(&mut self, stamp: Stamp, outcome: MeasurementOutcome, rows: usize) {
        match outcome {
            MeasurementOutcome::Accepted { nis } => {
                self.last_accepted = self.last_accepted.max(stamp);
                self.measurements_against = self.measurements_against.saturating_sub(1);
                let per_row = S::from_f64(nis / rows.max(1) as f64);
                self.mean_nis = mean(self.mean_nis, per_row);
            }
            MeasurementOutcome::Rejected(RejectReason::Outlier) => {
                self.measurements_against =
                    (self.measurements_against + 1).min(self.config.max_outlier_excess);
            }
            MeasurementOutcome::Rejected(_) => {}
        }
        self.lost = self.lost || self.measurements_against >= self.config.max_outlier_excess;
    }

    /// Whether the map explains a scan with these statistics. If not, the robot slipped, or things on no map hide the walls.
    pub fn agrees_with_map(&self, stats: &BeamStats<S>) -> bool {
        let BeamShares { all, hits, .. } = BeamShares::of(stats);
        hits >= self.config.min_hit_ratio * all && self.walls_are_in_front(stats)
    }

    /// Whether a scan with these statistics contradicts the map, whatever things on no map hide.
    ///
    /// They hide walls and show nothing behind them: of the other beams, more must hit.
    pub fn contradicts_map(&self, stats: &BeamStats<S>) -> bool {
        let BeamShares { all, hits, open } = BeamShares::of(stats);
        let is_clutter = hits >= S::from_f64(MIN_CLUTTERED_HITS) * all
            && hits >= S::from_f64(MIN_OPEN_HITS) * open
            && self.walls_are_in_front(stats);
        !self.agrees_with_map(stats) && !is_clutter
    }

    /// Whether few beams end behind a wall.
    fn walls_are_in_front(&self, stats: &BeamStats<S>) -> bool {
        stats.behind_wall_ratio() <= self.config.max_behind_wall_ratio
    }

    /// Notes the statistics of a scan at the belief of its time, and the normalized innovation squared per row of the pose
    /// that its beams determine together.
    pub fn on_scan(&mut self, stats: &BeamStats<S>, scan_nis: S) {
        let config = &self.config;
        if stats.beams.saturating_add(stats.missed_returns) < config.min_beams {
            return;
        }
        // The limit keeps a single broken scan from a false alarm. A NaN compares false.
        if scan_nis >= S::from_f64(0.0) {
            let weight = S::from_f64(1.0 / f64::from(config.max_scan_excess.max(1)));
            self.scan_nis =
                self.scan_nis + (scan_nis.min(S::from_f64(MAX_SCAN_NIS)) - self.scan_nis) * weight;
        }
        let against = self.scan_nis > config.max_mean_nis || self.contradicts_map(stats);
        self.scans_against = if against {
            (self.scans_against + 1).min(config.max_scan_excess)
        } else {
            self.scans_against.saturating_sub(1)
        };
        self.lost = self.lost || self.scans_against >= config.max_scan_excess;
    }

    /// Notes the commanded and the measured turn rates of the wheels \[rad/s].
    pub fn on_wheel_speeds(&mut self, commanded: WheelPair<S>, did: WheelPair<S>) {
        let error = WheelPair::new(did.right - commanded.right, did.left - commanded.left).max_abs();
        if error.is_finite() {
            self.wheel_rate_error = mean(self.wheel_rate_error, error);
        }
    }

    /// Ends the lost state at `stamp`, when a relocalization has reset the estimate.
    pub fn on_relocalized(&mut self, stamp: Stamp) {
        let (last_odometry, wheel_rate_error) = (self.last_odometry.max(stamp), self.wheel_rate_error);
        *self = Self { last_odometry, wheel_rate_error, ..Self::new(self.config, stamp) };
    }

    /// Enters the lost state: the pose is unknown.
    pub fn mark_lost(&mut self) {
        self.lost = true;
    }

    /// Quality of the estimate at `now`.
    pub fn health(&self, now: Stamp, belief: &Belief<S>) -> Health {
        self.judge(now, belief).0
    }

    /// Action for the wheels at `now`.
    pub fn action(&self, now: Stamp, belief: &Belief<S>) -> SafetyAction {
        self.judge(now, belief).1
    }

    /// Health and action at `now`, from one evaluation of all faults.
    pub fn judge(&self, now: Stamp, belief: &Belief<S>) -> (Health, SafetyAction) {
        let fault = self.fault(now, belief);
        let health = match fault {
            Some(FaultReason::Lost) => Health::Lost,
            Some(FaultReason::WheelTrackingError) | None if self.scans_against == 0 => Health::Healthy,
            _ => Health::Degraded,
        };
        let action = match fault {
            None => SafetyAction::Proceed,
            Some(reason @ (FaultReason::Lost | FaultReason::OdometryTimeout)) => SafetyAction::Stop(reason),
            Some(reason @ FaultReason::Uncertain) if !is_within(belief, self.config.stop_std) => {
                SafetyAction::Stop(reason)
            }
            Some(reason) => SafetyAction::Slowdown(reason),
        };
        (health, action)
    }

    /// The most severe fault; `None` without a fault.
    fn fault(&self, now: Stamp, belief: &Belief<S>) -> Option<FaultReason> {
        let config = &self.config;
        // A stamp in the future comes from a clock that was set back since.
        let is_recent = (0.0..=config.odometry_timeout).contains(&now.since(self.last_odometry));
        let wrong = [
            (self.lost, FaultReason::Lost),
            (!is_recent, FaultReason::OdometryTimeout),
            (!is_within(belief, config.slow_std), FaultReason::Uncertain),
            (self.mean_nis > config.max_mean_nis, FaultReason::Inconsistent),
            (self.scans_against >= config.max_scan_excess.div_ceil(2), FaultReason::Inconsistent),
            (now.since(self.last_accepted) > config.aiding_timeout, FaultReason::DeadReckoningOnly),
            (self.wheel_rate_error > config.max_wheel_rate_error, FaultReason::WheelTrackingError),
        ];
        wrong.into_iter().find_map(|(is_wrong, reason)| is_wrong.then_some(reason))
    }
}

/// Numbers of beams of a scan: all, with the missed returns, those that hit the expected wall, and those that nothing hides.
struct BeamShares<S> {
    all: S,
    hits: S,
    open: S,
}

impl<S: Float> BeamShares<S> {
    fn of(stats: &BeamStats<S>) -> Self {
        let number = |count: u16| S::from_f64(f64::from(count));
        // Missed returns count as beams that end behind a wall.
        let all = number(stats.beams.saturating_add(stats.missed_returns));
        Self { all, hits: number(stats.hits), open: all - number(stats.short) }
    }
}

/// Smallest share of hits of a scan among clutter: of all beams, and of those that nothing hides.
const MIN_CLUTTERED_HITS: f64 = 0.3;
const MIN_OPEN_HITS: f64 = 0.85;

/// Maximum contribution of one scan per row: the 1 − 10⁻⁶ quantile of χ² with 3 degrees of freedom, over 3.
const MAX_SCAN_NIS: f64 = 30.7 / 3.0;

/// Whether the standard deviation of the position is at most `std` \[m]; false for NaN.
fn is_within<S: Float>(belief: &Belief<S>, std: S) -> bool {
    (belief.covariance.entry(0, 0) + belief.covariance.entry(1, 1)).sqrt() <= std
}

/// Exponential mean with a memory of twenty values.
fn mean<S: Float>(before: S, now: S) -> S {
    before + (now - before) * S::from_f64(0.05)
}

#[cfg(test)]
mod tests;
