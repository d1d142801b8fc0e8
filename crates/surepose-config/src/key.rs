//! Finds parameters by name and diagnoses unknown keys: wrong unit, wrong section or typo.

use surepose::param::{ALL, Parameter, Unit};

/// Parameters that a file or an option may set.
#[derive(Clone, Debug)]
pub struct ParameterSet {
    parameters: Vec<&'static Parameter>,
    /// The command that lists them, for error messages.
    pub(super) listing: &'static str,
}

/// The probable cause of an unknown key.
#[derive(Debug, PartialEq)]
pub(super) enum UnknownKey {
    /// A valid name with the suffix of another unit.
    OtherUnit {
        /// The intended parameter.
        parameter: &'static Parameter,
        /// The factor that converts the value to the unit of the parameter.
        factor: f64,
    },
    /// A valid name without its unit suffix.
    NoUnit(&'static Parameter),
    /// A key of the given other sections.
    OtherSection(Vec<&'static str>),
    /// A key similar to the given key of this section.
    Typo(&'static str),
    /// No similar key.
    Unknown,
}

/// Common unit suffixes, with the unit and the factor to SI (radians for angles).
const SUFFIXES: [(&str, Unit, f64); 28] = [
    ("_um", Unit::Meter, 1e-6),
    ("_mm", Unit::Meter, 1e-3),
    ("_cm", Unit::Meter, 1e-2),
    ("_m", Unit::Meter, 1.0),
    ("_meters", Unit::Meter, 1.0),
    ("_metres", Unit::Meter, 1.0),
    ("_km", Unit::Meter, 1e3),
    ("_in", Unit::Meter, 0.0254),
    ("_inch", Unit::Meter, 0.0254),
    ("_ns", Unit::Second, 1e-9),
    ("_us", Unit::Second, 1e-6),
    ("_ms", Unit::Second, 1e-3),
    ("_s", Unit::Second, 1.0),
    ("_sec", Unit::Second, 1.0),
    ("_min", Unit::Second, 60.0),
    ("_rad", Unit::Degree, 1.0),
    ("_mrad", Unit::Degree, 1e-3),
    ("_deg", Unit::Degree, core::f64::consts::PI / 180.0),
    ("_degrees", Unit::Degree, core::f64::consts::PI / 180.0),
    ("_mm_s", Unit::MeterPerSecond, 1e-3),
    ("_cm_s", Unit::MeterPerSecond, 1e-2),
    ("_m_s", Unit::MeterPerSecond, 1.0),
    ("_mps", Unit::MeterPerSecond, 1.0),
    ("_km_h", Unit::MeterPerSecond, 1.0 / 3.6),
    ("_mm_s2", Unit::MeterPerSecondSquared, 1e-3),
    ("_cm_s2", Unit::MeterPerSecondSquared, 1e-2),
    ("_m_s2", Unit::MeterPerSecondSquared, 1.0),
    ("_mps2", Unit::MeterPerSecondSquared, 1.0),
];

impl UnknownKey {
    /// Diagnoses `key`, which `section` does not have.
    pub(super) fn from_key(set: &ParameterSet, section: &str, key: &str) -> Self {
        let here = || set.section(section);
        if let Some((stem, unit, size)) = split(key)
            && let Some(parameter) = here().find(|p| p.unit == unit && stem_of(p) == stem)
        {
            return Self::OtherUnit { parameter, factor: size / unit.to_si() };
        }
        if let Some(parameter) = here().find(|p| p.unit != Unit::One && stem_of(p) == key) {
            return Self::NoUnit(parameter);
        }
        let elsewhere = set.sections_of(key);
        if !elsewhere.is_empty() {
            return Self::OtherSection(elsewhere);
        }
        nearest(key, here().map(|p| p.key)).map_or(Self::Unknown, Self::Typo)
    }
}

impl ParameterSet {
    /// Creates a set; `listing` is the command that lists it, for error messages.
    pub fn new(parameters: impl IntoIterator<Item = &'static Parameter>, listing: &'static str) -> Self {
        Self { parameters: parameters.into_iter().collect(), listing }
    }

    /// Every parameter of the robot.
    pub fn robot() -> Self {
        Self::new(ALL, "surepose config show")
    }

    /// Returns the parameters, sections contiguous.
    pub fn iter(&self) -> impl Iterator<Item = &'static Parameter> {
        self.parameters.iter().copied()
    }

    /// Finds the parameter `key` of `section`; `None` if it is not in the set.
    pub fn find(&self, section: &str, key: &str) -> Option<&'static Parameter> {
        self.iter().find(|p| p.section == section && p.key == key)
    }

    /// Finds a parameter by `section.key` or, if only one section has the key, by `key` alone.
    ///
    /// Returns `None` if no parameter or more than one matches.
    pub fn find_by_name(&self, name: &str) -> Option<&'static Parameter> {
        if let Some((section, key)) = name.split_once('.') {
            return self.find(section, key);
        }
        let mut found = self.iter().filter(|p| p.key == name);
        let first = found.next();
        if found.next().is_some() { None } else { first }
    }

