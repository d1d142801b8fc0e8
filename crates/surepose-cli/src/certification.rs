//! What the certificate says of the loop in use: for `certify`, and for the commands that warn without it.

use serde::Serialize;
use surepose::{Law, param};
use surepose_cert::{Certificate, Drift, Margins, Noise, Request, Shipped, certify, drift, margins};
use surepose_data::Config;

/// Largest distance from which the robot starts \[m].
const WORKSPACE: f64 = 5.0;
/// A larger capture radius is no use \[m].
const LARGEST_CAPTURE_RADIUS: f64 = 0.15;
/// Longest period that is looked for \[s].
const LONGEST_PERIOD: f64 = 1.0;

/// Noise bounds for which the default loop is certified: those of a localisation with laser and compass.
pub(crate) const POSITION_NOISE: f64 = 0.007;
/// The same of the heading \[°].
pub(crate) const HEADING_NOISE_DEG: f64 = 0.25;

/// The certificate of the configured loop, with the longest period that it would allow.
pub(crate) fn certificate(config: &Config, noise: Noise) -> Certificate {
    asked(loop_of(config), noise, LONGEST_PERIOD, certify)
}

/// What the certificate bounds, under the keys of the command line's JSON; what was not shown is absent.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct Bounds {
    /// The true distance from the goal below which the robot comes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) capture_radius_m: Option<f64>,
    /// The heading error above which the local law brings the robot nearer at every tick.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) final_heading_bound_deg: Option<f64>,
    /// The largest true distance at any time after that.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) final_position_bound_m: Option<f64>,
}

impl Bounds {
    /// Those of a certificate.
    pub(crate) fn of(certificate: &Certificate) -> Self {
        let heading = certificate.settling.and_then(|settling| settling.heading_bound);
        Self {
            capture_radius_m: certificate.capture_radius,
            final_heading_bound_deg: heading.map(f64::to_degrees),
            final_position_bound_m: certificate.final_position_bound,
        }
    }

    /// Whether all is bounded that the others bound.
    pub(crate) fn keep(&self, others: &Self) -> bool {
        let listed = |bounds: &Self| {
            [bounds.capture_radius_m, bounds.final_heading_bound_deg, bounds.final_position_bound_m]
        };
        listed(self).iter().zip(listed(others)).all(|(own, other)| own.is_some() || other.is_none())
    }
}

/// What the certificate of the configured loop bounds, with this law instead of its own; nothing where it is refused.
pub(crate) fn bounds(config: &Config, law: &Law<f64>, noise: Noise) -> Option<Bounds> {
    let (subject, period, rests_within) = loop_of(config);
    let certificate = asked((Shipped { law: *law, ..subject }, period, rests_within), noise, 0.0, certify);
    certificate.certified.then(|| Bounds::of(&certificate))
}

/// What is to be said of this configuration before it drives anything.
///
/// The default loop is certified by a test; any other is judged here, which takes about a second.
pub(crate) fn warnings(config: &Config) -> Vec<String> {
    let mut warnings = config.warnings();
    if loop_of(config) != loop_of(&Config::default().fitted()) {
        let noise =
            Noise { position: POSITION_NOISE, heading: HEADING_NOISE_DEG.to_radians(), ..Noise::default() };
        if let Some(reason) = asked(loop_of(config), noise, 0.0, certify).reason {
            warnings.push(format!(
                "this loop is not certified for {POSITION_NOISE} m and {HEADING_NOISE_DEG}° of noise: {reason}; see \
                 `surepose certify`"
            ));
        }
    }
    warnings
}

/// What holds of the configured loop where the bounds of `noise` are standard deviations of white Gaussian noise.
pub(crate) fn average(config: &Config, noise: Noise) -> Option<Drift> {
    asked(loop_of(config), noise, 0.0, drift)
}

/// Cells of a quadrant of the margin's pictures, and boxes that each is cut into: cells of 5°, and of 10° where the fall
/// is not shown everywhere, because all work is spent on each gap.
const MARGIN: (usize, usize) = (18, 8);
const MARGIN_WITH_GAPS: (usize, usize) = (9, 8);

/// The margin of a certificate of the same loop and noise; `watch` is told the part that is done, and says whether to go
/// on.
pub(crate) fn margin(
    config: &Config,
    noise: Noise,
    certificate: &Certificate,
    watch: impl FnMut(f64) -> bool,
) -> Option<Margins> {
    let fineness = if certificate.certified { MARGIN } else { MARGIN_WITH_GAPS };
    asked(loop_of(config), noise, 0.0, |request| margins(request, certificate, fineness, watch))
}

/// What `answer` says to the request about a loop.
fn asked<T>(
    (subject, period, rests_within): (Shipped, f64, f64),
    noise: Noise,
    longest_period: f64,
    answer: impl FnOnce(&Request<'_, Shipped>) -> T,
) -> T {
    answer(&Request {
        subject: &subject,
        drive: subject.drive,
        limits: subject.limits,
        h: subject.law.gains().h,
        period,
        noise,
        workspace: WORKSPACE,
        largest_capture_radius: LARGEST_CAPTURE_RADIUS,
        rests_within,
        longest_period,
    })
}

/// All that the certificate is about: law and limits, the period, and the seen distance within which the robot may have
/// arrived and rest.
fn loop_of(config: &Config) -> (Shipped, f64, f64) {
    let (law, drive, braking, limits) = (config.law(), config.drive(), config.braking(), config.limits());
    let subject = Shipped { law, drive, braking, limits };
    let tolerance = config.controller().tolerance;
    (subject, config.number(&param::PERIOD), tolerance.position * tolerance.release)
}

#[cfg(test)]
mod tests {
    use super::Bounds;

    #[test]
    fn a_bound_that_is_lost_is_not_kept_and_one_that_is_won_is() {
        let all = Bounds {
            capture_radius_m: Some(0.035),
            final_heading_bound_deg: Some(7.0),
            final_position_bound_m: Some(0.04),
        };
        let wider = Bounds { capture_radius_m: Some(0.076), ..all };
        let without_heading = Bounds { final_heading_bound_deg: None, ..all };
        let without_position = Bounds { final_position_bound_m: None, ..all };
        assert!(wider.keep(&all) && all.keep(&without_heading) && without_heading.keep(&without_heading));
        assert!(!without_heading.keep(&all) && !without_position.keep(&all));
        assert!(!without_heading.keep(&without_position));
    }
}
