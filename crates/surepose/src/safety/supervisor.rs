//! The supervisor: judges the estimate, and slows the robot down or stops it.
//!
//! Its inputs are the outcomes of odometry, measurements and scans, and the speeds of the wheels. Its outputs are how far the
//! estimate can be trusted ([`Health`]) and what the wheels may do ([`SafetyAction`], with a named [`FaultReason`]). The lost
//! state is latched: only [`Supervisor::on_relocalized`] ends it.

mod config;

use crate::estimation::{Belief, MeasurementOutcome, RejectReason};
use crate::kinematics::WheelPair;
use crate::lidar::BeamStats;
use crate::scalar::Float;
use crate::time::Stamp;

pub use config::SupervisorConfig;

/// How far the estimate can be trusted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Health {
    /// What is sensed agrees with it.
    Healthy,
    /// Something does not, or has not been asked for long.
    Degraded,
    /// It is wrong, or there is none.
    Lost,
}

/// What the wheels may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SafetyAction {
    /// What the controller grants.
    Proceed,
    /// The same, slower.
    Slowdown(FaultReason),
    /// Nothing.
    Stop(FaultReason),
}

/// Why the robot was slowed down or stopped.
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
    /// The factor on the speed of both wheels: the path stays what the law made it.
    pub fn speed_scale<S: Float>(self) -> S {
        S::from_f64(match self {
            Self::Proceed => 1.0,
            Self::Slowdown(_) => 0.3,
            Self::Stop(_) => 0.0,
        })
    }
}

/// What a supervisor has seen so far. It holds a few numbers, and no call does more than a few operations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Supervisor<S> {
    config: SupervisorConfig<S>,
    /// When odometry last said something, and when a measurement was last accepted.
    last_odometry: Stamp,
    last_accepted: Stamp,
    /// How many more scans, of the last ones, contradicted the map than agreed with it; likewise measurements.
    scans_against: u16,
    measurements_against: u16,
    /// The mean normalised innovation squared per row, of measurements and of whole scans, and the mean following error
    /// \[rad/s], of the recent past.
    mean_nis: S,
    scan_nis: S,
    wheel_rate_error: S,
    lost: bool,
}

impl<S: Float> Supervisor<S> {
    /// Nothing is wrong at `stamp`.
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

    /// What became of a stretch of odometry that ends at `stamp`: the time that counts from now on, if the clock was set back.
    pub fn on_odometry(&mut self, stamp: Stamp, is_used: bool) {
        if is_used {
            self.last_odometry = stamp;
            self.last_accepted = self.last_accepted.min(stamp);
        }
    }

    /// What became of a measurement with `rows` rows, taken at `stamp`.
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

    /// Whether a scan that agrees so with the map is against it.
    pub fn contradicts_map(&self, stats: &BeamStats<S>) -> bool {
        let config = &self.config;
        // Beams that are missing are as good as any that end beyond the walls.
        let all = S::from_f64(f64::from(stats.beams.saturating_add(stats.missed_returns)));
        let hits = S::from_f64(f64::from(stats.hits));
        hits < config.min_hit_ratio * all || stats.behind_wall_ratio() > config.max_behind_wall_ratio
    }

    /// How a scan agrees with the map at the pose that was believed when it was taken, and how far off it puts the robot:
    /// the normalised innovation squared of what its beams together ask for, per row.
    pub fn on_scan(&mut self, stats: &BeamStats<S>, scan_nis: S) {
        let config = &self.config;
        if stats.beams.saturating_add(stats.missed_returns) < config.min_beams {
            return;
        }
        // One scan may be broken, and weighs no more than one that is just outside a gate. A NaN compares false.
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

    /// Takes the commanded and the measured turn rates of the wheels \[rad/s].
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

    /// How far the estimate can be trusted at `now`.
    pub fn health(&self, now: Stamp, belief: &Belief<S>) -> Health {
        self.judge(now, belief).0
    }

    /// What the wheels may do at `now`.
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

    /// What is wrong, the worst first.
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

/// The most that one scan counts, per row: a consistent one of 10⁶ is farther off, the quantile of χ² with 3 rows.
const MAX_SCAN_NIS: f64 = 30.7 / 3.0;

/// Whether the position is known to `std` \[m]; a NaN is not.
fn is_within<S: Float>(belief: &Belief<S>, std: S) -> bool {
    (belief.covariance.entry(0, 0) + belief.covariance.entry(1, 1)).sqrt() <= std
}

/// The mean over the last twenty values or so.
fn mean<S: Float>(before: S, now: S) -> S {
    before + (now - before) * S::from_f64(0.05)
}

#[cfg(test)]
mod tests;
