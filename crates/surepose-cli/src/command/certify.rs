//! `surepose certify`: whether the robot is sure to arrive, for these gains, this period and this noise.

mod average;

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;
use serde_json::{Map, Value as Json, json};
use surepose_cert::{Certificate, Counterexample, Margins, NoiseBounds};
use surepose_config::Config;
use surepose_figures as picture;

use crate::certification::CertifiedBounds;
use crate::error::CliError;
use crate::exit::Exit;
use crate::output::{Output, table, worded, wrapped};
use crate::output_dir::OutputDir;
use crate::settings::LawArgs;
use crate::{certification, interrupt, progress};

/// Certify that the loop arrives: the shipped law, evaluated with intervals.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  surepose certify --noise-position 0.007 --noise-heading 0.25
  surepose certify --set law.k_v=10 --set law.k_alpha=100 --set law.h=1   refused, with the reason
  surepose certify --out certificate                                      pictures of the margin
  surepose certify --gaussian --noise-position 0.005 --noise-heading 0.3  white noise, on average

Noise is bounded, in any direction, at every tick. The wheels are taken to follow their commands at once.

Written to --out: margin and margin_over_distance, as SVG and PNG: how fast W falls at the least, over how the goal is \
seen (margin.csv has their numbers), and where that was not shown; summary.json, the JSON of the command without wall_s.

--gaussian takes the noise options as standard deviations. No bound holds for ever then; W falls on average outside of \
the radius that is told, and the expected time of coming within it is bounded. What that leaves out is told with it.

Exit codes: 0 certified, 1 refused, 130 interrupted.")]
pub(crate) struct CertifyCommand {
    /// Time between two ticks, in seconds, over the configuration's
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    period: Option<String>,
    #[command(flatten)]
    noise: NoiseArgs,
    /// Take the noise options as standard deviations of white Gaussian noise (of each coordinate, of the heading, of each rim)
    #[arg(long, conflicts_with = "out")]
    gaussian: bool,
    /// A folder for pictures of the margin; they take half a minute more
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    config: LawArgs,
}

/// What may go wrong at every tick.
#[derive(Clone, Copy, Debug, Args)]
pub(super) struct NoiseArgs {
    /// Bound of the position error, in metres
    #[arg(long = "noise-position", value_name = "M", default_value_t = certification::POSITION_NOISE, value_parser = bound, allow_negative_numbers = true)]
    position: f64,
    /// Bound of the heading error, in degrees
    #[arg(long = "noise-heading", value_name = "DEG", default_value_t = certification::HEADING_NOISE_DEG, value_parser = heading_bound, allow_negative_numbers = true)]
    heading: f64,
    /// Bound of each rim's speed error, in metres per second
    #[arg(long = "noise-speed", value_name = "M_S", default_value_t = 0.0, value_parser = bound, allow_negative_numbers = true)]
    speed: f64,
    /// Bound of each rim's speed error, as a part of that speed: 0.05 is 5 %
    #[arg(long = "noise-speed-part", value_name = "PART", default_value_t = 0.0, value_parser = bound, allow_negative_numbers = true)]
    speed_part: f64,
}

impl NoiseArgs {
    /// The same, in radians.
    pub(super) fn bounds(self) -> NoiseBounds {
        NoiseBounds {
            position: self.position,
            heading: self.heading.to_radians(),
            rim_speed: self.speed,
            rim_speed_part: self.speed_part,
        }
    }
}

fn bound(text: &str) -> Result<f64, String> {
    let bound = text.parse::<f64>().ok().filter(|bound| (0.0..=1000.0).contains(bound));
    bound.ok_or_else(|| "write a number from 0 to 1000".to_owned())
}

fn heading_bound(text: &str) -> Result<f64, String> {
    let bound = text.parse::<f64>().ok().filter(|bound| (0.0..180.0).contains(bound));
    bound.ok_or_else(|| "write degrees, from 0 to less than 180°".to_owned())
}

impl CertifyCommand {
    pub(crate) fn run(self, output: Output) -> Result<Exit, CliError> {
        let mut config = self.config.over(Config::default())?;
        if let Some(period) = &self.period {
            config = config.with_option_of("--period", &format!("loop.period_s={period}"))?;
        }
        let noise = self.noise.bounds();
        if self.gaussian {
            return average::run(&config, noise, output);
        }
        // A folder that cannot be written to is found before the work, not after it.
        let folder = self.out.as_deref().map(OutputDir::at).transpose()?;
        let certificate = certification::certificate(&config, noise);
        let mut json = json_of(&certificate);
        if let Some(folder) = &folder {
            folder.summary(&json)?;
            draw(folder, &config, noise, &certificate, output)?;
            if interrupt::asked() {
                interrupt::mark(&mut json);
                folder.summary(&json)?;
            }
        }
        output.result(&json, || {
            let mut table = table(&[]);
            let mut told = json.clone();
            told.remove("counterexample");
            for row in worded(&told, &WORDS) {
                table.add_row(row);
            }
            for (key, what) in
                [("final_heading_bound_deg", "heading"), ("final_position_bound_m", "position")]
            {
                if !json.contains_key(key) {
                    table.add_row([what, "not bounded"]);
                }
            }
            if let Some(found) = &certificate.counterexample {
                table.add_row(["counterexample".to_owned(), described(found)]);
            }
            if let Some(path) = &self.out {
                table.add_row(["written to".to_owned(), path.display().to_string()]);
            }
            wrapped(table)
        })?;
        Ok(match certificate.certified {
            _ if interrupt::asked() => Exit::Interrupted,
            true => Exit::Done,
            false => Exit::Negative,
        })
    }
}

