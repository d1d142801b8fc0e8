//! `surepose tune`: searches certified gains that minimize the time to the goal.

mod certificates;

use std::path::{Path, PathBuf};
use std::time::Instant;

use certificates::Certificates;
use clap::Args;
use serde_json::{Map, Value as Json, json};
use surepose::control::{Gains, Law};
use surepose::param::{self, BrakingMode, Kind, Parameter};
use surepose_cert::NoiseBounds;
use surepose_config::{Config, ValueSource};
use surepose_montecarlo::sweep::{Precision, Quantiles, Starts, SweepReport};
use surepose_montecarlo::tune::{GainCandidate, STRESS, Tune, TuneProgress, TuneResult};

use crate::certification::CertifiedBounds;
use crate::error::CliError;
use crate::exit::Exit;
use crate::output::{Output, align_numbers, object, say, table, warning};
use crate::settings::{toml_of_those, whole};
use crate::{interrupt, output_dir, progress};

use super::certify::NoiseArgs;
use super::trials::{NoiseName, TrialArgs, Trials};

/// Find the gains and the capture radius with minimum time to the goal, full success and a certificate
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  surepose tune                                           period 0.02 s, noise of the bench
  surepose tune --out robot.toml                          write the result as a configuration file
  surepose tune --loop ekf --noise-position 0.004 --noise-heading 0.15 --json
  surepose tune --config robot.toml --rounds 24           continue from an earlier result

The objective is the sum of the median and the 95 % quantile of the time ratio (time divided by the minimum time). The \
figures before and after are from --runs trials that the search does not use; `surepose sweep --seed N` repeats them. A \
candidate is accepted only if, on those trials, success rate, median, 95 % quantile and slowest trial are no worse. It also \
needs a certificate for the noise bounds that bounds every quantity bounded before (capture radius, final position, final \
heading). From starts within 20 cm at 1.3 times the noise it may not lose more trials than before.

The trials use the bench robot, which has no acceleration limit: on a robot with a limit, other gains may be faster. --out \
writes the gains, the capture radius, the period and your own settings, but no parameters of the bench robot.

Exit codes: 0 certified gains found; 1 no candidate was certified; 2 usage or configuration error; 130 interrupted (the best \
candidate until then is kept).")]
pub(crate) struct TuneCommand {
    /// The number of trials that evaluate the result; the search does not use them
    #[arg(long, default_value_t = 20_000, value_parser = whole(1..=u32::MAX), allow_negative_numbers = true)]
    runs: u32,
    /// The number of search rounds, with 17 candidates each; 0 evaluates the initial gains
    #[arg(long, default_value_t = 12, value_parser = whole(0..=1000_u16), allow_negative_numbers = true)]
    rounds: u16,
    /// A file for the configuration with the tuned gains
    #[arg(long, value_name = "FILE.toml")]
    out: Option<PathBuf>,
    #[command(flatten)]
    bounds: NoiseArgs,
    #[command(flatten)]
    trials: TrialArgs,
}

/// Search range: factor below and above the initial gains.
const REACH: f64 = 20.0;

impl TuneCommand {
    pub(crate) fn run(self, output: Output) -> Result<Exit, CliError> {
        let trials = self.trials.read(NoiseName::Bench)?;
        let config = &trials.config;
        if trials.ignored_parameters(false).iter().any(|name| name.starts_with("robot.")) {
            warning("[robot]: used for the certificate only; the trials use the bench robot");
        }
        if let Some(path) = &self.out {
            output_dir::file_at(path)?;
        }
        let tune = self.tune(&trials);
        let noise = self.bounds.bounds();
        let certificates = Certificates::new(config, noise);
        // Every quantity that the initial certificate bounds must stay bounded.
        let had = certificates.bounds(&tune.sweep.law);
        let certified = |law: &Law<f64>| {
            let has = certificates.bounds(law);
            has.is_some_and(|has| had.is_none_or(|had| has.keep(&had)))
        };

        let (clock, progress, bar) =
            (Instant::now(), TuneProgress::default(), progress::bar(output, "tuning"));
        let part = || progress.completed() as f64 / (tune.rounds + 1) as f64;
        let work = || tune.run(&certified, &progress);
        let tuned = progress::attended(&bar, part, || progress.cancel(), work)?;

        // A result is printed even if its file cannot be written.
        let written = match (&self.out, &tuned.best) {
            (Some(path), Some(best)) => write(path, &config.clone().with_preset(TUNED, &values(best)), noise),
            _ => Ok(()),
        };
        let has = tuned.best.and_then(|best| certificates.bounds(&best.with(&tune.sweep.law)));
        let mut json = json_of(&tuned, [had, has], clock.elapsed().as_secs_f64(), self.trials.seed);
        json.extend(trials.described().map(|(key, value)| (key.to_owned(), value)));
        interrupt::mark(&mut json);
        output.result(&json, || shown(&tuned, [had, has]))?;
        written?;
        match tuned.best {
            Some(best) if best != tuned.start => warning(
                "the trials have no acceleration limit; on a robot with a limit, other gains may be faster: compare with \
                 `surepose run --config`",
            ),
            Some(_) if !interrupt::asked() => {
                say(&"no better gains found; try more --rounds or another --seed");
            }
            _ => {}
        }
        Ok(match tuned.best {
            _ if interrupt::asked() => Exit::Interrupted,
            Some(_) => Exit::Done,
            None => {
                warning(
                    "no gains were certified for these noise bounds; try smaller bounds or a shorter period",
                );
                Exit::Negative
            }
        })
    }

