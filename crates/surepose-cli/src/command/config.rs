//! `surepose config`: checks, shows and explains the configuration, and documents its parameters.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use serde_json::{Map, Value as Json, json};
use surepose_config::{Config, ConfigError, ConfigProblem, Setting, json_schema, parameter, reference_page};
use surepose_sim::robot::Scenario;
use surepose_sim::world_parameters::world_parameters;

use crate::certification;
use crate::error::CliError;
use crate::exit::Exit;
use crate::explanation::{self, json_of, name, shown};
use crate::output::{Output, say, table, text, warning};
use crate::settings::{ConfigArgs, toml_of};

/// Check, show or explain the configuration.
#[derive(Debug, Args)]
pub(crate) struct ConfigCommand {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    /// Check a configuration; reports every problem with its line and its remedy
    #[command(after_help = "Example: surepose config check robot.toml

With --json the problems are listed as {file, line, message, help}.

Exit codes: 0 valid; 2 invalid.")]
    Check(Source),
    /// Print every parameter in effect, with the origin of its value, as TOML
    #[command(after_help = "Example: surepose config show --config robot.toml --set law.k_v=3

The output is a valid configuration file. Gains that are not set are commented out, because they are fitted to the period \
and the wheels of the file; without the leading # they are fixed.

Exit codes: 0 done; 2 invalid configuration.")]
    Show(Source),
    /// Explain one parameter: meaning, unit, default, bounds and the reason for the bounds
    #[command(after_help = "Example: surepose config explain capture_radius_m

Exit codes: 0 done; 2 unknown or ambiguous name.")]
    Explain {
        /// The parameter: KEY or SECTION.KEY
        name: String,
    },
    /// Print the JSON Schema of the configuration file (draft 2020-12)
    #[command(after_help = "Example: surepose config schema > surepose.schema.json

A TOML file whose first line is `#:schema ./surepose.schema.json` is completed and checked by editors with Taplo or Tombi.

Exit codes: 0 done.")]
    Schema,
    /// Print the reference page of all parameters, in Markdown
    #[command(after_help = "Example: surepose config reference > docs/parameters.md

Exit codes: 0 done.")]
    Reference,
}

#[derive(Debug, Args)]
struct Source {
    /// The configuration file, the same as --config
    #[arg(value_name = "FILE", conflicts_with = "config")]
    file: Option<PathBuf>,
    #[command(flatten)]
    config: ConfigArgs,
}

impl Source {
    fn read(self) -> Result<Config, CliError> {
        let Self { file, config: ConfigArgs { config, set } } = self;
        ConfigArgs { config: file.or(config), set }.over(Config::default())
    }
}

impl ConfigCommand {
    pub(crate) fn run(self, output: Output) -> Result<Exit, CliError> {
        match self.what {
            What::Check(source) => match source.read() {
                Ok(config) => {
                    check(output, &config.fitted())?;
                    Ok(Exit::Done)
                }
                Err(failure) => {
                    if let (true, CliError::Config(error)) = (output.json, &failure) {
                        text(&format!("{}\n", invalid(error)))?;
                    }
                    Err(failure)
                }
            },
            What::Show(source) => {
                show(output, &source.read()?.fitted())?;
                Ok(Exit::Done)
            }
            What::Explain { name } => explain(output, &name),
            What::Schema => {
                text(&format!("{:#}\n", json_schema()))?;
                Ok(Exit::Done)
            }
            What::Reference => {
                text(&reference_page())?;
                Ok(Exit::Done)
            }
        }
    }
}

/// Returns the problems of a configuration as JSON.
fn invalid(error: &ConfigError) -> Json {
    let listed = |problem: &ConfigProblem| {
        let mut json = Map::new();
        json.insert("file".to_owned(), json!(error.file.display().to_string()));
        let parts = [
            ("line", problem.line.map(|line| json!(line))),
            ("message", Some(json!(problem.what))),
            ("help", problem.help.as_ref().map(|help| json!(help))),
        ];
        json.extend(parts.into_iter().filter_map(|(key, value)| Some((key.to_owned(), value?))));
        json
    };
    json!({ "valid": false, "problems": error.problems.iter().map(listed).collect::<Vec<_>>() })
}

fn check(output: Output, config: &Config) -> Result<(), CliError> {
    let mut warnings = certification::warnings(config);
    let refused = Scenario::configured(config.clone()).check_clearance().err();
    warnings.extend(refused.map(|problem| format!("[scenario]: rejected by `surepose run`: {problem}")));
    for said in &warnings {
        warning(said);
    }
    let json = Map::from_iter([("valid".to_owned(), json!(true)), ("warnings".to_owned(), json!(warnings))]);
    output.result(&json, || {
        let set = config.settings().iter().filter(|s| s.origin != surepose_config::ValueSource::Default);
        let mut table = table(&["parameter", "value", "from"]);
        for setting in set {
            table.add_row([name(setting.parameter), shown(setting), setting.origin.to_string()]);
        }
        if table.is_empty() {
            table.add_row(["all parameters", "default", "default"]);
        }
        table
    })?;
    if !output.json {
        let doubts = match warnings.len() {
            0 => String::new(),
            1 => ", with a warning".to_owned(),
            several => format!(", with {several} warnings"),
        };
        say(&format_args!("valid{doubts}"));
    }
    Ok(())
}

fn show(output: Output, config: &Config) -> Result<(), CliError> {
    if output.json {
        let entry = |setting: &Setting| {
            let value = json_of(&setting.value);
            let unit = setting.parameter.unit.symbol();
            let entry = json!({ "value": value, "unit": unit, "from": setting.origin.to_string() });
            (name(setting.parameter), entry)
        };
        let all: Map<String, Json> = config.settings().iter().map(entry).collect();
        return text(&format!("{}\n", Json::Object(all)));
    }
    text(&toml_of(config))
}

fn explain(output: Output, wanted: &str) -> Result<Exit, CliError> {
    let of_the_world = |help| world_parameters().find_by_name(wanted).ok_or(help);
    let p = parameter(wanted).or_else(of_the_world).map_err(|help| CliError::Usage {
        what: format!("parameter: unknown or ambiguous name (got '{wanted}')"),
        help,
    })?;
    if output.json {
        text(&format!("{}\n", explanation::as_json(p)))?;
    } else {
        text(&explanation::as_text(p))?;
    }
    Ok(Exit::Done)
}
