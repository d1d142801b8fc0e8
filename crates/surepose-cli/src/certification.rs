//! What the certificate says of the loop in use: for `certify`, and for the commands that warn without it.

use serde::Serialize;
use surepose::control::Law;
use surepose::param;
use surepose_cert::{
    Certificate, DeployedController, Drift, Margins, NoiseBounds, Request, certify, drift, margins,
};
use surepose_config::Config;

/// Largest distance from which the robot starts \[m].
const WORKSPACE: f64 = 5.0;
/// A larger capture radius is no use \[m].
const MAX_CAPTURE_RADIUS: f64 = 0.15;
/// Longest period that is looked for \[s].
const MAX_PERIOD: f64 = 1.0;

/// Noise bounds for which the default loop is certified: those of a localisation with laser and compass.
pub(crate) const POSITION_NOISE: f64 = 0.007;
/// The same of the heading \[°].
pub(crate) const HEADING_NOISE_DEG: f64 = 0.25;

/// The certificate of the configured loop, with the longest period that it would allow.
pub(crate) fn certificate(config: &Config, noise: NoiseBounds) -> Certificate {
    asked(loop_of(config), noise, MAX_PERIOD, certify)
}

/// What the certificate bounds, under the keys of the command line's JSON; what was not shown is absent.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct CertifiedBounds {
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

impl CertifiedBounds {
    /// Those of a certificate.
    pub(crate) fn from_certificate(certificate: &Certificate) -> Self {
        let heading = certificate.terminal_phase.and_then(|terminal_phase| terminal_phase.heading_bound);
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
pub(crate) fn bounds(config: &Config, law: &Law<f64>, noise: NoiseBounds) -> Option<CertifiedBounds> {
    let (controller, period, rests_within) = loop_of(config);
    let certificate =
        asked((DeployedController { law: *law, ..controller }, period, rests_within), noise, 0.0, certify);
    certificate.certified.then(|| CertifiedBounds::from_certificate(&certificate))
}

/// What is to be said of this configuration before it drives anything.
///
/// The default loop is certified by a test; any other is judged here, which takes about a second.
pub(crate) fn warnings(config: &Config) -> Vec<String> {
    let mut warnings = config.warnings();
    if loop_of(config) != loop_of(&Config::default().fitted()) {
        let noise = NoiseBounds {
            position: POSITION_NOISE,
            heading: HEADING_NOISE_DEG.to_radians(),
            ..NoiseBounds::default()
        };
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
pub(crate) fn average(config: &Config, noise: NoiseBounds) -> Option<Drift> {
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
    noise: NoiseBounds,
    certificate: &Certificate,
    watch: impl FnMut(f64) -> bool,
) -> Option<Margins> {
    let fineness = if certificate.certified { MARGIN } else { MARGIN_WITH_GAPS };
    asked(loop_of(config), noise, 0.0, |request| margins(request, certificate, fineness, watch))
}

/// What `answer` says to the request about a loop.
fn asked<T>(
    (controller, period, rests_within): (DeployedController, f64, f64),
    noise: NoiseBounds,
    max_period_searched: f64,
    answer: impl FnOnce(&Request<'_, DeployedController>) -> T,
) -> T {
    answer(&Request {
        controller: &controller,
        drive: controller.drive,
        limits: controller.limits,
        h: controller.law.gains().h,
        period,
        noise,
        workspace: WORKSPACE,
        max_capture_radius: MAX_CAPTURE_RADIUS,
        rests_within,
        max_period_searched,
    })
}

/// All that the certificate is about: law and limits, the period, and the seen distance within which the robot may have
/// arrived and rest.
fn loop_of(config: &Config) -> (DeployedController, f64, f64) {
    let (law, drive, braking, limits) = (config.law(), config.drive(), config.braking(), config.limits());
    let controller = DeployedController { law, drive, braking, limits };
    let tolerance = config.controller().tolerance;
    (controller, config.number(&param::PERIOD), tolerance.position * tolerance.hysteresis)
}

#[cfg(test)]
mod tests {
    use super::CertifiedBounds;

    #[test]
    fn bounds_comparison_rejects_lost_bounds() {
        let all = CertifiedBounds {
            capture_radius_m: Some(0.035),
            final_heading_bound_deg: Some(7.0),
            final_position_bound_m: Some(0.04),
        };
        let wider = CertifiedBounds { capture_radius_m: Some(0.076), ..all };
        let without_heading = CertifiedBounds { final_heading_bound_deg: None, ..all };
        let without_position = CertifiedBounds { final_position_bound_m: None, ..all };
        assert!(wider.keep(&all) && all.keep(&without_heading) && without_heading.keep(&without_heading));
        assert!(!without_heading.keep(&all) && !without_position.keep(&all));
        assert!(!without_heading.keep(&without_position));
    }
}
