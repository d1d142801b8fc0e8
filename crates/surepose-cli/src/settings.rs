//! Options shared by several commands: the configuration and poses.

use std::fmt::{Display, Write as _};
use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::str::FromStr;

use clap::Args;
use surepose::geometry::{Angle, Body, Map, Pose};
use surepose::param::{self, Choice, LawName};
use surepose_config::{Config, Setting, Value, ValueSource};
use surepose_ros2::Names;

use crate::error::CliError;

/// The sources of the configuration.
#[derive(Clone, Debug, Default, Args)]
pub(crate) struct ConfigArgs {
    /// A TOML file with parameters; the others keep their defaults
    #[arg(long, value_name = "FILE")]
    pub(crate) config: Option<PathBuf>,

    /// Set one parameter, with priority over the file: law.k_v=3. May be repeated
    #[arg(long, value_name = "SECTION.KEY=VALUE")]
    pub(crate) set: Vec<String>,
}

impl ConfigArgs {
    /// Returns whether any configuration option is present.
    pub(crate) fn is_given(&self) -> bool {
        self.config.is_some() || !self.set.is_empty()
    }

    /// Returns `base` with the values of the file, then of the options, on top.
    pub(crate) fn over(&self, base: Config) -> Result<Config, CliError> {
        self.options_over(self.file_over(base)?)
    }

    /// Returns `base` with the values of the file on top.
    fn file_over(&self, base: Config) -> Result<Config, CliError> {
        Ok(match &self.config {
            Some(file) => base.with_file(file)?,
            None => base,
        })
    }

    /// Returns `base` with the values of the options on top.
    fn options_over(&self, base: Config) -> Result<Config, CliError> {
        let set = |config: Config, option: &String| config.with_option(option);
        Ok(self.set.iter().try_fold(base, set)?)
    }
}

/// The control law and the configuration.
#[derive(Clone, Debug, Default, Args)]
pub(crate) struct LawArgs {
    /// The control law: surepose or paper
    #[arg(long, value_name = "NAME")]
    law: Option<String>,
    #[command(flatten)]
    config: ConfigArgs,
}

impl LawArgs {
    /// Returns `base` with the values of the file, then of the options, on top.
    pub(crate) fn over(&self, base: Config) -> Result<Config, CliError> {
        self.options_over(self.file_over(base)?)
    }

    /// Returns `base` with the values of the file on top.
    pub(crate) fn file_over(&self, base: Config) -> Result<Config, CliError> {
        self.config.file_over(base)
    }

    /// Returns `base` with the values of the options on top.
    pub(crate) fn options_over(&self, base: Config) -> Result<Config, CliError> {
        let config = self.config.options_over(base)?;
        let Some(name) = &self.law else { return Ok(config) };
        let set = config.choice::<LawName>().name();
        if config.origin(&param::LAW_NAME) == ValueSource::CommandLine && set != name {
            let what = format!("--law: conflicting control laws (got --law {name} and --set law.name={set})");
            return Err(CliError::Usage { what, help: "leave out one of the two options".to_owned() });
        }
        Ok(config.with_option_of("--law", &format!("law.name={name}"))?)
    }
}

/// A pose on the command line: `X,Y,DEG`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PoseArg {
    /// Position along the x axis of the map \[m].
    pub(crate) x: f64,
    /// Position along the y axis of the map \[m].
    pub(crate) y: f64,
    /// Heading, counter-clockwise from the x axis \[°].
    pub(crate) heading_deg: f64,
}

impl PoseArg {
    /// Returns the pose of the robot in the map.
    pub(crate) fn pose(self) -> Pose<Map, Body, f64> {
        Pose::new(self.x, self.y, Angle::from_degrees(self.heading_deg))
    }

    /// Returns the values with the suffixes of their configuration keys.
    pub(crate) fn keys(&self) -> [(&'static str, f64); 3] {
        [("x_m", self.x), ("y_m", self.y), ("heading_deg", self.heading_deg)]
    }
}

impl FromStr for PoseArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        const SHAPE: &str = "expected X,Y,DEG in meters, meters and degrees, for example 2,2,30";
        let numbers: Vec<f64> = text
            .split(',')
            .map(|part| part.trim().parse().map_err(|_| SHAPE.to_owned()))
            .collect::<Result<_, _>>()?;
        let [x, y, heading_deg] = numbers[..] else { return Err(SHAPE.to_owned()) };
        if ![x, y].iter().all(|v| v.abs() <= 1e4) || heading_deg.is_nan() || heading_deg.abs() > 360.0 {
            return Err(
                "pose out of range; expected positions within ±10000 m and a heading within ±360°".to_owned()
            );
        }
        Ok(Self { x, y, heading_deg })
    }
}

/// Parses the `--remap` options of a recording.
pub(crate) fn names_of(remap: &[String]) -> Result<Names, CliError> {
    Names::new("/", remap).map_err(|error| CliError::Usage {
        what: error.to_string(),
        help: "use the form FROM:=TO, for example --remap odom:=/base/odom".to_owned(),
    })
}

/// Returns a parser for an integer option within `range`.
pub(crate) fn whole<T>(range: RangeInclusive<T>) -> impl Fn(&str) -> Result<T, String> + Clone + Send + Sync
where
    T: FromStr + PartialOrd + Display + Clone + Send + Sync,
{
    move |text| {
        let number = text.parse().ok().filter(|number| range.contains(number));
        number.ok_or_else(|| format!("expected an integer from {} to {}", range.start(), range.end()))
    }
}

/// Formats every value as TOML, with its origin as a comment.
///
/// Fitted gains are commented out, so that they are fitted again when the file is changed.
pub(crate) fn toml_of(config: &Config) -> String {
    toml_of_those(config, |_| true)
}

/// Formats the `chosen` values as TOML, with their origins as comments.
pub(crate) fn toml_of_those(config: &Config, chosen: impl Fn(&Setting) -> bool) -> String {
    let (mut toml, mut section) = (String::new(), "");
    for setting in config.settings().iter().filter(|setting| chosen(setting)) {
        let p = setting.parameter;
        if p.section != section {
            section = p.section;
            let gap = if toml.is_empty() { "" } else { "\n" };
            let _ = writeln!(toml, "{gap}[{section}]");
        }
        let value = match &setting.value {
            Value::Number(number) => number.to_string(),
            Value::Choice(choice) => format!("\"{choice}\""),
            polygon @ Value::Polygon(_) => polygon.to_string(),
        };
        // Fitted values are printed as comments, so that they stay fitted.
        let (mark, said) = match setting.origin.follows() {
            Some(said) => ("# ", said.to_owned()),
            None => ("", setting.origin.to_string()),
        };
        let line = format!("{mark}{} = {value}", p.key);
        let _ = writeln!(toml, "{line:<40} # {said}");
    }
    toml
}
