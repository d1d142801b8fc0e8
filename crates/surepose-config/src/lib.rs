//! The configuration: a value for every parameter, with its origin.
//!
//! A value comes from the parameter table, a preset of a recording format, a line of a TOML file, or a command-line option;
//! the later one wins. Every value has passed the bounds of the table, so that the constants of the core can be built
//! without errors. [`build`](self) does so, in one place for all commands.

mod abort;
mod actuator_warnings;
mod build;
mod choice;
mod file;
mod key;
mod navigation;
mod problem;
mod reference;
mod schema;
mod setting;
#[cfg(test)]
mod tests;
mod warnings;

use std::path::Path;

use surepose::param::{self, Kind, Parameter};

pub use abort::describe_abort;
pub use build::{CompassParameters, LaserParameters};
pub use choice::ConfigChoice;
pub use key::{ParameterSet, parameter};
pub use navigation::{
    HISTORY, MAX_BEAMS, NavigatorSetup, RobotLocalizer, RobotNavigator, ScanMethod, beam_model,
};
pub use problem::{ConfigError, ConfigProblem};
pub use reference::reference_page;
pub use schema::json_schema;
pub use setting::{Setting, Value, ValueSource};

use setting::exact;

/// The value of every parameter, with its origin.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// The settings, in the order of the parameter table.
    settings: Vec<Setting>,
}

impl Default for Config {
    /// Creates a configuration with the defaults of the parameter table.
    fn default() -> Self {
        let setting = |parameter| Setting {
            parameter,
            value: Value::default_of(parameter),
            origin: ValueSource::Default,
        };
        let mut config = Self { settings: param::ALL.iter().map(setting).collect() };
        for (parameter, value) in config.derived_values() {
            config.put_number(parameter, value, ValueSource::Default);
        }
        config
    }
}

impl Config {
    /// Overrides these values with those of a TOML file.
    ///
    /// # Errors
    /// All problems of the file; an invalid file changes no value.
    pub fn with_file(mut self, path: &Path) -> Result<Self, ConfigError> {
        for setting in file::read(path)? {
            self.put(setting);
        }
        Ok(self)
    }

    /// Overrides these values with those of a TOML text; `path` is the file name in errors.
    ///
    /// # Errors
    /// As [`Config::with_file`].
    pub fn with_text(mut self, path: &Path, text: &[u8]) -> Result<Self, ConfigError> {
        for setting in file::parse(path, text, &ParameterSet::robot())? {
            self.put(setting);
        }
        Ok(self)
    }

    /// Overrides these values with the preset `name` of a recording format or a scenario.
    ///
    /// Values are in the unit of the key. A value outside its range is ignored.
    #[must_use]
    pub fn with_preset(mut self, name: &'static str, values: &[(&Parameter, f64)]) -> Self {
        for (parameter, value) in values {
            self.put_number(parameter, *value, ValueSource::Preset(name));
        }
        self
    }

    /// Overrides a choice with that of the preset `name`.
    #[must_use]
    pub fn with_preset_choice<C: ConfigChoice>(mut self, name: &'static str, choice: C) -> Self {
        let value = Value::Choice(choice.name());
        self.put(Setting { parameter: C::PARAMETER, value, origin: ValueSource::Preset(name) });
        self
    }

    /// Overrides one value with `section.key=value` from the command line.
    ///
    /// # Errors
    /// The problem of the text, as for a line of a file.
    pub fn with_option(self, text: &str) -> Result<Self, ConfigError> {
        self.with_option_of("--set", text)
    }

    /// Like [`Config::with_option`], for an option other than `--set`, which errors name.
    ///
    /// # Errors
    /// As [`Config::with_option`].
    pub fn with_option_of(mut self, option: &str, text: &str) -> Result<Self, ConfigError> {
        self.put(option_setting(option, text, &ParameterSet::robot())?);
        Ok(self)
    }

