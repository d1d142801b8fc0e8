//! Tuned constants of the hybrid law and its gains: name, value, unit and reason, one line each.
//!
//! Radii are in multiples of the capture radius ε. They were tuned on the bench trial; the certificate verifies them.
//! `cargo xtask ablation NAME` shows the effect of a constant: it builds the program without it and repeats the trials. The line
//! "With …" is its most significant result.

/// Fraction of the distance error \[1] removed in each period: below 1, so that the sampled loop does not overshoot.
/// With 1: at 0.1 s with noise 4.5 reversals a drive instead of 0.9.
pub(super) const K_V_PER_PERIOD: f64 = 0.2;
/// Fraction of the bearing error \[1] removed in each period: below 1, so that the sampled loop does not overshoot.
/// With 1: with noise the median time is 7 % longer.
pub(super) const K_ALPHA_PER_PERIOD: f64 = 0.24;
/// Fraction of the heading error \[1] removed in the first trimming period: the first step of a recursive mean.
/// With 0.12: the median time is 2 % longer, at 0.1 s 21 %.
pub(super) const K_THETA_PER_PERIOD: f64 = 1.0;
/// Fraction of a small bearing error \[1] removed in each period: estimate noise is averaged over several periods.
/// With 0.24: with noise the median time is 2.5 % longer.
pub(super) const SMALL_ERROR_ALPHA_PER_PERIOD: f64 = 0.096;
/// Fraction of a small heading error \[1] removed in each period: estimate noise is averaged over several periods.
/// With 1: the final heading error is four times as large.
pub(super) const SMALL_ERROR_THETA_PER_PERIOD: f64 = 0.12;
/// Maximum k_v \[1/s]: larger gains follow noise and save less than a third of a second.
/// With ∞: 5 % larger final errors, 8 % more reversals.
pub(super) const MAX_K_V: f64 = 9.0;
/// Remaining wheel travel \[m] at which constant deceleration changes to exponential settling.
/// With 1 mm: with 0.2 m/s² the median time is 35 % longer.
pub(super) const SETTLING_DISTANCE: f64 = 0.09;
/// h \[1]: a small weight gives nearly straight paths with a final turn, as the time-optimal ones of [BalkcomMason2002].
/// With 1: the certified radius is 10.8 cm instead of 3.9 cm.
pub(super) const APPROACH_WEIGHT: f64 = 0.3;
/// Fraction of the wheel acceleration \[1] used for braking: the rest corrects the path.
/// With 1: drives are 7 % shorter, but with 0.1 m/s² 2 % fail.
pub(super) const ACCELERATION_FRACTION: f64 = 0.7;
/// Radius \[ε] below which the local law takes over: well below the exit radii, so that noise does not switch back.
/// With 0.85: starts beside the goal take up to 86 s instead of 8 s.
pub(super) const ENTER_RADIUS: f64 = 0.23;
/// Radius \[ε] above which the local law ends: noise at the entry cannot cause an immediate switch back.
/// With 0.23: with noise 1 % of the drives succeed.
pub(super) const LEAVE_RADIUS: f64 = 0.85;
/// Mean lateral error \[ε] above which a sidestep begins: 8 mm by default, within the usual tolerance of 1 cm.
/// With ∞: of the starts beside the goal 65 % succeed.
pub(super) const SIDESTEP_THRESHOLD: f64 = 0.25;
/// Trimming time \[ticks] after which a sidestep or its out leg ends: a mean over fewer estimates is too noisy.
/// With 1: starts beside the goal take up to 21 s instead of 8 s.
pub(super) const SIDESTEP_TICKS: f64 = 10.0;
/// Maximum number of trimming ticks \[ticks] in a mean: the law still observes an error that grows later.
pub(super) const MAX_TRIM_TICKS: f64 = 25.0;
/// Longitudinal error \[ε] below which the local law starts to turn faster than the minimum.
/// With 0: the median time is 60 % longer.
pub(super) const ARRIVED_RADIUS: f64 = 0.35;
/// Minimum factor \[1] of the local turn rate: noise that hides the arrival does not prevent the turn.
pub(super) const MIN_TURN_FACTOR: f64 = 0.1;
/// Radius \[ε] beyond which h has its full value: closer, the approach direction counts less.
/// With 0: without noise the final error is 4.6 mm instead of 0.7 mm.
pub(super) const APPROACH_RADIUS: f64 = 2.7;
/// Bearing error \[rad] above which k_α has its full value: large errors are removed at once.
/// With 0: with noise the median time is 2.5 % longer.
pub(super) const FULL_GAIN_ALPHA: f64 = 0.08;
/// Heading error \[rad] above which k_θ has its full value; below it, the local law trims.
/// With 0: of the starts beside the goal 66 % succeed.
pub(super) const FULL_GAIN_THETA: f64 = 0.045;
/// Heading error \[rad] below which the local law turns at any distance; above twice this value, only after arrival.
/// With 0: starts beside the goal take up to 118 s, 1 % fail.
pub(super) const TRIM_THRESHOLD: f64 = 0.02;
/// Deadband radius, in standard deviations of the position, for a period of 1 s: more frequent estimates cause more false motion.
/// With 0: with noise 28.6 reversals a drive instead of 1.4.
pub(super) const DEADBAND_STD_DEVS: f64 = 0.12;
/// Maximum deadband radius \[ε]: a robot at rest must be in local mode, see [`super::HybridLaw`].
pub(super) const MAX_DEADBAND_RADIUS: f64 = 0.13;
/// Ratio \[1] of the reversal distance to the deadband radius: noise does not reverse the travel.
pub(super) const REVERSAL_FACTOR: f64 = 2.4;
/// Angle beyond ±π \[rad] up to which a rotation keeps its direction: noise does not reverse the turn.
pub(super) const TURN_HYSTERESIS: f64 = 0.5;
/// Margin \[rad] of |α| + h|φ| over the other direction that reverses the travel: noise does not reverse it.
pub(super) const DIRECTION_HYSTERESIS: f64 = 1.3;
