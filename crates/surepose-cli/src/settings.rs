//! Options that many commands share: the configuration and poses.

use std::fmt::{Display, Write as _};
use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::str::FromStr;

use clap::Args;
use surepose::geometry::{Angle, Body, Map, Pose};
use surepose::param;
use surepose_config::{Config, Setting, Value, ValueSource};
use surepose_ros2::Names;

use crate::error::CliError;

/// Where the configuration comes from.
#[derive(Clone, Debug, Default, Args)]
pub(crate) struct ConfigArgs {
    /// A TOML file with parameters; the others keep their defaults
    #[arg(long, value_name = "FILE")]
    pub(crate) config: Option<PathBuf>,

    /// One parameter, over the file's: law.k_v=3. May be repeated
    #[arg(long, value_name = "SECTION.KEY=VALUE")]
    pub(crate) set: Vec<String>,
}

impl ConfigArgs {
    /// Whether anything was given.
    pub(crate) fn is_given(&self) -> bool {
        self.config.is_some() || !self.set.is_empty()
    }

    /// `base`, with the file's values and the options' over it.
    pub(crate) fn over(&self, base: Config) -> Result<Config, CliError> {
        let mut config = base;
        if let Some(file) = &self.config {
            config = config.with_file(file)?;
        }
        for option in &self.set {
            config = config.with_option(option)?;
        }
        Ok(config)
    }
}

/// Which law it is, and what is configured beside.
#[derive(Clone, Debug, Default, Args)]
pub(crate) struct LawArgs {
    /// The law: surepose or paper
    #[arg(long, value_name = "NAME")]
    law: Option<String>,
    #[command(flatten)]
    config: ConfigArgs,
}

impl LawArgs {
    /// `base`, with the file's values and the options' over it.
    pub(crate) fn over(&self, base: Config) -> Result<Config, CliError> {
        let config = self.config.over(base)?;
        let Some(name) = &self.law else { return Ok(config) };
        let set = config.choice(&param::LAW_NAME);
        if config.origin(&param::LAW_NAME) == ValueSource::CommandLine && set != name {
            let what = format!("--law {name} and --set law.name={set} are two laws");
            return Err(CliError::Usage { what, help: "leave one of them out".to_owned() });
        }
        Ok(config.with_option_of("--law", &format!("law.name={name}"))?)
    }
}

/// A pose on the command line: `X,Y,DEG`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PoseArg {
    /// \[m]
    pub(crate) x: f64,
    /// \[m]
    pub(crate) y: f64,
    /// \[°]
    pub(crate) heading_deg: f64,
}

impl PoseArg {
    /// The pose of the robot that it names.
    pub(crate) fn pose(self) -> Pose<Map, Body, f64> {
        Pose::new(self.x, self.y, Angle::from_degrees(self.heading_deg))
    }

    /// Its parts, under the ends of their keys.
    pub(crate) fn keys(&self) -> [(&'static str, f64); 3] {
        [("x_m", self.x), ("y_m", self.y), ("heading_deg", self.heading_deg)]
    }
}

impl FromStr for PoseArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        const SHAPE: &str = "write X,Y,DEG: metres, metres, degrees, for example 2,2,30";
        let numbers: Vec<f64> = text
            .split(',')
            .map(|part| part.trim().parse().map_err(|_| SHAPE.to_owned()))
            .collect::<Result<_, _>>()?;
        let [x, y, heading_deg] = numbers[..] else { return Err(SHAPE.to_owned()) };
        if ![x, y].iter().all(|v| v.abs() <= 1e4) || heading_deg.is_nan() || heading_deg.abs() > 360.0 {
            return Err("a pose lies within 10 km, its heading within 360°".to_owned());
        }
        Ok(Self { x, y, heading_deg })
    }
}

/// What the topics of a recording are called.
pub(crate) fn names_of(remap: &[String]) -> Result<Names, CliError> {
    Names::new("/", remap).map_err(|error| CliError::Usage {
        what: error.to_string(),
        help: "for example --remap odom:=/base/odom".to_owned(),
    })
}

/// Reads a whole number of an option, and says what would be one.
pub(crate) fn whole<T>(range: RangeInclusive<T>) -> impl Fn(&str) -> Result<T, String> + Clone + Send + Sync
where
    T: FromStr + PartialOrd + Display + Clone + Send + Sync,
{
    move |text| {
        let number = text.parse().ok().filter(|number| range.contains(number));
        number.ok_or_else(|| format!("write a whole number from {} to {}", range.start(), range.end()))
    }
}

/// Every value with where it came from, as TOML that can be read again; gains that are fitted are comments, so that they are
/// fitted again to what is changed in it.
pub(crate) fn toml_of(config: &Config) -> String {
    toml_of_those(config, |_| true)
}

/// The same of those values that are `chosen`; every other is left to whoever reads it.
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
        };
        // What follows other values is shown, and left to follow them.
        let (mark, said) = match setting.origin.follows() {
            Some(said) => ("# ", said.to_owned()),
            None => ("", setting.origin.to_string()),
        };
        let line = format!("{mark}{} = {value}", p.key);
        let _ = writeln!(toml, "{line:<40} # {said}");
    }
    toml
}
