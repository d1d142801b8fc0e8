//! `surepose certify`: whether the robot is sure to arrive, for these gains, this period and this noise.

use clap::Args;
use serde_json::{Map, Value as Json, json};
use surepose_cert::{Certificate, Counterexample, Noise};
use surepose_data::Config;

use crate::certification;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::output::{Output, shown, table};
use crate::settings::ConfigArgs;

/// Certify that the loop arrives: the shipped law, evaluated with intervals.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  surepose certify --noise-position 0.007 --noise-heading 0.25
  surepose certify --set law.k_v=10 --set law.k_alpha=100 --set law.h=1     refused, with a counterexample

Noise is bounded, in any direction, at every tick. The wheels are taken to follow their commands at once.
Exit codes: 0 certified, 1 refused.")]
pub(crate) struct CertifyCommand {
    /// Time between two ticks, in seconds, over the configuration's
    #[arg(long, value_name = "S")]
    period: Option<f64>,
    #[command(flatten)]
    noise: NoiseArgs,
    #[command(flatten)]
    config: ConfigArgs,
}

/// What may go wrong at every tick.
#[derive(Clone, Copy, Debug, Args)]
pub(super) struct NoiseArgs {
    /// Bound of the position error, in metres
    #[arg(long = "noise-position", value_name = "M", default_value_t = certification::POSITION_NOISE, value_parser = bound)]
    position: f64,
    /// Bound of the heading error, in degrees
    #[arg(long = "noise-heading", value_name = "DEG", default_value_t = certification::HEADING_NOISE_DEG, value_parser = bound)]
    heading: f64,
    /// Bound of each rim's speed error, in metres per second
    #[arg(long = "noise-speed", value_name = "M_S", default_value_t = 0.0, value_parser = bound)]
    speed: f64,
}

impl NoiseArgs {
    /// The same, in radians.
    pub(super) fn bounds(self) -> Noise {
        Noise {
            position: self.position,
            heading: self.heading.to_radians(),
            rim_speed: self.speed,
            rim_speed_part: 0.0,
        }
    }
}

fn bound(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "write a number".to_owned())?;
    if (0.0..=1000.0).contains(&value) {
        Ok(value)
    } else {
        Err("a bound lies between 0 and 1000".to_owned())
    }
}

impl CertifyCommand {
    pub(crate) fn run(self, output: Output) -> Result<Exit, Failure> {
        let mut config = self.config.over(Config::default())?;
        if let Some(period) = self.period {
            config = config.with_option(&format!("loop.period_s={period}"))?;
        }
        let certificate = certification::certificate(&config, self.noise.bounds());
        let json = json_of(&certificate);
        output.result(&json, || {
            let mut table = table(&[]);
            for (key, value) in json.iter().filter(|(_, value)| !value.is_object()) {
                table.add_row([key.clone(), shown(value)]);
            }
            if let Some(found) = &certificate.counterexample {
                table.add_row(["counterexample".to_owned(), described(found)]);
            }
            table
        });
        Ok(if certificate.certified { Exit::Done } else { Exit::Negative })
    }
}

/// The certificate under the contract's keys; what was not shown is absent.
fn json_of(certificate: &Certificate) -> Map<String, Json> {
    let heading = certificate.settling.and_then(|settling| settling.heading_bound).map(f64::to_degrees);
    let numbers = [
        ("capture_radius_m", certificate.capture_radius),
        ("decrease_rate_per_s", certificate.decrease_rate),
        ("time_bound_s", certificate.time_bound),
        ("max_period_s", certificate.max_period),
        ("final_heading_bound_deg", heading),
        ("final_position_bound_m", certificate.final_position_bound),
    ];
    let mut json = Map::new();
    json.insert("certified".to_owned(), json!(certificate.certified));
    for (key, value) in numbers {
        if let Some(value) = value {
            json.insert(key.to_owned(), json!(value));
        }
    }
    if let Some(settling) = certificate.settling {
        json.insert("switch_keeps_its_mind".to_owned(), json!(settling.switch_keeps_its_mind()));
    }
    json.insert("boxes".to_owned(), json!(certificate.boxes));
    json.insert("wall_s".to_owned(), json!(certificate.wall));
    if let Some(reason) = certificate.reason {
        json.insert("reason".to_owned(), json!(reason.to_string()));
    }
    if let Some(found) = &certificate.counterexample {
        json.insert("counterexample".to_owned(), situation(found));
    }
    json
}

fn situation(found: &Counterexample) -> Json {
    let Counterexample { situation: at, consequence, .. } = found;
    json!({
        "x_m": at.x, "y_m": at.y, "heading_deg": at.heading.to_degrees(),
        "noise_x_m": at.noise_x, "noise_y_m": at.noise_y, "noise_heading_deg": at.noise_heading.to_degrees(),
        "noise_right_m_s": at.noise_right, "noise_left_m_s": at.noise_left,
        "v_m_s": consequence.told.v, "omega_deg_s": consequence.told.omega.to_degrees(),
        "w_before": consequence.weight_before, "w_after": consequence.weight_after,
        "wheel_limits": found.limited,
    })
}

fn described(found: &Counterexample) -> String {
    let (at, then) = (&found.situation, &found.consequence);
    format!(
        "at {:.3} m, {:.3} m, {:.1}°: W goes from {:.3} to {:.3} in a tick",
        at.x,
        at.y,
        at.heading.to_degrees(),
        then.weight_before,
        then.weight_after
    )
}
