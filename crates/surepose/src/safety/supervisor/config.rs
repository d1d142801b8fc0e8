//! What the supervisor puts up with.

use crate::param;
use crate::scalar::Float;

/// The supervisor's constants.
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
    /// The mean of the normalised innovation squared per row may be so large, of measurements, and of scans as a whole; 1
    /// for a consistent filter.
    pub max_mean_nis: S,
    /// Turn rates may be off by so much on average \[rad/s].
    pub max_wheel_rate_error: S,
    /// The position's standard deviation may be so large \[m] before the robot slows down.
    pub slow_std: S,
    /// And so large \[m] before it stops.
    pub stop_std: S,
}

impl<S: Float> Default for SupervisorConfig<S> {
    /// For sensors at 10 Hz, of which the laser's beams may be hidden to a fifth by things on no map.
    ///
    /// Six scans against the map make the robot lost. After a kidnap all are: the flag is up within 0.6 s, or 1 s
    /// where two of ten agree by chance.
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
