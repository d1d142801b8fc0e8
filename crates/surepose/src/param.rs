//! One table of parameters: what each is called, what it means, in which unit, within which bounds and why.
//!
//! The configuration file, its errors, the command line's help and the ROS parameters are made from [`ALL`], so
//! that none of them can drift from the others. Values here are in the unit of their key: degrees where the key ends
//! in `_deg`, SI elsewhere.

mod table;

pub use table::*;

/// A named constant that the user may set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// The section it belongs to, `robot` for example.
    pub section: &'static str,
    /// Its key there; the suffix says the unit.
    pub key: &'static str,
    /// The unit of the value under this key.
    pub unit: Unit,
    /// What it may be, and what it is unless set.
    pub kind: Kind,
    /// What it does, as sentences.
    pub meaning: &'static str,
}

/// What a parameter may be, and what it is unless set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A finite number.
    Number {
        /// Where nothing else is said.
        default: f64,
        /// The bounds.
        range: Range,
    },
    /// A whole number.
    Integer {
        /// Where nothing else is said.
        default: u32,
        /// The bounds.
        range: Range,
    },
    /// One of these names; the first is the default.
    Choice {
        /// The names.
        options: &'static [&'static str],
    },
}

/// The bounds of a number, and why they are there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// The smallest value.
    pub low: f64,
    /// Whether `low` itself is allowed.
    pub low_inclusive: bool,
    /// The largest value, allowed.
    pub high: f64,
    /// Why a value outside is rejected.
    pub reason: &'static str,
}

impl Range {
    /// Whether `value` is inside; NaN is not.
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
    /// A pure number or a name.
    One,
    /// Metres.
    Meter,
    /// Seconds.
    Second,
    /// Degrees; radians inside the program.
    Degree,
    /// Metres per second.
    MeterPerSecond,
    /// Metres per second squared.
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

    /// The unit's symbol; empty for a pure number.
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

    /// How a key in this unit ends. Gains end in nothing: their keys are the paper's symbols.
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

    /// What a value under the key is multiplied by to be SI, radians for degrees.
    pub const fn to_si(self) -> f64 {
        match self {
            Self::Degree | Self::DegreePerSecond => core::f64::consts::PI / 180.0,
            _ => 1.0,
        }
    }
}

/// The parameter `key` of `section`.
pub fn find(section: &str, key: &str) -> Option<&'static Parameter> {
    ALL.iter().find(|p| p.section == section && p.key == key)
}

/// The parameter called `section.key`, or `key` where only one section has it.
pub fn find_by_name(name: &str) -> Option<&'static Parameter> {
    if let Some((section, key)) = name.split_once('.') {
        return find(section, key);
    }
    let mut found = ALL.iter().filter(|p| p.key == name);
    let first = found.next();
    if found.next().is_some() { None } else { first }
}

/// Whether any parameter belongs to `section`.
pub fn is_section(section: &str) -> bool {
    ALL.iter().any(|p| p.section == section)
}

#[cfg(test)]
mod tests {
    use super::{ALL, Kind, Unit, find, find_by_name};

    #[test]
    fn every_parameter_is_well_formed() {
        for (i, p) in ALL.iter().enumerate() {
            assert!(p.key.ends_with(p.unit.suffix()), "{}.{} is in {:?}", p.section, p.key, p.unit);
            assert!(p.meaning.trim().ends_with('.'), "{}.{} lacks a sentence", p.section, p.key);
            assert!(ALL.iter().skip(i + 1).all(|q| (q.section, q.key) != (p.section, p.key)));
            match p.kind {
                Kind::Number { default, range } => {
                    assert!(range.contains(default), "{}.{}", p.section, p.key);
                }
                Kind::Integer { default, range } => assert!(range.contains(default.into()), "{}", p.key),
                Kind::Choice { options } => assert!(!options.is_empty() && p.unit == Unit::One),
            }
        }
    }

    #[test]
    fn names_are_found_where_they_are_unambiguous() {
        assert_eq!(find_by_name("k_v"), find("law", "k_v"));
        assert_eq!(find_by_name("law.k_v"), find("law", "k_v"));
        assert_eq!(find_by_name("latency_s"), None, "compass and laser both have one");
        assert_eq!(find_by_name("robot.k_v"), None);
    }
}
