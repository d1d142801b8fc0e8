//! What the certificate says of the loop in use: for `certify`, and for the commands that warn without it.

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

/// Whether the configured loop is certified, with this law instead of its own.
pub(crate) fn holds(config: &Config, law: &Law<f64>, noise: Noise) -> bool {
    let (subject, period, rests_within) = loop_of(config);
    asked((Shipped { law: *law, ..subject }, period, rests_within), noise, 0.0, certify).certified
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
    let subject = Shipped { law: config.law(), drive: config.drive(), limits: config.limits() };
    let tolerance = config.controller().tolerance;
    (subject, config.number(&param::PERIOD), tolerance.position * tolerance.release)
}
