//! Parses YAML files: a mapping from keys to scalars and lists, each with its line.

use std::borrow::Cow;
use std::path::Path;

use saphyr_parser::{Event, Parser, ScalarStyle, ScanError, Span, StrInput};

use crate::document::wrong;
use crate::error::{DataError, excerpt};

/// Maximum number of keys; map servers use seven.
const MAX_KEYS: usize = 1000;

/// A scalar of the document, with its line.
pub(super) struct Scalar<'a> {
    text: Cow<'a, str>,
    is_plain: bool,
    pub(super) line: u64,
}

/// The value of a key.
enum Value<'a> {
    Scalar(Scalar<'a>),
    List(Vec<Scalar<'a>>),
    /// A mapping, an alias, or a list of something other than scalars.
    Other,
}

/// The keys of the document in order, including unknown keys of other tools.
pub(super) struct Document<'a> {
    file: &'a Path,
    entries: Vec<Entry<'a>>,
}

struct Entry<'a> {
    key: Cow<'a, str>,
    line: u64,
    value: Value<'a>,
}

impl<'a> Document<'a> {
    /// Parses `text`, which must be a single mapping.
    ///
    /// # Errors
    /// Invalid YAML, a text that is not a single mapping, or a duplicate key, with the line.
    pub(super) fn read(file: &'a Path, text: &'a str) -> Result<Self, DataError> {
        let mut events = Events { file, parser: Parser::new_from_str(text) };
        let mut document = Self { file, entries: Vec::new() };
        loop {
            match events.next()? {
                (Event::MappingStart(..), _) => break,
                (Event::StreamStart | Event::DocumentStart(_) | Event::Nothing, _) => {}
                (Event::StreamEnd | Event::DocumentEnd, _) => {
                    return Err(wrong(file, None, "no keys found; check that this is the right file"));
                }
                (_, line) => {
                    return Err(wrong(
                        file,
                        Some(line),
                        "expected lines `key: value`; check that this is the right file",
                    ));
                }
            }
        }
        loop {
            let (key, line) = match events.next()? {
                (Event::Scalar(key, ..), line) => (key, line),
                (Event::MappingEnd, _) => break,
                (_, line) => return Err(wrong(file, Some(line), "key: expected a scalar")),
            };
            if document.entries.iter().any(|entry| entry.key == key) {
                let key = excerpt(key.as_bytes());
                return Err(wrong(
                    file,
                    Some(line),
                    format!("{key}: duplicate key; keep one of the two lines"),
                ));
            }
            if document.entries.len() == MAX_KEYS {
                return Err(wrong(file, Some(line), format!("too many keys (expected at most {MAX_KEYS})")));
            }
            let value = events.value()?;
            document.entries.push(Entry { key, line, value });
        }
        loop {
            match events.next()? {
                (Event::StreamEnd, _) => return Ok(document),
                (Event::DocumentStart(_), line) => {
                    return Err(wrong(file, Some(line), "second document; keep only one"));
                }
                _ => {}
            }
        }
    }

    /// Returns the scalar of `key`; `None` if the key is absent.
    ///
    /// # Errors
    /// The value is a list, a mapping or null.
    pub(super) fn scalar(&self, key: &str) -> Result<Option<&Scalar<'a>>, DataError> {
        match self.entry(key) {
            None => Ok(None),
            Some(Entry { value: Value::Scalar(scalar), .. }) if !scalar.is_null() => Ok(Some(scalar)),
            Some(Entry { line, .. }) => {
                Err(wrong(self.file, Some(*line), format!("{key}: expected a single value")))
            }
        }
    }

    /// Returns the scalar of a required key.
    ///
    /// # Errors
    /// The key is absent, or its value is not a scalar.
    pub(super) fn required(&self, key: &str) -> Result<&Scalar<'a>, DataError> {
        self.scalar(key)?.ok_or_else(|| self.missing(key))
    }

    /// Returns the number of a required key, with its line.
    ///
    /// # Errors
    /// The key is absent, or its value is not a number.
    pub(super) fn number(&self, key: &str) -> Result<(f64, u64), DataError> {
        let scalar = self.required(key)?;
        Ok((self.number_in(scalar, key)?, scalar.line))
    }

    /// Returns the numbers of a required list, with their lines.
    ///
    /// # Errors
    /// The key is absent, or its value is not a list of `N` numbers.
    pub(super) fn numbers<const N: usize>(&self, key: &str) -> Result<[(f64, u64); N], DataError> {
        let entry = self.entry(key).ok_or_else(|| self.missing(key))?;
        let found = match &entry.value {
            Value::List(items) => items.as_slice(),
            _ => &[],
        };
        let numbers = found.iter().map(|item| Ok((self.number_in(item, key)?, item.line)));
        let numbers = numbers.collect::<Result<Vec<_>, DataError>>()?;
        <[_; N]>::try_from(numbers).map_err(|_| {
            let message =
                format!("{key}: wrong length (got {}, expected a list of {N} numbers)", found.len());
            wrong(self.file, Some(entry.line), message)
        })
    }

    /// Creates an error for an unexpected value.
    pub(super) fn unexpected(&self, key: &str, found: &Scalar<'_>, expected: &str) -> DataError {
        let found_text = excerpt(found.text.as_bytes());
        wrong(
            self.file,
            Some(found.line),
            format!("{key}: invalid (got '{found_text}', expected {expected})"),
        )
    }

    fn number_in(&self, scalar: &Scalar<'_>, key: &str) -> Result<f64, DataError> {
        scalar.number().ok_or_else(|| self.unexpected(key, scalar, "a number"))
    }

    fn entry(&self, key: &str) -> Option<&Entry<'a>> {
        self.entries.iter().find(|entry| entry.key == key)
    }

    fn missing(&self, key: &str) -> DataError {
        wrong(self.file, None, format!("{key}: missing key; add a line `{key}: …`"))
    }
}

