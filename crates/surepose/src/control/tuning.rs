//! Tuned constants of the hybrid law and its gains: name, value, unit and reason, one line each.
//!
//! Radii are in multiples of the capture radius ε. They were tuned on the bench trial; the certificate verifies them.
//! `cargo xtask ablation NAME` shows the effect of a constant: it builds the program without it and repeats the trials.

/// Fraction of the distance error \[1] removed in each period: below 1, so that the sampled loop does not overshoot.
pub(super) const K_V_PER_PERIOD: f64 = 0.2;
/// Fraction of the bearing error \[1] removed in each period: below 1, so that the sampled loop does not overshoot.
pub(super) const K_ALPHA_PER_PERIOD: f64 = 0.24;
/// Fraction of the heading error \[1] removed in the first trimming period: the first step of a recursive mean.
pub(super) const K_THETA_PER_PERIOD: f64 = 1.0;
/// Fraction of a small bearing error \[1] removed in each period: estimate noise is averaged over several periods.
pub(super) const SMALL_ERROR_ALPHA_PER_PERIOD: f64 = 0.096;
/// Fraction of a small heading error \[1] removed in each period: estimate noise is averaged over several periods.
pub(super) const SMALL_ERROR_THETA_PER_PERIOD: f64 = 0.12;
/// Maximum k_v \[1/s]: larger gains follow noise and save less than a third of a second.
pub(super) const MAX_K_V: f64 = 9.0;
/// Remaining wheel travel \[m] at which constant deceleration changes to exponential settling.
pub(super) const SETTLING_DISTANCE: f64 = 0.09;
/// h \[1]: a small weight gives nearly straight paths with a final turn, as the time-optimal ones of [BalkcomMason2002].
pub(super) const APPROACH_WEIGHT: f64 = 0.3;
/// Fraction of the wheel acceleration \[1] used for braking: the rest corrects the path.
pub(super) const ACCELERATION_FRACTION: f64 = 0.7;
/// Radius \[ε] below which the local law takes over: well below the exit radii, so that noise does not switch back.
pub(super) const ENTER_RADIUS: f64 = 0.23;
/// Radius \[ε] above which the local law ends: noise at the entry cannot cause an immediate switch back.
pub(super) const LEAVE_RADIUS: f64 = 0.85;
/// Mean lateral error \[ε] above which a sidestep begins: 8 mm by default, within the usual tolerance of 1 cm.
pub(super) const SIDESTEP_THRESHOLD: f64 = 0.25;
/// Trimming time \[ticks] after which a sidestep or its out leg ends: a mean over fewer estimates is too noisy.
pub(super) const SIDESTEP_TICKS: f64 = 10.0;
/// Maximum number of trimming ticks \[ticks] in a mean: the law still observes an error that grows later.
pub(super) const MAX_TRIM_TICKS: f64 = 25.0;
/// Longitudinal error \[ε] below which the local law starts to turn faster than the minimum.
pub(super) const ARRIVED_RADIUS: f64 = 0.35;
/// Minimum factor \[1] of the local turn rate: noise that hides the arrival does not prevent the turn.
pub(super) const MIN_TURN_FACTOR: f64 = 0.1;
/// Radius \[ε] beyond which h has its full value: closer, the approach direction counts less.
pub(super) const APPROACH_RADIUS: f64 = 2.7;
/// Bearing error \[rad] above which k_α has its full value: large errors are removed at once.
pub(super) const FULL_GAIN_ALPHA: f64 = 0.08;
/// Heading error \[rad] above which k_θ has its full value; below it, the local law trims.
pub(super) const FULL_GAIN_THETA: f64 = 0.045;
/// Heading error \[rad] below which the local law turns at any distance; above twice this value, only after arrival.
pub(super) const TRIM_THRESHOLD: f64 = 0.02;
/// Deadband radius, in standard deviations of the position, for a period of 1 s: more frequent estimates cause more false motion.
pub(super) const DEADBAND_STD_DEVS: f64 = 0.12;
/// Maximum deadband radius \[ε]: a robot at rest must be in local mode, see [`super::HybridLaw`].
pub(super) const MAX_DEADBAND_RADIUS: f64 = 0.13;
/// Ratio \[1] of the reversal distance to the deadband radius: noise does not reverse the travel.
pub(super) const REVERSAL_FACTOR: f64 = 2.4;
/// Angle beyond ±π \[rad] up to which a rotation keeps its direction: noise does not reverse the turn.
pub(super) const TURN_HYSTERESIS: f64 = 0.5;
/// Margin \[rad] of |α| + h|φ| over the other direction that reverses the travel: noise does not reverse it.
pub(super) const DIRECTION_HYSTERESIS: f64 = 1.3;
