//! Thresholds of the supervisor.

use crate::param;
use crate::scalar::Float;

/// Thresholds of a [`Supervisor`](super::Supervisor).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SupervisorConfig<S> {
    /// Time-out of odometry \[s].
    pub odometry_timeout: f64,
    /// Time-out of accepted pose measurements \[s]; infinite without such a sensor.
    pub aiding_timeout: f64,
    /// Smallest share of hits of a scan that agrees with the map.
    pub min_hit_ratio: S,
    /// Largest share of beams that end behind a wall, of a scan that agrees with the map.
    pub max_behind_wall_ratio: S,
    /// A scan with fewer beams is not judged.
    pub min_beams: u16,
    /// The robot is lost when contradicting scans exceed agreeing ones by this number.
    pub max_scan_excess: u16,
    /// The robot is lost when outliers exceed accepted measurements by this number.
    pub max_outlier_excess: u16,
    /// Maximum mean of the normalized innovation squared per row, of measurements and of whole scans; 1 for a consistent
    /// filter.
    pub max_mean_nis: S,
    /// Maximum mean tracking error of the wheels \[rad/s].
    pub max_wheel_rate_error: S,
    /// Standard deviation of the position above which the robot slows down \[m].
    pub slow_std: S,
    /// Standard deviation of the position above which the robot stops \[m].
    pub stop_std: S,
}

impl<S: Float> Default for SupervisorConfig<S> {
    /// Thresholds for sensors at 10 Hz; unmapped objects may hide a fifth of the beams.
    ///
    /// An excess of six contradicting scans makes the robot lost. A kidnapped robot is lost within 0.6 s, or within 1 s if two
    /// of ten scans agree by chance.
    fn default() -> Self {
        Self {
            odometry_timeout: param::ODOMETRY_TIMEOUT.default_si(),
            aiding_timeout: param::AIDING_TIMEOUT.default_si(),
            min_hit_ratio: S::from_f64(param::MIN_HIT_RATIO.default_si()),
            max_behind_wall_ratio: S::from_f64(param::MAX_BEHIND_WALL_RATIO.default_si()),
            min_beams: 12,
            max_scan_excess: 6,
            max_outlier_excess: 15,
            max_mean_nis: S::from_f64(param::MAX_MEAN_NIS.default_si()),
            max_wheel_rate_error: S::from_f64(param::MAX_WHEEL_RATE_ERROR.default_si()),
            slow_std: S::from_f64(param::SLOW_STD.default_si()),
            stop_std: S::from_f64(param::STOP_STD.default_si()),
        }
    }
}