impl Scalar<'_> {
    pub(super) fn text(&self) -> &str {
        &self.text
    }

    /// Parses a Boolean, written as a word or a number.
    pub(super) fn truth(&self) -> Option<bool> {
        match self.text.to_ascii_lowercase().as_str() {
            "true" | "yes" | "on" => Some(true),
            "false" | "no" | "off" => Some(false),
            digits => digits.parse::<u8>().ok().map(|number| number != 0),
        }
    }

    /// Parses a number of the YAML core schema; one beyond the range of `f64` is infinite.
    fn number(&self) -> Option<f64> {
        match self.text.trim_start_matches(['+', '-']).to_ascii_lowercase().as_str() {
            ".nan" => Some(f64::NAN),
            ".inf" => Some(if self.text.starts_with('-') { f64::NEG_INFINITY } else { f64::INFINITY }),
            digits if digits.starts_with(|first: char| first.is_ascii_digit() || first == '.') => {
                self.text.parse().ok()
            }
            _ => None,
        }
    }

    fn is_null(&self) -> bool {
        self.is_plain && matches!(&*self.text, "" | "~" | "null" | "Null" | "NULL")
    }
}

/// The parser events of a text.
struct Events<'a> {
    file: &'a Path,
    parser: Parser<'a, StrInput<'a>>,
}

impl<'a> Events<'a> {
    fn next(&mut self) -> Result<(Event<'a>, u64), DataError> {
        match self.parser.next_event() {
            Some(Ok((event, Span { start, .. }))) => Ok((event, start.line() as u64)),
            Some(Err(problem)) => Err(self.broken(&problem)),
            None => Ok((Event::StreamEnd, 0)),
        }
    }

    fn broken(&self, problem: &ScanError) -> DataError {
        wrong(self.file, Some(problem.marker().line() as u64), format!("invalid YAML: {}", problem.info()))
    }

    /// Reads one complete value.
    fn value(&mut self) -> Result<Value<'a>, DataError> {
        match self.next()? {
            (Event::Scalar(text, style, ..), line) => Ok(Value::Scalar(scalar(text, style, line))),
            (Event::SequenceStart(..), _) => self.list(),
            (Event::MappingStart(..), _) => self.skip(),
            _ => Ok(Value::Other),
        }
    }

    fn list(&mut self) -> Result<Value<'a>, DataError> {
        let mut items = Vec::new();
        loop {
            match self.next()? {
                (Event::Scalar(text, style, ..), line) => items.push(scalar(text, style, line)),
                (Event::SequenceEnd, _) => return Ok(Value::List(items)),
                (Event::SequenceStart(..) | Event::MappingStart(..), _) => {
                    self.skip()?;
                    return self.skip();
                }
                // Only an alias remains.
                _ => return self.skip(),
            }
        }
    }

    /// Skips the rest of a list or mapping whose start was read.
    fn skip(&mut self) -> Result<Value<'a>, DataError> {
        let mut depth = 1_u64;
        while depth > 0 {
            match self.next()?.0 {
                Event::SequenceStart(..) | Event::MappingStart(..) => depth += 1,
                Event::SequenceEnd | Event::MappingEnd => depth -= 1,
                Event::StreamEnd => break,
                _ => {}
            }
        }
        Ok(Value::Other)
    }
}

fn scalar(text: Cow<'_, str>, style: ScalarStyle, line: u64) -> Scalar<'_> {
    Scalar { text, is_plain: style == ScalarStyle::Plain, line }
}
