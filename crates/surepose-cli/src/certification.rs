//! What the certificate says of the loop in use: for `certify`, and for the commands that warn without it.

use surepose::{Law, param};
use surepose_cert::{Certificate, Noise, Request, Shipped, certify};
use surepose_data::Config;
use surepose_lab::tune::Candidate;

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
    let (subject, period) = loop_of(config);
    judge(&subject, period, config.gains().h, noise, LONGEST_PERIOD)
}

/// Whether the configured loop is certified, with this law instead of its own.
pub(crate) fn holds(config: &Config, law: &Law<f64>, noise: Noise) -> bool {
    let (subject, period) = loop_of(config);
    judge(&Shipped { law: *law, ..subject }, period, Candidate::of(law).gains.h, noise, 0.0).certified
}

/// What is to be said of this configuration before it drives anything.
///
/// The default loop is certified by a test; any other is judged here, which takes about a second.
pub(crate) fn warnings(config: &Config) -> Vec<String> {
    let mut warnings = config.warnings();
    if loop_of(config) != loop_of(&Config::default().fitted()) {
        let noise =
            Noise { position: POSITION_NOISE, heading: HEADING_NOISE_DEG.to_radians(), ..Noise::default() };
        let (subject, period) = loop_of(config);
        if let Some(reason) = judge(&subject, period, config.gains().h, noise, 0.0).reason {
            warnings.push(format!(
                "this loop is not certified for {POSITION_NOISE} m and {HEADING_NOISE_DEG}° of noise: {reason}; see \
                 `surepose certify`"
            ));
        }
    }
    warnings
}

fn judge(subject: &Shipped, period: f64, h: f64, noise: Noise, longest_period: f64) -> Certificate {
    certify(&Request {
        subject,
        drive: subject.drive,
        limits: subject.limits,
        h,
        period,
        noise,
        workspace: WORKSPACE,
        largest_capture_radius: LARGEST_CAPTURE_RADIUS,
        longest_period,
    })
}

/// All that the certificate is about.
fn loop_of(config: &Config) -> (Shipped, f64) {
    let subject = Shipped { law: config.law(), drive: config.drive(), limits: config.limits() };
    (subject, config.number(&param::PERIOD))
}
