//! Disagreement of the sensors beyond their noise and the considered parameters.
//!
//! In a consistent filter the innovations of one kind, weighted and summed over some seconds, have the variance
//! W² + J D Jᵀ: W² by noise, which is white, and J by the parameters, which are constant. The sums of each channel are compared with
//! it. A wrong noise level alone does not show here: where the innovations scatter more than W² says, their own scatter counts.

use crate::scalar::Float;
use crate::time::Stamp;

use super::{COUNT, Variances, WALLS};

/// Sensor whose measurements disagree with all others, persistently and in one direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum DisagreeingSensor {
    /// The headings of the compass, with odometry and the other sensors.
    Compass,
    /// The laser's mounting or time: walls move sideways while the robot drives, or lengthwise while it turns.
    Laser,
    /// Walls of the map that the laser sees, with each other.
    Map,
}

impl DisagreeingSensor {
    /// The name used in reports and JSON.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Compass => "compass",
            Self::Laser => "laser",
            Self::Map => "map",
        }
    }
}

/// Time constant of the sums \[s]: of the walls, and of all other channels. Wheel noise hides a wrong compass for longer.
const WALL_WINDOW: f64 = 3.0;
const WINDOW: f64 = 10.0;
/// Sum, in standard deviations, from which a channel disagrees: one of a consistent filter exceeds it in 5 of 10⁴ windows.
const THRESHOLD: f64 = 3.5;
/// Number of innovations before a channel is judged.
const MIN_COUNT: u16 = 15;

/// Channels: the compass, the laser sideways and lengthwise, and one for each wall.
const CHANNELS: usize = 3 + WALLS;
pub(super) const COMPASS: usize = 0;
pub(super) const SIDEWAYS: usize = 1;
pub(super) const LENGTHWISE: usize = 2;
pub(super) const FIRST_WALL_CHANNEL: usize = 3;

/// Weighted sums of the innovations of one channel.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Channel<S> {
    sum: S,
    noise: S,
    /// Half the squared differences of successive terms: their variance, whatever their mean.
    scatter: S,
    term: S,
    by_parameter: [S; COUNT],
    last: Stamp,
    count: u16,
}

/// Sums of the innovations, by channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::estimation) struct InnovationSums<S> {
    channels: [Channel<S>; CHANNELS],
}

/// One scalar innovation: its residual, the variance of its noise and of P₀, and Jₑ.
#[derive(Clone, Copy)]
pub(super) struct ScalarInnovation<S> {
    pub(super) residual: S,
    pub(super) variance: S,
    pub(super) by_parameter: [S; COUNT],
}

impl<S: Float> InnovationSums<S> {
    pub(in crate::estimation) fn new() -> Self {
        let zero = S::from_f64(0.0);
        let empty = Channel {
            sum: zero,
            noise: zero,
            scatter: zero,
            term: zero,
            by_parameter: [zero; COUNT],
            last: Stamp::default(),
            count: 0,
        };
        Self { channels: [empty; CHANNELS] }
    }

    /// Forgets the channel of a wall that another one replaces.
    pub(super) fn forget_wall(&mut self, slot: usize) {
        if let (Some(channel), [empty, ..]) =
            (self.channels.get_mut(FIRST_WALL_CHANNEL + slot), Self::new().channels)
        {
            *channel = empty;
        }
    }

    /// Adds an innovation at `stamp` with `weight` per variance.
    pub(super) fn add(&mut self, channel: usize, stamp: Stamp, weight: S, row: &ScalarInnovation<S>) {
        let window = if channel < FIRST_WALL_CHANNEL { WINDOW } else { WALL_WINDOW };
        let Some(channel) = self.channels.get_mut(channel) else { return };
        let elapsed = stamp.since(channel.last).max(0.0);
        let kept = S::from_f64(1.0 / (1.0 + elapsed / window));
        channel.last = channel.last.max(stamp);
        let weight = weight / row.variance;
        channel.sum = channel.sum * kept + weight * row.residual;
        channel.noise = channel.noise * kept.squared() + weight.squared() * row.variance;
        let term = weight * row.residual;
        let change = (term - channel.term).squared() * S::from_f64(0.5);
        channel.scatter = channel.scatter * kept.squared() + change;
        channel.term = term;
        for (sum, by_parameter) in channel.by_parameter.iter_mut().zip(&row.by_parameter) {
            *sum = *sum * kept + weight * *by_parameter;
        }
        channel.count = channel.count.saturating_add(1);
    }

    /// The sensor whose channel exceeds its standard deviation by most; `None` where all are consistent.
    pub(in crate::estimation) fn disagreement(&self, variances: &Variances<S>) -> Option<DisagreeingSensor> {
        let mut worst = S::from_f64(THRESHOLD * THRESHOLD);
        let mut result = None;
        for (number, channel) in self.channels.iter().enumerate().filter(|(_, c)| c.count >= MIN_COUNT) {
            let considered = channel.by_parameter.iter().zip(&variances.values);
            let variance =
                considered.fold(channel.noise.max(channel.scatter), |sum, (j, d)| sum + j.squared() * *d);
            let squared = channel.sum.squared().div_or_zero(variance);
            if squared > worst {
                worst = squared;
                result = Some(match number {
                    COMPASS => DisagreeingSensor::Compass,
                    SIDEWAYS | LENGTHWISE => DisagreeingSensor::Laser,
                    _ => DisagreeingSensor::Map,
                });
            }
        }
        result
    }
}
