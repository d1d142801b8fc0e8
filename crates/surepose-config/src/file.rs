//! Parses a TOML file into settings; checks every value against the parameter table and reports every problem.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use surepose::param::{Kind, Parameter, Range};
use surepose::safety::MAX_VERTICES;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::key::{self, ParameterSet, UnknownKey};
use super::problem::{ConfigError, Problems, line_of};
use super::setting::{Setting, Value, ValueSource, plain, polygon_from};

/// Maximum length of a file \[bytes], a hundred times that of a commented configuration with every parameter.
pub(super) const MAX_BYTES: usize = 1 << 20;

type Span = core::ops::Range<usize>;

/// Reads the settings of the file at `path`.
pub(super) fn read(path: &Path) -> Result<Vec<Setting>, ConfigError> {
    // A device such as /dev/zero has no end.
    let mut bytes = Vec::new();
    let limit = MAX_BYTES as u64 + 1;
    let read = File::open(path).and_then(|file| file.take(limit).read_to_end(&mut bytes));
    read.map_err(|error| {
        let help = "give the path of a TOML file; `surepose config show` prints one with every parameter";
        ConfigError::unreadable(path, None, format!("cannot be read: {error}"), help)
    })?;
    parse(path, &bytes, &ParameterSet::robot())
}

/// Parses the settings of a TOML text, all of parameters in `set`.
pub(super) fn parse(path: &Path, bytes: &[u8], set: &ParameterSet) -> Result<Vec<Setting>, ConfigError> {
    if bytes.len() > MAX_BYTES {
        let what = format!("file too long (expected at most {MAX_BYTES} bytes)");
        return Err(ConfigError::unreadable(path, None, what, "check that this is a configuration file"));
    }
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let line = line_of(bytes, error.valid_up_to());
        let what = "not UTF-8 text".to_owned();
        ConfigError::unreadable(path, Some(line), what, "save the file as UTF-8 text")
    })?;

    let mut problems = Problems::new(path, text);
    let (table, errors) = DeTable::parse_recoverable(text);
    let (mut broken, mut broken_line) = (Vec::new(), 0);
    for error in errors {
        let span = error.span().unwrap_or(0..0);
        broken.push(span.start);
        let line = line_of(bytes, span.start);
        // After an error the parser recovers by guessing, so further errors on the same line are dropped.
        if std::mem::replace(&mut broken_line, line) == line {
            continue;
        }
        let help = bare_point(text, span.start).unwrap_or_else(|| {
            "write `key = value` lines under a `[section]`, as `surepose config show` prints them".to_owned()
        });
        problems.add(span, format!("invalid TOML: {}", error.message().trim_end()), "here", Some(help));
    }

    let mut reader = Reader { set, path, text, broken, problems, settings: Vec::new() };
    for (name, value) in table.get_ref() {
        reader.section(name.get_ref(), name.span(), value);
    }
    let Reader { problems, settings, .. } = reader;
    problems.into_error().map_or(Ok(settings), Err)
}

struct Reader<'t> {
    set: &'t ParameterSet,
    path: &'t Path,
    text: &'t str,
    /// Offsets of invalid TOML.
    broken: Vec<usize>,
    problems: Problems<'t>,
    settings: Vec<Setting>,
}

