//! The configuration: the table of parameters, filled from layers that each know where their values come from.
//!
//! A value is the table's default, or a preset of a recording's format, or a line of a TOML file, or an option on
//! the command line; the later one wins. Every value that arrives here has passed the table's bounds, so that the
//! core's constants can be made from it without failing: [`build`](self) is where that happens, once for every
//! command.

mod build;
mod file;
mod key;
mod navigation;
mod problem;
mod setting;
#[cfg(test)]
mod tests;
mod warnings;

use std::path::Path;

use surepose::param::{self, Kind, Parameter};

pub use build::{CompassParameters, LaserParameters};
pub use key::parameter;
pub use navigation::{HISTORY, MAX_BEAMS, NavigatorSetup, RobotLocalizer, RobotNavigator, ScanMethod};
pub use problem::{ConfigError, ConfigProblem};
pub use setting::{Setting, Value, ValueSource};

use setting::exact;

/// Every parameter's value, with where it came from.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// In the order of the table.
    settings: Vec<Setting>,
}

impl Default for Config {
    /// Every parameter at the table's default.
    fn default() -> Self {
        let setting =
            |parameter| Setting { parameter, value: default(parameter), origin: ValueSource::Default };
        Self { settings: param::ALL.iter().map(setting).collect() }
    }
}

impl Config {
    /// Puts the values of a TOML file over these.
    ///
    /// # Errors
    /// Every problem of the file at once; nothing is taken from a file that has one.
    pub fn with_file(mut self, path: &Path) -> Result<Self, ConfigError> {
        for setting in file::read(path)? {
            self.put(setting);
        }
        Ok(self)
    }

    /// Puts the values of a TOML text over these; `path` is the name that errors give it.
    ///
    /// # Errors
    /// As [`Config::with_file`].
    pub fn with_text(mut self, path: &Path, text: &[u8]) -> Result<Self, ConfigError> {
        for setting in file::parse(path, text)? {
            self.put(setting);
        }
        Ok(self)
    }

    /// Puts values over these that fit `name`, a format of recordings or a scenario, better than the defaults.
    ///
    /// Values are in the unit of the key. One outside its range is a mistake of the preset and is left out.
    #[must_use]
    pub fn with_preset(mut self, name: &'static str, values: &[(&Parameter, f64)]) -> Self {
        for (parameter, value) in values {
            self.put_number(parameter, *value, ValueSource::Preset(name));
        }
        self
    }

    /// The same for a choice; one that there is not is left out.
    #[must_use]
    pub fn with_preset_choice(
        mut self,
        name: &'static str,
        parameter: &'static Parameter,
        choice: &str,
    ) -> Self {
        if let Kind::Choice { options } = parameter.kind
            && let Some(option) = options.iter().find(|option| **option == choice)
        {
            self.put(Setting { parameter, value: Value::Choice(option), origin: ValueSource::Preset(name) });
        }
        self
    }

    /// Puts `section.key=value` from the command line over these.
    ///
    /// # Errors
    /// What is wrong with the text, as for a line of a file.
    pub fn with_option(self, text: &str) -> Result<Self, ConfigError> {
        self.with_option_of("--set", text)
    }

    /// The same, where it was `option` that the user typed: that is what errors name.
    ///
    /// # Errors
    /// As [`Config::with_option`].
    pub fn with_option_of(mut self, option: &str, text: &str) -> Result<Self, ConfigError> {
        let name = Path::new(option);
        let malformed = || {
            let what = format!("is not one SECTION.KEY=VALUE: '{}'", text.escape_debug());
            let help = "write `--set law.k_v=3`; `surepose config show` lists the names";
            ConfigError::unreadable(name, None, what, help)
        };
        let toml = option_as_toml(text).ok_or_else(malformed)?;
        let settings = file::parse(name, toml.as_bytes()).map_err(ConfigError::without_lines)?;
        let [setting] = settings.as_slice() else { return Err(malformed()) };
        self.put(Setting { origin: ValueSource::CommandLine, ..setting.clone() });
        Ok(self)
    }

    /// The value of a number, in SI units and radians.
    pub fn number(&self, parameter: &Parameter) -> f64 {
        match self.value(parameter) {
            Value::Number(number) => number * parameter.unit.to_si(),
            Value::Choice(_) => 0.0,
        }
    }

    /// The value of a choice.
    pub fn choice(&self, parameter: &Parameter) -> &'static str {
        match self.value(parameter) {
            Value::Choice(name) => name,
            Value::Number(_) => "",
        }
    }

    /// Where a value came from.
    pub fn origin(&self, parameter: &Parameter) -> ValueSource {
        self.setting(parameter).map_or(ValueSource::Default, |setting| setting.origin.clone())
    }

    /// Every value, in the order of the table.
    pub fn settings(&self) -> &[Setting] {
        &self.settings
    }

    fn value(&self, parameter: &Parameter) -> Value {
        self.setting(parameter).map_or_else(|| default(parameter), |setting| setting.value.clone())
    }

    fn setting(&self, parameter: &Parameter) -> Option<&Setting> {
        self.settings.iter().find(|setting| setting.parameter == parameter)
    }

    fn put_number(&mut self, parameter: &Parameter, value: f64, origin: ValueSource) {
        let fits = match parameter.kind {
            Kind::Number { range, .. } => range.contains(value),
            Kind::Integer { range, .. } => range.contains(value) && value.fract() == 0.0,
            Kind::Choice { .. } => false,
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

fn default(parameter: &Parameter) -> Value {
    match parameter.kind {
        Kind::Number { default, .. } => Value::Number(default),
        Kind::Integer { default, .. } => Value::Number(default.into()),
        Kind::Choice { options } => Value::Choice(options.first().copied().unwrap_or("")),
    }
}

/// `law.name=paper` as a line of TOML, so that there is one way to read values: names need no quotes in a shell, and
/// numbers no digit before their point.
fn option_as_toml(text: &str) -> Option<String> {
    let (name, value) = text.split_once('=')?;
    let (name, value) = (name.trim(), value.trim());
    if name.is_empty() || value.is_empty() {
        return None;
    }
    let name = match param::find_by_name(name) {
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
