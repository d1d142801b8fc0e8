//! `surepose certify`: proves that the closed loop reaches the goal, for given gains, period and noise bounds.

mod average;
mod slow_wheels;
mod statement;

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;
use serde_json::{Map, Value as Json, json};
use surepose_cert::{Certificate, Counterexample, Margins, NoiseBounds};
use surepose_config::Config;
use surepose_figures as picture;

use crate::certification::{BaseDelay, CertifiedBounds};
use crate::error::CliError;
use crate::exit::Exit;
use crate::output::{Output, table, worded, wrapped};
use crate::output_dir::OutputDir;
use crate::settings::LawArgs;
use crate::{certification, interrupt, progress};
use slow_wheels::SlowWheels;

/// Prove that the closed loop reaches the goal: the deployed law, evaluated in interval arithmetic
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  surepose certify --noise-position 0.007 --noise-heading 0.25
  surepose certify --set law.k_v=10 --set law.k_alpha=100 --set law.h=1   refused, with the reason
  surepose certify --out certificate                                      plots of the decrease margin
  surepose certify --delay 0.04                                           a base that is later than configured
  surepose certify --gaussian --noise-position 0.005 --noise-heading 0.3  expected decrease under white noise

The noise options are bounds: any error within them may occur at every tick. Minimum speeds and delay are those of the \
configuration. The output lists what the proof assumes: the acceleration limit is not part of it.

Files in --out: margin and margin_over_distance, as SVG and PNG: the smallest proven decrease rate of W over the bearing and \
the direction of approach, and where no decrease was proven; margin.csv with the same numbers; summary.json, the JSON result \
without wall_s; counterexample_drive.csv, if a drive leaves the bounds.

The proof is that of wheels that follow at once. A search then drives the shipped controller, with its limit of the acceleration, \
against adversarial errors. If a drive leaves the bounds, the certificate is refused; if none does, nothing more is proved.

With --gaussian the noise options are standard deviations of white Gaussian noise. No bound then holds for all time: outside \
the printed radius W decreases in expectation, and the expected time to reach that radius is bounded. The output lists what \
this statement does not cover.

Exit codes: 0 certified; 1 refused; 2 usage or configuration error; 130 interrupted.")]
pub(crate) struct CertifyCommand {
    /// The control period, in seconds; overrides loop.period_s
    /// Time between two ticks, in seconds, over the configuration's
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    period: Option<String>,
    #[command(flatten)]
    noise: NoiseArgs,
    /// The time after which the base executes a command, in seconds, over robot.command_delay_s; the controller predicts over the latter
    #[arg(long, value_name = "S", value_parser = delay, allow_negative_numbers = true)]
    delay: Option<f64>,
    /// Take the noise options as standard deviations of white Gaussian noise (per coordinate, of the heading, per rim)
    #[arg(long, conflicts_with = "out")]
    gaussian: bool,
    /// A directory for plots of the decrease margin; they take about half a minute
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    config: LawArgs,
}

/// The noise bounds at every tick.
#[derive(Clone, Copy, Debug, Args)]
pub(super) struct NoiseArgs {
    /// Bound of the position error, in meters
    #[arg(long = "noise-position", value_name = "M", default_value_t = certification::POSITION_NOISE, value_parser = bound, allow_negative_numbers = true)]
    position: f64,
    /// Bound of the heading error, in degrees
    #[arg(long = "noise-heading", value_name = "DEG", default_value_t = certification::HEADING_NOISE_DEG, value_parser = heading_bound, allow_negative_numbers = true)]
    heading: f64,
    /// Bound of the rim-speed error of each wheel, in meters per second
    #[arg(long = "noise-speed", value_name = "M_S", default_value_t = 0.0, value_parser = bound, allow_negative_numbers = true)]
    speed: f64,
    /// Bound of the rim-speed error of each wheel, as a fraction of the speed: 0.05 is 5 %
    #[arg(long = "noise-speed-part", value_name = "PART", default_value_t = 0.0, value_parser = bound, allow_negative_numbers = true)]
    speed_part: f64,
}

impl NoiseArgs {
    /// Returns the bounds in SI units and radians.
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
    bound.ok_or_else(|| "expected a number from 0 to 1000".to_owned())
}

fn delay(text: &str) -> Result<f64, String> {
    let delay = text.parse::<f64>().ok().filter(|delay| (0.0..=2.0).contains(delay));
    delay.ok_or_else(|| "expected seconds from 0 to 2".to_owned())
}

fn heading_bound(text: &str) -> Result<f64, String> {
    let bound = text.parse::<f64>().ok().filter(|bound| (0.0..180.0).contains(bound));
    bound.ok_or_else(|| "expected degrees from 0 to less than 180°".to_owned())
}