impl Reader<'_> {
    fn section(&mut self, name: &str, span: Span, value: &Spanned<DeValue<'_>>) {
        let Some(table) = value.get_ref().as_table() else {
            let help = match self.set.sections_of(name).as_slice() {
                [] => format!("put it under one of the sections {}", self.set.sections()),
                found => format!("`{name}` belongs to [{}]", found.join("] or [")),
            };
            return self.problems.add(span, format!("`{name}`: outside of any section"), "here", Some(help));
        };
        if self.set.section(name).next().is_none() {
            let help = match key::nearest(name, self.set.iter().map(|p| p.section)) {
                Some(near) => format!("did you mean [{near}]?"),
                None => format!("the sections are {}", self.set.sections()),
            };
            return self.problems.add(
                span,
                format!("unknown section [{name}]"),
                "no such section",
                Some(help),
            );
        }
        for (key, value) in table {
            match self.set.find(name, key.get_ref()) {
                None if self.problems.is_full() => self.problems.count_only(),
                Some(parameter) => self.value(parameter, value),
                None => self.unknown(name, key.get_ref(), key.span(), value.get_ref()),
            }
        }
    }

    fn unknown(&mut self, section: &str, key: &str, span: Span, value: &DeValue<'_>) {
        let (label, help) = match UnknownKey::from_key(self.set, section, key) {
            UnknownKey::OtherUnit { parameter, factor } => {
                let mut help = format!("the key is `{}`", parameter.key);
                if let Some(number) = number(value) {
                    let (text, right) = (plain(number), plain(number * factor));
                    help = format!("{help}; {text} {} is {right}", key::unit_shown(key));
                }
                ("wrong unit", help)
            }
            UnknownKey::NoUnit(parameter) => {
                let unit = parameter.unit.symbol();
                ("no unit", format!("the key is `{}`, with the value in {unit}", parameter.key))
            }
            UnknownKey::OtherSection(sections) => {
                ("wrong section", format!("`{key}` belongs to [{}]", sections.join("] or [")))
            }
            UnknownKey::Typo(near) => ("no such key", format!("did you mean `{near}`?")),
            UnknownKey::Unknown => {
                ("no such key", format!("the keys of [{section}] are {}", self.set.keys(section)))
            }
        };
        self.problems.add(span, format!("unknown key `{key}` in [{section}]"), label, Some(help));
    }

    fn value(&mut self, parameter: &'static Parameter, found: &Spanned<DeValue<'_>>) {
        let span = found.span();
        if span.is_empty() || self.broken.iter().any(|at| (span.start..=span.end).contains(at)) {
            return; // A placeholder for invalid TOML, which is already reported.
        }
        let checked = match parameter.kind {
            Kind::Number { range, .. } => checked_number(parameter, found.get_ref(), &range),
            Kind::Integer { range, .. } => checked_whole(parameter, found.get_ref(), &range),
            Kind::Choice { options } => checked_choice(parameter, found.get_ref(), options),
            Kind::Polygon { range } => checked_polygon(parameter, found.get_ref(), &range),
        };
        match checked {
            Ok(value) => {
                let line = line_of(self.text.as_bytes(), span.start);
                let origin = ValueSource::File { path: self.path.to_owned(), line };
                self.settings.push(Setting { parameter, value, origin });
            }
            Err(Refused { what, help }) => {
                let meaning = parameter.meaning.trim();
                self.problems.add(span, what, meaning, Some(help));
            }
        }
    }
}

struct Refused {
    what: String,
    help: String,
}

fn checked_number(parameter: &Parameter, value: &DeValue<'_>, range: &Range) -> Result<Value, Refused> {
    let (key, unit) = (parameter.key, spaced(parameter.unit.symbol()));
    let Some(number) = number(value) else {
        let what = format!("`{key}`: expected a number, got {}", described(value));
        return Err(Refused { what, help: format!("write a number in {range}{unit}") });
    };
    if range.contains(number) {
        return Ok(Value::Number(number));
    }
    let shown = plain(number);
    let what = if number.is_nan() {
        format!("`{key}`: not a number")
    } else if !number.is_finite() {
        format!("`{key}`: not finite (got {shown})")
    } else if number < 0.0 && range.low >= 0.0 {
        format!("`{key}`: negative value (got {shown}{unit})")
    } else {
        format!("`{key}`: out of range (got {shown}{unit})")
    };
    Err(Refused { what, help: format!("write a value in {range}{unit}: {}", range.reason) })
}

fn checked_whole(parameter: &Parameter, value: &DeValue<'_>, range: &Range) -> Result<Value, Refused> {
    match checked_number(parameter, value, range)? {
        Value::Number(number) if number.fract() != 0.0 => {
            let what = format!("`{}`: expected an integer, got {}", parameter.key, plain(number));
            Err(Refused { what, help: format!("write an integer in {range}: {}", range.reason) })
        }
        whole => Ok(whole),
    }
}

