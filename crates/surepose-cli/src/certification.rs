//! Certifies the configured loop: for `certify`, and for warnings of other commands.

use serde::Serialize;
use surepose::control::Law;
use surepose::param;
use surepose_cert::{
    ActuatorErrors, Certificate, DeployedController, Drift, Margins, NoiseBounds, Request, certify, drift,
    margins,
};
use surepose_config::Config;

/// Radius of the certified workspace around the goal \[m].
const WORKSPACE: f64 = 5.0;
/// Maximum useful capture radius \[m].
const MAX_CAPTURE_RADIUS: f64 = 0.15;
/// Maximum period of the search for the longest period \[s].
const MAX_PERIOD: f64 = 1.0;

/// Default bound of the position error, for localization with laser and compass \[m].
pub(crate) const POSITION_NOISE: f64 = 0.007;
/// Default bound of the heading error \[°].
pub(crate) const HEADING_NOISE_DEG: f64 = 0.25;

/// Dead time of the base \[s].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum BaseDelay {
    /// That of the configuration, over which the controller predicts.
    Configured,
    /// Another one; the controller predicts over the configured one.
    Given(f64),
}

impl BaseDelay {
    /// Describes the dead time of a base whose controller predicts over `predicted` \[s].
    pub(crate) fn described(self, predicted: f64) -> String {
        match self {
            Self::Given(delay) if delay.total_cmp(&predicted).is_ne() => format!(
                "delay: a command acts {delay} s after it is sent; the controller predicts over {predicted} s, and the rest counts as an \
                 error of the pose"
            ),
            _ if predicted > 0.0 => format!(
                "delay: a command acts {predicted} s after it is sent, which the controller predicts; distances are those of the pose at \
                 which it acts"
            ),
            _ => "delay: a command acts at once".to_owned(),
        }
    }
}

/// Certifies the configured loop and searches the longest certified period.
pub(crate) fn certificate(config: &Config, noise: NoiseBounds) -> Certificate {
    asked(loop_of(config), noise, MAX_PERIOD, certify)
}

/// Actuators of the configured base.
pub(crate) fn actuators(config: &Config, delay: BaseDelay) -> ActuatorErrors {
    let model = config.actuator();
    match delay {
        BaseDelay::Configured => ActuatorErrors::from_model(model),
        BaseDelay::Given(delay) => ActuatorErrors { model, delay },
    }
}

/// Returns `sensed` with the errors that the actuators of the configured base add.
pub(crate) fn with_actuators(config: &Config, sensed: NoiseBounds, delay: BaseDelay) -> NoiseBounds {
    actuators(config, delay).widen(sensed, &config.drive(), &config.limits(), config.number(&param::PERIOD))
}

/// The bounds of a certificate, under their JSON keys; `None` for a quantity without a bound.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct CertifiedBounds {
    /// Distance to the goal that the true pose reaches.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) capture_radius_m: Option<f64>,
    /// Heading error above which the local law decreases it at every tick.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) final_heading_bound_deg: Option<f64>,
    /// Maximum true distance to the goal afterwards.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) final_position_bound_m: Option<f64>,
}

impl CertifiedBounds {
    /// Returns the bounds of a certificate.
    pub(crate) fn from_certificate(certificate: &Certificate) -> Self {
        let heading = certificate.terminal_phase.and_then(|terminal_phase| terminal_phase.heading_bound);
        Self {
            capture_radius_m: certificate.capture_radius,
            final_heading_bound_deg: heading.map(f64::to_degrees),
            final_position_bound_m: certificate.final_position_bound,
        }
    }

    /// Returns whether every quantity that `others` bounds is bounded here as well.
    pub(crate) fn keep(&self, others: &Self) -> bool {
        let listed = |bounds: &Self| {
            [bounds.capture_radius_m, bounds.final_heading_bound_deg, bounds.final_position_bound_m]
        };
        listed(self).iter().zip(listed(others)).all(|(own, other)| own.is_some() || other.is_none())
    }
}

/// Returns the certified bounds of the loop with another law; `None` if the certificate is refused.
pub(crate) fn bounds(config: &Config, law: &Law<f64>, noise: NoiseBounds) -> Option<CertifiedBounds> {
    let (controller, period, rests_within) = loop_of(config);
    let certificate =
        asked((DeployedController { law: *law, ..controller }, period, rests_within), noise, 0.0, certify);
    certificate.certified.then(|| CertifiedBounds::from_certificate(&certificate))
}

/// Returns the warnings for a configuration, as sentences.
///
/// A test certifies the default loop; any other loop is certified here, which takes about 1 s.
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
                "loop: not certified for noise bounds of {POSITION_NOISE} m and {HEADING_NOISE_DEG}°: {reason}; see \
                 `surepose certify`"
            ));
        }
    }
    warnings
}

/// Returns the expected decrease for white Gaussian noise, with the bounds of `noise` as standard deviations.
///
/// Returns `None` if no decrease is proven at any distance.
pub(crate) fn average(config: &Config, noise: NoiseBounds) -> Option<Drift> {
    asked(loop_of(config), noise, 0.0, drift)
}

/// Resolution of the margin plots: cells per quadrant and boxes per cell. Cells are 5°, or 10° if the certificate is
/// refused, because gaps take the full effort in each cell.
const MARGIN: (usize, usize) = (18, 8);
const MARGIN_WITH_GAPS: (usize, usize) = (9, 8);

/// Computes the decrease margins of a certificate; `watch` receives the progress in \[0, 1] and returns whether to continue.
///
/// Returns `None` if `watch` cancels the computation.
pub(crate) fn margin(
    config: &Config,
    noise: NoiseBounds,
    certificate: &Certificate,
    watch: impl FnMut(f64) -> bool,
) -> Option<Margins> {
    let fineness = if certificate.certified { MARGIN } else { MARGIN_WITH_GAPS };
    asked(loop_of(config), noise, 0.0, |request| margins(request, certificate, fineness, watch))
}

/// Builds the request for a loop and passes it to `answer`.
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

/// Returns the controller, the period \[s] and the estimated distance within which the robot may rest \[m].
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