impl CertifyCommand {
    pub(crate) fn run(self, output: Output) -> Result<Exit, CliError> {
        let mut config = self.config.over(Config::default())?;
        if let Some(period) = &self.period {
            config = config.with_option_of("--period", &format!("loop.period_s={period}"))?;
        }
        let sensed = self.noise.bounds();
        let delay = self.delay.map_or(BaseDelay::Configured, BaseDelay::Given);
        let noise = certification::with_actuators(&config, sensed, delay);
        let assumptions = statement::assumptions(&config, sensed, delay, self.gaussian);
        if self.gaussian {
            return average::run(&config, noise, &assumptions, output);
        }
        // Checked before the computation: an output directory that is not writable must not discard a result.
        let folder = self.out.as_deref().map(OutputDir::at).transpose()?;
        let certificate = certification::certificate(&config, noise);
        let mut json = json_of(&certificate);
        if certificate.certified {
            statement::add_reached_bounds(&mut json, &config, noise);
        }
        let slow_wheels =
            SlowWheels::search(&config, sensed, certification::actuators(&config, delay), &certificate);
        if let Some(found) = &slow_wheels {
            found.add_to(&mut json);
        }
        let certified = certificate.certified && slow_wheels.as_ref().is_none_or(SlowWheels::is_kept);
        json.insert("assumptions".to_owned(), json!(assumptions));
        // A result is printed even if its files cannot be written.
        let written: Result<(), CliError> = folder.as_ref().map_or(Ok(()), |folder| {
            folder.summary(&json)?;
            slow_wheels.iter().try_for_each(|found| found.write(folder))?;
            draw(folder, &config, noise, &certificate, output)?;
            if interrupt::asked() {
                interrupt::mark(&mut json);
                folder.summary(&json)?;
            }
            Ok(())
        });
        output.result(&json, || {
            let mut table = table(&[]);
            let mut shown = json.clone();
            shown.remove("counterexample");
            shown.remove("assumptions");
            let drive = shown.remove("counterexample_drive");
            for row in worded(&shown, &WORDS) {
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
            if let Some(drive) = drive {
                table.add_row(["counterexample".to_owned(), slow_wheels::described(&drive)]);
            }
            for (k, words) in assumptions.iter().enumerate() {
                table.add_row([if k == 0 { "assumed" } else { "" }, words]);
            }
            if let Some(path) = &self.out {
                table.add_row(["output".to_owned(), path.display().to_string()]);
            }
            wrapped(table)
        })?;
        written?;
        Ok(match certified {
            _ if interrupt::asked() => Exit::Interrupted,
            true => Exit::Done,
            false => Exit::Negative,
        })
    }
}

/// Writes the plots of the decrease margin, unless Ctrl-C interrupts their computation.
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

/// A cell of the margin plots: the center angles and the proven decrease rates; `None` if no decrease was proven.
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

/// Table labels of the keys of the certificate.
const WORDS: [(&str, &str); 16] = [
    ("certified", "certified"),
    ("capture_radius_m", "capture radius: comes within this distance of the goal [m]"),
    ("decrease_rate_per_s", "decrease rate of W, minimum [1/s]"),
    ("time_bound_s", "time to the capture radius, maximum [s]"),
    ("max_period_s", "longest tick with a proven capture within 15 cm [s]"),
    ("final_heading_bound_deg", "heading error that the local law keeps, b [°]"),
    ("heading_length_m", "above b, √(θ_e² + (x/ℓ)²) falls at every tick of it: ℓ [m]"),
    ("final_position_bound_m", "position error after capture, bound [m]"),
    ("reached_position_bound_m", "position error when reached is declared, bound [m]"),
    ("reached_heading_bound_deg", "heading error when reached is declared, bound [°]"),
    ("switch_keeps_its_mind", "law switch has hysteresis"),
    ("switch_dwell_ticks", "law switch, minimum dwell [ticks]"),
    ("searched_kept_out_m", "kept out at, worst drive with slow wheels found [m]"),
    ("searched_final_position_m", "distance after capture, worst such drive [m]"),
    ("boxes", "boxes evaluated"),
    ("wall_s", "computing time [s]"),
];

/// Returns the certificate under the documented JSON keys; values that were not proven are absent.
fn json_of(certificate: &Certificate) -> Map<String, Json> {
    let CertifiedBounds { capture_radius_m, final_heading_bound_deg, final_position_bound_m } =
        CertifiedBounds::from_certificate(certificate);
    let heading = certificate.terminal_phase.filter(|phase| phase.heading_bound.is_some());
    let numbers = [
        ("capture_radius_m", capture_radius_m),
        ("decrease_rate_per_s", certificate.decrease_rate),
        ("time_bound_s", certificate.time_bound),
        ("max_period_s", certificate.max_period),
        ("final_heading_bound_deg", final_heading_bound_deg),
        ("heading_length_m", heading.map(|phase| phase.length)),
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
        "at {:.3} m, {:.3} m, {:.1}°: W increases from {:.3} to {:.3} in one tick",
        at.x,
        at.y,
        at.heading.to_degrees(),
        then.lyapunov_before,
        then.lyapunov_after
    )
}
