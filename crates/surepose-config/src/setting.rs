//! One parameter's value with its source, and numbers as text.

use std::fmt;
use std::path::PathBuf;

use surepose::geometry::Point;
use surepose::param::{Choice, Kind, Parameter};
use surepose::safety::{InvalidFootprint, Polygon};

/// One parameter's value.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// The parameter.
    pub parameter: &'static Parameter,
    /// Its value, in the unit of its key.
    pub value: Value,
    /// Source of the value.
    pub origin: ValueSource,
}

/// The value of a parameter, in the unit of its key.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A number inside the parameter's range.
    Number(f64),
    /// One of the parameter's options.
    Choice(&'static str),
    /// The points (x, y) of a polygon; empty for none.
    Polygon(Vec<[f64; 2]>),
}

/// Source of a value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ValueSource {
    /// The table of parameters.
    Default,
    /// Preset of a recording format or of a scenario.
    Preset(&'static str),
    /// A configuration file.
    File {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
    },
    /// An option.
    CommandLine,
}

impl Value {
    /// Returns the number of a parameter in SI units and radians; 0 for other kinds.
    pub fn number_of(&self, parameter: &Parameter) -> f64 {
        match self {
            Self::Number(number) => number * parameter.unit.to_si(),
            Self::Choice(_) | Self::Polygon(_) => 0.0,
        }
    }

    /// Returns the option of a parameter whose enum is `C`; the default option for another value.
    pub fn option<C: Choice>(&self) -> C {
        let found = match self {
            Self::Choice(name) => C::from_name(name),
            Self::Number(_) | Self::Polygon(_) => None,
        };
        found.unwrap_or(C::ALL[0])
    }

    /// Returns the default of a parameter; 0 for a derived one.
    pub fn default_of(parameter: &Parameter) -> Self {
        match parameter.kind {
            Kind::Number { default, .. } => Self::Number(default.unwrap_or(0.0)),
            Kind::Integer { default, .. } => Self::Number(default.into()),
            Kind::Choice { options } => Self::Choice(options.first().copied().unwrap_or("")),
            Kind::Polygon { .. } => Self::Polygon(Vec::new()),
        }
    }
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => write!(f, "{number}"),
            Self::Choice(name) => f.write_str(name),
            Self::Polygon(points) => {
                let points: Vec<_> = points.iter().map(|[x, y]| format!("[{x}, {y}]")).collect();
                write!(f, "[{}]", points.join(", "))
            }
        }
    }
}

impl fmt::Display for ValueSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Default => f.write_str("default"),
            Self::Preset(name) => write!(f, "preset {name}"),
            Self::File { path, line } => write!(f, "{}:{line}", path.display()),
            Self::CommandLine => f.write_str("command line"),
        }
    }
}

/// Converts the points of a polygon \[m].
pub(super) fn polygon_from(points: &[[f64; 2]]) -> Result<Polygon<f64>, InvalidFootprint> {
    Polygon::new(&points.iter().map(|[x, y]| Point::new(*x, *y)).collect::<Vec<_>>())
}

/// `number` with nine significant digits: 0.05 rather than 0.050000000000000003.
pub(crate) fn plain(number: f64) -> String {
    exact(format!("{number:.8e}").parse().unwrap_or(number))
}

/// `number` to the last bit; very large and very small ones in scientific notation.
pub(crate) fn exact(number: f64) -> String {
    if number != 0.0 && !(1e-6..1e15).contains(&number.abs()) {
        format!("{number:e}")
    } else {
        format!("{number}")
    }
}