    fn tune(&self, trials: &Trials<'_>) -> Tune {
        let sweep = trials.sweep(Starts::Random(self.runs as usize), Precision::F64);
        let start = GainCandidate::from_law(&sweep.law);
        let bound = |far: fn(f64, &Parameter) -> f64| {
            let [k_v, k_alpha, h, k_theta, capture_radius] =
                values(&start).map(|(parameter, value)| far(value, parameter));
            GainCandidate { gains: Gains { k_v, k_alpha, h, k_theta }, capture_radius }
        };
        Tune {
            fallback: GainCandidate {
                gains: Gains::for_loop(sweep.period, &trials.config.limits()),
                capture_radius: Config::default().number(&param::CAPTURE_RADIUS),
            },
            least: bound(|value, _| value / REACH),
            most: bound(|value, parameter| match parameter.kind {
                Kind::Number { range, .. } => (value * REACH).min(range.high),
                _ => value,
            }),
            rounds: usize::from(self.rounds),
            sweep,
        }
    }
}

/// Returns the tuned values by parameter.
fn values(candidate: &GainCandidate) -> [(&'static Parameter, f64); 5] {
    let Gains { k_v, k_alpha, h, k_theta } = candidate.gains;
    [
        (&param::K_V, k_v),
        (&param::K_ALPHA, k_alpha),
        (&param::H, h),
        (&param::K_THETA, k_theta),
        (&param::CAPTURE_RADIUS, candidate.capture_radius),
    ]
}

/// Writes the user's settings, the tuned values and the period they were tuned for.
///
/// The parameters of the bench robot are left out, so that the file keeps the limits of the robot that uses it.
fn write(path: &Path, config: &Config, noise: NoiseBounds) -> Result<(), CliError> {
    // Explicit gains disable braking within the wheel acceleration limit; the tuned ones need it on every robot.
    let config = match config.origin(&param::BRAKING) {
        ValueSource::Default => &config.clone().with_preset_choice(TUNED, BrakingMode::Even),
        _ => config,
    };
    let toml = toml_of_those(config, |setting| match setting.origin {
        ValueSource::File { .. } | ValueSource::CommandLine => true,
        ValueSource::Preset(name) => name == TUNED || setting.parameter == &param::PERIOD,
        ValueSource::Default => false,
    });
    output_dir::write_file(path, &format!("{HEADER}{toml}"))?;

    let written = Config::default().with_text(path, toml.as_bytes())?;
    if Certificates::new(&written, noise).bounds(&written.law()).is_none() {
        let found = if interrupt::asked() {
            "it was not checked whether these gains are"
        } else {
            "these gains are not"
        };
        warning(&format!(
            "{}: this robot differs from the bench robot, and for it {found} certified for these noise bounds; check with \
             `surepose certify --config`",
            path.display()
        ));
    }
    Ok(())
}

/// The origin of tuned values.
const TUNED: &str = "tuned";

/// The comment at the top of a tuned configuration.
const HEADER: &str = "\
# Written by `surepose tune` for the bench robot, which has no acceleration limit. On a robot with a limit, other gains
# may be faster: compare with `surepose run --config`. Parameters that are not listed keep their defaults.

";

fn json_of(
    tuned: &TuneResult,
    bounds: [Option<CertifiedBounds>; 2],
    wall: f64,
    seed: u64,
) -> Map<String, Json> {
    let keyed = |candidate: &GainCandidate| -> Map<String, Json> {
        values(candidate)
            .into_iter()
            .map(|(parameter, value)| (parameter.key.to_owned(), json!(value)))
            .collect()
    };
    let mut json = tuned.best.as_ref().map(keyed).unwrap_or_default();
    json.insert("certified".to_owned(), json!(tuned.best.is_some()));
    json.insert("improved".to_owned(), json!(tuned.best.is_some_and(|best| best != tuned.start)));
    let mut start = keyed(&tuned.start);
    start.insert("certified".to_owned(), json!(tuned.start_certified));
    json.insert("start".to_owned(), Json::Object(start));
    json.insert("before".to_owned(), Json::Object(object(&tuned.before)));
    if let Some(after) = &tuned.after {
        json.insert("after".to_owned(), Json::Object(object(after)));
    }
    let bounds = ["before", "after"].into_iter().zip(bounds);
    let bounds = bounds.filter_map(|(when, bounds)| Some((when.to_owned(), Json::Object(object(&bounds?)))));
    json.insert("certificate".to_owned(), Json::Object(bounds.collect()));
    let stressed = [("before", tuned.stressed_success.0), ("after", tuned.stressed_success.1)];
    let stressed = stressed.into_iter().filter_map(|(when, rate)| Some((when.to_owned(), json!(rate?))));
    json.insert("stressed_success_rate".to_owned(), Json::Object(stressed.collect()));
    json.insert("candidates".to_owned(), json!(tuned.candidates));
    json.insert("certificates".to_owned(), json!(tuned.certificates));
    json.insert("wall_s".to_owned(), json!(wall));
    json.insert("seed".to_owned(), json!(seed));
    json
}

/// Selects a bound of a certificate.
type Bound = fn(CertifiedBounds) -> Option<f64>;

/// Selects a figure of a report.
type Figure = fn(&SweepReport) -> Option<Quantiles>;

fn shown(tuned: &TuneResult, bounds: [Option<CertifiedBounds>; 2]) -> comfy_table::Table {
    let mut table = table(&["", "before", "after"]);
    let best = tuned.best.map(|best| values(&best));
    for (k, (parameter, value)) in values(&tuned.start).into_iter().enumerate() {
        let after = best.map_or_else(|| "–".to_owned(), |best| format!("{:.4}", best[k].1));
        table.add_row([parameter.key.to_owned(), format!("{value:.4}"), after]);
    }
    let yes = |sure: bool| if sure { "yes" } else { "no" };
    table.add_row(["certified", yes(tuned.start_certified), yes(tuned.best.is_some())]);
    let certified: [(&str, Bound, f64); 3] = [
        ("capture radius [cm]", |bounds| bounds.capture_radius_m, 1e2),
        ("final position bound [cm]", |bounds| bounds.final_position_bound_m, 1e2),
        ("final heading bound [°]", |bounds| bounds.final_heading_bound_deg, 1.0),
    ];
    for (name, bound, factor) in certified {
        let [before, after] = bounds.map(|bounds| match bounds.map(bound) {
            Some(Some(value)) => format!("{:.2}", factor * value),
            Some(None) => "not bounded".to_owned(),
            None => "–".to_owned(),
        });
        table.add_row([format!("certified: {name}"), before, after]);
    }
    let of_both = |value: &dyn Fn(&SweepReport) -> Option<String>| {
        [Some(&tuned.before), tuned.after.as_ref()]
            .map(|report| report.and_then(value).unwrap_or_else(|| "–".to_owned()))
    };
    let [before, after] = of_both(&|report| Some(format!("{:.3} %", 1e2 * report.success_rate?)));
    table.add_row(["success".to_owned(), before, after]);
    let [before, after] = [tuned.stressed_success.0, tuned.stressed_success.1]
        .map(|rate| rate.map_or_else(|| "–".to_owned(), |rate| format!("{:.3} %", 1e2 * rate)));
    table.add_row([format!("success near the goal, {STRESS} × noise"), before, after]);
    let figures: [(&str, Figure, f64); 3] = [
        ("time / minimum time", |report| report.time_ratio, 1.0),
        ("final error [mm]", |report| report.final_position_error_m, 1e3),
        ("final error [°]", |report| report.final_heading_error_deg, 1.0),
    ];
    for (name, figure, factor) in figures {
        for (quantile, part) in [("p50", (|s| s.p50) as fn(Quantiles) -> f64), ("p95", |s| s.p95)] {
            let [before, after] = of_both(&|report| Some(format!("{:.3}", factor * part(figure(report)?))));
            table.add_row([format!("{name}, {quantile}"), before, after]);
        }
    }
    let [before, after] = of_both(&|report| Some(format!("{:.2}", report.time_s?.max)));
    table.add_row(["slowest trial [s]".to_owned(), before, after]);
    align_numbers(&mut table);
    table
}