    /// Returns the parameter with the name `key` or `section.key`.
    ///
    /// # Errors
    /// A suggestion, as a sentence, if the name is unknown or ambiguous.
    pub fn parameter(&self, name: &str) -> Result<&'static Parameter, String> {
        if let Some(found) = self.find_by_name(name) {
            return Ok(found);
        }
        let several: Vec<_> =
            self.sections_of(name).into_iter().map(|section| format!("{section}.{name}")).collect();
        if !several.is_empty() {
            return Err(format!("several sections have this key: {}", several.join(", ")));
        }
        let (section, key) = name.split_once('.').unwrap_or((name, ""));
        if key.is_empty() && !self.keys(section).is_empty() {
            return Err(format!("the keys of [{section}] are {}", self.keys(section)));
        }
        let here = || self.iter().filter(|p| key.is_empty() || p.section == section);
        let meant = nearest(if key.is_empty() { name } else { key }, here().map(|p| p.key));
        let found = here().find(|p| Some(p.key) == meant);
        Err(match found {
            Some(found) => format!("did you mean {}.{}?", found.section, found.key),
            None => format!("`{}` lists every parameter", self.listing),
        })
    }

    /// Returns the parameters of a section.
    pub(super) fn section(&self, section: &str) -> impl Iterator<Item = &'static Parameter> {
        self.iter().filter(move |p| p.section == section)
    }

    /// Returns the sections that have `key`.
    pub(super) fn sections_of(&self, key: &str) -> Vec<&'static str> {
        self.iter().filter(|p| p.key == key).map(|p| p.section).collect()
    }

    /// Lists every section, for a message.
    pub(super) fn sections(&self) -> String {
        let mut names: Vec<_> = self.iter().map(|p| format!("[{}]", p.section)).collect();
        names.dedup();
        names.join(", ")
    }

    /// Lists every key of a section, for a message.
    pub(super) fn keys(&self, section: &str) -> String {
        self.section(section).map(|p| p.key).collect::<Vec<_>>().join(", ")
    }
}

/// Returns the parameter of the robot with the name `key` or `section.key`.
///
/// # Errors
/// A suggestion, as a sentence, if the name is unknown or ambiguous.
pub fn parameter(name: &str) -> Result<&'static Parameter, String> {
    ParameterSet::robot().parameter(name)
}

/// Returns the unit suffix of a key as a symbol: `mm`, `m/s`.
pub(super) fn unit_shown(key: &str) -> String {
    let suffix = suffix_of(key).map_or("", |(suffix, ..)| suffix);
    suffix.trim_start_matches('_').replacen('_', "/", 1)
}

/// Returns the most similar name; `None` if no similarity exceeds 0.8.
pub(super) fn nearest(name: &str, names: impl Iterator<Item = &'static str>) -> Option<&'static str> {
    let rated = names.map(|candidate| (strsim::jaro_winkler(name, candidate), candidate));
    rated.filter(|(score, _)| *score > 0.8).max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, name)| name)
}

fn stem_of(parameter: &'static Parameter) -> &'static str {
    parameter.key.strip_suffix(parameter.unit.suffix()).unwrap_or(parameter.key)
}

fn split(key: &str) -> Option<(&str, Unit, f64)> {
    suffix_of(key).and_then(|(suffix, unit, size)| Some((key.strip_suffix(suffix)?, unit, size)))
}

/// Returns the longest unit suffix: `_mm_s` rather than `_s`.
fn suffix_of(key: &str) -> Option<(&'static str, Unit, f64)> {
    SUFFIXES.into_iter().filter(|(suffix, ..)| key.ends_with(suffix)).max_by_key(|(suffix, ..)| suffix.len())
}
