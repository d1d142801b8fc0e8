//! Initial headings of a scan match: association is reliable only within a few degrees of the true heading.

use crate::estimation::Belief;
use crate::geometry::Pose;
use crate::scalar::Float;

/// Maximum number of headings on either side of the believed one.
const MAX_STEPS_PER_SIDE: u8 = 10;

/// Step between the headings \[rad]; at 5 m it moves the end of a beam by 0.3 m.
const HEADING_STEP: f64 = 0.06;

/// Search width in standard deviations of the heading.
const SEARCH_STD_DEVS: f64 = 3.0;

/// Beliefs along the ellipse of the prior, one per [`HEADING_STEP`]; the prior alone where its heading is certain
/// enough.
///
/// The position of each is the most likely one for its heading. Its covariance is that of the prior, conditioned on a
/// heading known to one step.
pub(super) fn initial_beliefs<S: Float>(belief: &Belief<S>) -> impl Iterator<Item = Belief<S>> + use<S> {
    let belief = *belief;
    let variance = belief.covariance.entry(2, 2);
    let max_range = variance.sqrt() * S::from_f64(SEARCH_STD_DEVS);
    let by_heading = [0, 1].map(|row| belief.covariance.entry(row, 2).div_or_zero(variance));
    let heading_alone = [S::from_f64(0.0), S::from_f64(0.0), S::from_f64(1.0)];
    let conditional =
        belief.covariance.observed(heading_alone, S::from_f64(HEADING_STEP * HEADING_STEP)).covariance;
    let covariance = if max_range > S::from_f64(HEADING_STEP) { conditional } else { belief.covariance };
    // 0, 1, −1, 2, −2, …
    let offsets = (0..=2 * MAX_STEPS_PER_SIDE).map(|n| {
        let side_offset = S::from_f64(f64::from(n.div_ceil(2)) * HEADING_STEP);
        if n % 2 == 0 { -side_offset } else { side_offset }
    });
    let max_distance =
        offsets.enumerate().take_while(move |(n, offset)| *n == 0 || offset.abs() <= max_range);
    max_distance.map(move |(_, offset)| {
        let pose = belief.pose;
        let pose = Pose::new(
            pose.x + by_heading[0] * offset,
            pose.y + by_heading[1] * offset,
            pose.heading.rotated_by(offset),
        );
        Belief { pose, covariance }
    })
}