fn checked_choice(
    parameter: &Parameter,
    value: &DeValue<'_>,
    options: &'static [&'static str],
) -> Result<Value, Refused> {
    let key = parameter.key;
    let all = options.iter().map(|option| format!("\"{option}\"")).collect::<Vec<_>>().join(", ");
    let Some(name) = value.as_str() else {
        let what = format!("`{key}`: expected a name, got {}", described(value));
        return Err(Refused { what, help: format!("write one of {all}") });
    };
    options.iter().find(|option| **option == name).map(|option| Value::Choice(option)).ok_or_else(|| {
        let help = match key::nearest(name, options.iter().copied()) {
            Some(near) => format!("did you mean \"{near}\"? The options are {all}"),
            None => format!("write one of {all}"),
        };
        Refused { what: format!("`{key}`: unknown option \"{}\"", name.escape_debug()), help }
    })
}

fn checked_polygon(parameter: &Parameter, value: &DeValue<'_>, range: &Range) -> Result<Value, Refused> {
    let key = parameter.key;
    let refused = |what: &str| Refused {
        what: format!("`{key}`: {what}"),
        help: format!(
            "write 3 to {MAX_VERTICES} points [x, y] around the middle of the axle, each coordinate in {range} m, for example \
             [[0.4, 0.2], [-0.1, 0.2], [-0.1, -0.2], [0.4, -0.2]]"
        ),
    };
    let Some(list) = value.as_array() else {
        return Err(refused(&format!("expected a list of points, got {}", described(value))));
    };
    let mut points = Vec::new();
    for point in list {
        let coordinates = point.get_ref().as_array().map(|pair| pair.iter().map(|c| number(c.get_ref())));
        let coordinates = coordinates.map(Iterator::collect::<Vec<_>>);
        match coordinates.as_deref() {
            Some(&[Some(x), Some(y)]) if range.contains(x) && range.contains(y) => points.push([x, y]),
            Some(&[Some(x), Some(y)]) => {
                return Err(refused(&format!("coordinate out of range (got [{}, {}])", plain(x), plain(y))));
            }
            _ => return Err(refused("expected points of two numbers")),
        }
    }
    if points.is_empty() || polygon_from(&points).is_ok() {
        return Ok(Value::Polygon(points));
    }
    Err(refused(if (3..=MAX_VERTICES).contains(&points.len()) {
        "the polygon does not contain the middle of the axle, [0, 0]"
    } else {
        "wrong number of points"
    }))
}

/// Returns the number, infinite beyond the range of `f64`; `None` if the value is not a number.
fn number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Float(float) => float.as_str().parse().ok(),
        DeValue::Integer(integer) => {
            let text = integer.as_str();
            if integer.radix() == 10 {
                text.parse().ok()
            } else {
                i64::from_str_radix(text, integer.radix()).ok().map(|whole| whole as f64)
            }
        }
        _ => None,
    }
}

fn described(value: &DeValue<'_>) -> String {
    match value {
        DeValue::String(text) => match text.parse::<f64>() {
            Ok(_) => "text; leave out the quotes".to_owned(),
            Err(_) => "text".to_owned(),
        },
        DeValue::Boolean(_) => "a Boolean".to_owned(),
        DeValue::Array(_) => "an array".to_owned(),
        DeValue::Table(_) => "a table".to_owned(),
        DeValue::Datetime(_) => "a date".to_owned(),
        DeValue::Integer(_) | DeValue::Float(_) => "a number".to_owned(),
    }
}

/// Returns the remedy for a number without a digit next to its decimal point, for example `.5`; `None` for other text.
fn bare_point(text: &str, place: usize) -> Option<String> {
    let part_of_number = |c: char| c.is_ascii_digit() || "+-.eE".contains(c);
    let (before, after) = text.split_at_checked(place)?;
    let start = before.trim_end_matches(part_of_number).len();
    let rest = &after[after.find(|c| !part_of_number(c)).unwrap_or(after.len())..];
    let written = &text[start..text.len() - rest.len()];
    let number: f64 = written.parse().ok().filter(|number: &f64| number.is_finite())?;
    written
        .contains('.')
        .then(|| format!("a decimal point needs digits on both sides: write {}", plain(number)))
}

fn spaced(symbol: &str) -> String {
    if symbol.is_empty() { String::new() } else { format!(" {symbol}") }
}