/// Writes the pictures of the margin, unless the user does not wait for them.
fn draw(
    folder: &OutputDir,
    config: &Config,
    noise: NoiseBounds,
    certificate: &Certificate,
    output: Output,
) -> Result<(), CliError> {
    interrupt::listen();
    let bar = progress::bar(output, "margin");
    let margins = certification::margin(config, noise, certificate, |part| {
        progress::show(&bar, part);
        !interrupt::asked()
    });
    bar.finish_and_clear();
    let Some(margins) = margins else { return Ok(()) };
    let rises = certificate.counterexample.as_ref().map(|found| &found.disturbed_state);
    folder.picture("margin", &picture::margin(&margins, rises))?;
    folder.picture("margin_over_distance", &picture::margin_over_distance(&margins))?;
    folder.table("margin.csv", cells(&margins))
}

/// A cell of the margin's pictures: the middle of its angles, and the least fall that was shown; none where none was.
#[derive(Serialize)]
struct Cell {
    alpha_deg: f64,
    phi_deg: f64,
    nearest_per_s: Option<f64>,
    least_per_s: Option<f64>,
}

fn cells(margins: &Margins) -> impl Iterator<Item = Cell> {
    let least = margins.least();
    let side = least.side;
    let middle = move |k: usize| 360.0 * (k as f64 + 0.5) / side as f64 - 180.0;
    let shown = |fall: f64| (fall > 0.0).then_some(fall);
    margins.nearest.fall.iter().zip(least.fall).enumerate().map(move |(k, (nearest, least))| Cell {
        alpha_deg: middle(k / side),
        phi_deg: middle(k % side),
        nearest_per_s: shown(*nearest),
        least_per_s: shown(least),
    })
}

/// The certificate's keys in words.
const WORDS: [(&str, &str); 11] = [
    ("certified", "certified"),
    ("capture_radius_m", "comes within (capture radius) [m]"),
    ("decrease_rate_per_s", "W falls at least by [1/s]"),
    ("time_bound_s", "comes there in at most [s]"),
    ("max_period_s", "capture is shown at a period of [s]"),
    ("final_heading_bound_deg", "heading, while the local law is in charge [°]"),
    ("final_position_bound_m", "position, then within [m]"),
    ("switch_keeps_its_mind", "the switch keeps its mind"),
    ("switch_dwell_ticks", "for at least so many ticks"),
    ("boxes", "regions looked at"),
    ("wall_s", "computing time [s]"),
];

/// The certificate under the contract's keys; what was not shown is absent.
fn json_of(certificate: &Certificate) -> Map<String, Json> {
    let CertifiedBounds { capture_radius_m, final_heading_bound_deg, final_position_bound_m } =
        CertifiedBounds::from_certificate(certificate);
    let numbers = [
        ("capture_radius_m", capture_radius_m),
        ("decrease_rate_per_s", certificate.decrease_rate),
        ("time_bound_s", certificate.time_bound),
        ("max_period_s", certificate.max_period),
        ("final_heading_bound_deg", final_heading_bound_deg),
        ("final_position_bound_m", final_position_bound_m),
    ];
    let mut json = Map::new();
    json.insert("certified".to_owned(), json!(certificate.certified));
    for (key, value) in numbers {
        if let Some(value) = value {
            json.insert(key.to_owned(), json!(value));
        }
    }
    if let Some(terminal_phase) = certificate.terminal_phase {
        json.insert("switch_keeps_its_mind".to_owned(), json!(terminal_phase.has_switch_hysteresis()));
        json.insert("switch_dwell_ticks".to_owned(), json!(terminal_phase.switch_dwell));
    }
    json.insert("boxes".to_owned(), json!(certificate.boxes));
    json.insert("wall_s".to_owned(), json!(certificate.wall));
    if let Some(reason) = certificate.reason {
        json.insert("reason".to_owned(), json!(reason.to_string()));
    }
    if let Some(found) = &certificate.counterexample {
        json.insert("counterexample".to_owned(), disturbed_state(found));
    }
    json
}

fn disturbed_state(found: &Counterexample) -> Json {
    let Counterexample { disturbed_state: at, transition, .. } = found;
    json!({
        "x_m": at.x, "y_m": at.y, "heading_deg": at.heading.to_degrees(),
        "noise_x_m": at.noise_x, "noise_y_m": at.noise_y, "noise_heading_deg": at.noise_heading.to_degrees(),
        "noise_right_m_s": at.noise_right, "noise_left_m_s": at.noise_left,
        "v_m_s": transition.commanded.v, "omega_deg_s": transition.commanded.omega.to_degrees(),
        "w_before": transition.lyapunov_before, "w_after": transition.lyapunov_after,
        "wheel_limits": found.limited,
    })
}

fn described(found: &Counterexample) -> String {
    let (at, then) = (&found.disturbed_state, &found.transition);
    format!(
        "at {:.3} m, {:.3} m, {:.1}°: W goes from {:.3} to {:.3} in a tick",
        at.x,
        at.y,
        at.heading.to_degrees(),
        then.lyapunov_before,
        then.lyapunov_after
    )
}
