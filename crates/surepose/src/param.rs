//! Defines every user parameter: name, meaning, unit, bounds and default.
//!
//! The configuration file, its error messages, `surepose config` and the ROS parameters are generated from [`ALL`].
//! Values in this module are in the unit of their key: degrees where the key ends in `_deg`, SI units elsewhere.

mod choice;
mod table;

pub(crate) use choice::impl_choice;
pub use choice::{ArenaName, BrakingMode, Choice, LawName, MountingSource};
pub use table::*;

/// A constant that the user may set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// The section of the configuration file, for example `robot`.
    pub section: &'static str,
    /// The key within the section. Its suffix names the unit.
    pub key: &'static str,
    /// The unit of the value under this key.
    pub unit: Unit,
    /// The kind of value, with bounds and default.
    pub kind: Kind,
    /// The meaning, in complete sentences.
    pub meaning: &'static str,
}

/// The kind of a parameter's value, with bounds and default.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A finite number.
    Number {
        /// The value unless the configuration sets another. `None`: the value is derived from other parameters, as the
        /// meaning states.
        default: Option<f64>,
        /// The bounds.
        range: Range,
    },
    /// An integer.
    Integer {
        /// The value unless the configuration sets another.
        default: u32,
        /// The bounds.
        range: Range,
    },
    /// One of several names; the first is the default.
    Choice {
        /// The names, those of a [`Choice`].
        options: &'static [&'static str],
    },
    /// A polygon of 3 to [`MAX_VERTICES`](crate::safety::MAX_VERTICES) points \[m] around the origin; by default none.
    Polygon {
        /// The bounds of each coordinate.
        range: Range,
    },
}

/// The bounds of a number, with the reason for them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// The smallest value.
    pub low: f64,
    /// Whether `low` itself is a valid value.
    pub low_inclusive: bool,
    /// The largest valid value.
    pub high: f64,
    /// The reason why values outside are rejected.
    pub reason: &'static str,
}

impl Range {
    /// Returns whether `value` lies within the bounds; `false` for NaN.
    pub fn contains(&self, value: f64) -> bool {
        let above = if self.low_inclusive { value >= self.low } else { value > self.low };
        above && value <= self.high
    }
}

impl core::fmt::Display for Range {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let open = if self.low_inclusive { '[' } else { '(' };
        write!(f, "{open}{}, {}]", self.low, self.high)
    }
}

/// The unit of a value under its key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Dimensionless, or a name.
    One,
    /// Meters.
    Meter,
    /// Seconds.
    Second,
    /// Degrees. The program converts them to radians.
    Degree,
    /// Meters per second.
    MeterPerSecond,
    /// Meters per second squared.
    MeterPerSecondSquared,
    /// Per second.
    PerSecond,
    /// Degrees per second; radians per second inside the program.
    DegreePerSecond,
}

impl Unit {
    /// Every unit.
    pub const ALL: [Self; 8] = [
        Self::One,
        Self::Meter,
        Self::Second,
        Self::Degree,
        Self::MeterPerSecond,
        Self::MeterPerSecondSquared,
        Self::PerSecond,
        Self::DegreePerSecond,
    ];

    /// Returns the symbol of the unit; empty for [`Unit::One`].
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::One => "",
            Self::Meter => "m",
            Self::Second => "s",
            Self::Degree => "°",
            Self::MeterPerSecond => "m/s",
            Self::MeterPerSecondSquared => "m/s²",
            Self::PerSecond => "1/s",
            Self::DegreePerSecond => "°/s",
        }
    }

    /// Returns the suffix of keys in this unit; empty for gains, whose keys are the symbols of [Tran2012].
    pub const fn suffix(self) -> &'static str {
        match self {
            Self::One | Self::PerSecond => "",
            Self::Meter => "_m",
            Self::Second => "_s",
            Self::Degree => "_deg",
            Self::MeterPerSecond => "_m_s",
            Self::MeterPerSecondSquared => "_m_s2",
            Self::DegreePerSecond => "_deg_s",
        }
    }

    /// Returns the factor that converts a value under the key to SI units (radians for degrees).
    pub const fn to_si(self) -> f64 {
        match self {
            Self::Degree | Self::DegreePerSecond => core::f64::consts::PI / 180.0,
            _ => 1.0,
        }
    }
}

impl Parameter {
    /// Returns the default in SI units and radians; 0 for a choice, a polygon and a derived value.
    pub const fn default_si(&self) -> f64 {
        match self.kind {
            Kind::Number { default: Some(default), .. } => default * self.unit.to_si(),
            Kind::Integer { default, .. } => default as f64,
            Kind::Number { default: None, .. } | Kind::Choice { .. } | Kind::Polygon { .. } => 0.0,
        }
    }
}

/// Finds the parameter `key` of `section`; `None` if it does not exist.
pub fn find(section: &str, key: &str) -> Option<&'static Parameter> {
    ALL.iter().find(|p| p.section == section && p.key == key)
}

/// Finds a parameter by `section.key` or, if only one section has the key, by `key` alone.
///
/// Returns `None` if no parameter or more than one matches.
pub fn find_by_name(name: &str) -> Option<&'static Parameter> {
    if let Some((section, key)) = name.split_once('.') {
        return find(section, key);
    }
    let mut found = ALL.iter().filter(|p| p.key == name);
    let first = found.next();
    if found.next().is_some() { None } else { first }
}

/// Returns whether any parameter belongs to `section`.
pub fn is_section(section: &str) -> bool {
    ALL.iter().any(|p| p.section == section)
}

#[cfg(test)]
mod tests {
    use super::{ALL, Kind, SECTIONS, Unit, find, find_by_name};

    #[test]
    fn sections_are_contiguous_and_described() {
        let mut sections = SECTIONS.iter();
        for group in ALL.chunk_by(|a, b| a.section == b.section) {
            assert_eq!(sections.next().map(|(name, _)| *name), group.first().map(|p| p.section));
        }
        assert_eq!(sections.next(), None);
    }

    #[test]
    fn every_parameter_is_well_formed() {
        for (i, p) in ALL.iter().enumerate() {
            assert!(p.key.ends_with(p.unit.suffix()), "{}.{} is in {:?}", p.section, p.key, p.unit);
            assert!(p.meaning.trim().ends_with('.'), "{}.{} lacks a sentence", p.section, p.key);
            assert!(ALL.iter().skip(i + 1).all(|q| (q.section, q.key) != (p.section, p.key)));
            match p.kind {
                Kind::Number { default, range } => {
                    assert!(default.is_none_or(|default| range.contains(default)), "{}.{}", p.section, p.key);
                }
                Kind::Integer { default, range } => assert!(range.contains(default.into()), "{}", p.key),
                Kind::Choice { options } => assert!(!options.is_empty() && p.unit == Unit::One),
                Kind::Polygon { range } => assert!(range.contains(0.0) && p.unit == Unit::Meter),
            }
        }
    }

    #[test]
    fn find_by_name_rejects_ambiguous_keys() {
        assert_eq!(find_by_name("k_v"), find("law", "k_v"));
        assert_eq!(find_by_name("law.k_v"), find("law", "k_v"));
        assert_eq!(find_by_name("latency_s"), None, "several sections have this key");
        assert_eq!(find_by_name("robot.k_v"), None);
    }
}
