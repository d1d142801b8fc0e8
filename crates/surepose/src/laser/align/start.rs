//! Where to begin: a beam finds its wall only where the heading is right to a few degrees.

use crate::estimate::Belief;
use crate::pose::Pose;
use crate::scalar::Float;

/// The most headings that are tried on either side of the believed one.
const MOST_ASIDE: u8 = 10;

/// From one heading that is tried to the next \[rad]: at 5 m, the end of a beam moves by 0.3 m.
const STEP: f64 = 0.06;

/// How many standard deviations of the heading are searched.
const REACH: f64 = 3.0;

/// Poses along the belief's ellipse, one for every [`STEP`] of heading; the believed one alone where that is sure enough.
///
/// Each one's position is the likeliest for its heading, and its covariance that of the belief if the heading were
/// known to a step.
pub(super) fn candidates<S: Float>(belief: &Belief<S>) -> impl Iterator<Item = Belief<S>> + use<S> {
    let belief = *belief;
    let variance = belief.covariance.entry(2, 2);
    let reach = variance.sqrt() * S::of(REACH);
    let by_heading = [0, 1].map(|row| belief.covariance.entry(row, 2).over_positive(variance));
    let heading_alone = [S::of(0.0), S::of(0.0), S::of(1.0)];
    let narrow = belief.covariance.observed(heading_alone, S::of(STEP * STEP)).covariance;
    let covariance = if reach > S::of(STEP) { narrow } else { belief.covariance };
    // 0, 1, −1, 2, −2, …
    let offsets = (0..=2 * MOST_ASIDE).map(|n| {
        let aside = S::of(f64::from(n.div_ceil(2)) * STEP);
        if n % 2 == 0 { -aside } else { aside }
    });
    let within = offsets.enumerate().take_while(move |(n, offset)| *n == 0 || offset.abs() <= reach);
    within.map(move |(_, offset)| {
        let pose = belief.pose;
        let pose = Pose::new(
            pose.x + by_heading[0] * offset,
            pose.y + by_heading[1] * offset,
            pose.heading.turned(offset),
        );
        Belief { pose, covariance }
    })
}