    /// Overrides one value with `setting`; a setting of a parameter outside the table is ignored.
    #[must_use]
    pub fn with_setting(mut self, setting: Setting) -> Self {
        self.put(setting);
        self
    }

    /// Returns the value of a number, in SI units and radians; 0 for other kinds.
    pub fn number(&self, parameter: &Parameter) -> f64 {
        self.value(parameter).number_of(parameter)
    }

    /// Returns the origin of a value.
    pub fn origin(&self, parameter: &Parameter) -> ValueSource {
        self.setting(parameter).map_or(ValueSource::Default, |setting| setting.origin.clone())
    }

    /// Returns every value, in the order of the parameter table.
    pub fn settings(&self) -> &[Setting] {
        &self.settings
    }

    fn value(&self, parameter: &Parameter) -> Value {
        self.setting(parameter).map_or_else(|| Value::default_of(parameter), |setting| setting.value.clone())
    }

    fn setting(&self, parameter: &Parameter) -> Option<&Setting> {
        self.settings.iter().find(|setting| setting.parameter == parameter)
    }

    fn put_number(&mut self, parameter: &Parameter, value: f64, origin: ValueSource) {
        let fits = match parameter.kind {
            Kind::Number { range, .. } => range.contains(value),
            Kind::Integer { range, .. } => range.contains(value) && value.fract() == 0.0,
            Kind::Choice { .. } | Kind::Polygon { .. } => false,
        };
        if fits && let Some(slot) = self.settings.iter_mut().find(|slot| slot.parameter == parameter) {
            slot.value = Value::Number(value);
            slot.origin = origin;
        }
    }

    fn put(&mut self, setting: Setting) {
        if let Some(slot) = self.settings.iter_mut().find(|slot| slot.parameter == setting.parameter) {
            *slot = setting;
        }
    }
}

/// Parses `section.key=value` from the command-line option `option`, for a parameter in `set`.
///
/// # Errors
/// The problem of the text, as for a line of a file.
pub fn option_setting(option: &str, text: &str, set: &ParameterSet) -> Result<Setting, ConfigError> {
    let malformed = || {
        let what = format!("invalid option (got '{}', expected SECTION.KEY=VALUE)", text.escape_debug());
        let example = set.iter().find(|p| matches!(p.kind, Kind::Number { .. }));
        let example = example.map_or_else(String::new, |p| {
            format!("example: `{option} {}.{}={}`; ", p.section, p.key, Value::default_of(p))
        });
        ConfigError::of_option(option, what, &format!("{example}`{}` lists the names", set.listing))
    };
    let toml = option_as_toml(text, set).ok_or_else(malformed)?;
    let settings =
        file::parse(Path::new(option), toml.as_bytes(), set).map_err(ConfigError::without_lines)?;
    let [setting] = settings.as_slice() else { return Err(malformed()) };
    Ok(Setting { origin: ValueSource::CommandLine, ..setting.clone() })
}

/// Converts `law.name=paper` to a line of TOML, so that options and files share one parser.
///
/// Names need no quotes, and numbers no digit before the decimal point. Returns `None` for malformed text.
fn option_as_toml(text: &str, set: &ParameterSet) -> Option<String> {
    let (name, value) = text.split_once('=')?;
    let (name, value) = (name.trim(), value.trim());
    if name.is_empty() || value.is_empty() {
        return None;
    }
    let name = match set.find_by_name(name) {
        Some(found) => format!("{}.{}", found.section, found.key),
        None => name.to_owned(),
    };
    let bare = value.chars().all(|c| c.is_ascii_alphabetic() || c == '_');
    Some(match value.parse::<f64>() {
        Ok(number) => format!("{name} = {}", exact(number).to_lowercase()),
        Err(_) if bare && !["true", "false"].contains(&value) => format!("{name} = \"{value}\""),
        Err(_) => format!("{name} = {value}"),
    })
}
