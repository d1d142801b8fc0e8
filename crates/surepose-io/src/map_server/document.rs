//! The YAML file as it is written: a mapping from keys to scalars and lists, each with its line.

use std::borrow::Cow;
use std::path::Path;

use saphyr_parser::{Event, Parser, ScalarStyle, ScanError, Span, StrInput};

use crate::document::wrong;
use crate::error::{DataError, excerpt};

/// Most keys that are read: map servers know seven.
const MAX_KEYS: usize = 1000;

/// A scalar of the document, and its line.
pub(super) struct Scalar<'a> {
    text: Cow<'a, str>,
    is_plain: bool,
    pub(super) line: u64,
}

/// What stands behind a key.
enum Value<'a> {
    Scalar(Scalar<'a>),
    List(Vec<Scalar<'a>>),
    /// A mapping, an alias, or a list of something other than scalars.
    Other,
}

/// The keys of the document in their order. Keys that other tools add are among them.
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
    /// Reads `text`, which must be one mapping.
    ///
    /// # Errors
    /// Text that is not YAML, is not one mapping, or has a key twice, by line.
    pub(super) fn read(file: &'a Path, text: &'a str) -> Result<Self, DataError> {
        let mut events = Events { file, parser: Parser::new_from_str(text) };
        let mut document = Self { file, entries: Vec::new() };
        loop {
            match events.next()? {
                (Event::MappingStart(..), _) => break,
                (Event::StreamStart | Event::DocumentStart(_) | Event::Nothing, _) => {}
                (Event::StreamEnd | Event::DocumentEnd, _) => {
                    return Err(wrong(file, None, "holds no keys; is this the right file?"));
                }
                (_, line) => {
                    return Err(wrong(
                        file,
                        Some(line),
                        "expected lines `key: value`; is this the right file?",
                    ));
                }
            }
        }
        loop {
            let (key, line) = match events.next()? {
                (Event::Scalar(key, ..), line) => (key, line),
                (Event::MappingEnd, _) => break,
                (_, line) => return Err(wrong(file, Some(line), "a key must be a plain word")),
            };
            if document.entries.iter().any(|entry| entry.key == key) {
                let key = excerpt(key.as_bytes());
                return Err(wrong(
                    file,
                    Some(line),
                    format!("{key} is given twice; keep one of the two lines"),
                ));
            }
            if document.entries.len() == MAX_KEYS {
                return Err(wrong(file, Some(line), format!("holds more than {MAX_KEYS} keys")));
            }
            let value = events.value()?;
            document.entries.push(Entry { key, line, value });
        }
        loop {
            match events.next()? {
                (Event::StreamEnd, _) => return Ok(document),
                (Event::DocumentStart(_), line) => {
                    return Err(wrong(file, Some(line), "a second document starts here; keep one"));
                }
                _ => {}
            }
        }
    }

    /// The scalar behind `key`. `None`: the key is absent.
    ///
    /// # Errors
    /// A list or a mapping, or nothing at all, behind it.
    pub(super) fn scalar(&self, key: &str) -> Result<Option<&Scalar<'a>>, DataError> {
        match self.entry(key) {
            None => Ok(None),
            Some(Entry { value: Value::Scalar(scalar), .. }) if !scalar.is_null() => Ok(Some(scalar)),
            Some(Entry { line, .. }) => {
                Err(wrong(self.file, Some(*line), format!("{key} must be a single value")))
            }
        }
    }

    /// The scalar behind a key that must be there.
    ///
    /// # Errors
    /// The key is absent, or no scalar stands behind it.
    pub(super) fn required(&self, key: &str) -> Result<&Scalar<'a>, DataError> {
        self.scalar(key)?.ok_or_else(|| self.missing(key))
    }

    /// The number behind a key that must be there, and its line.
    ///
    /// # Errors
    /// The key is absent, or no number stands behind it.
    pub(super) fn number(&self, key: &str) -> Result<(f64, u64), DataError> {
        let scalar = self.required(key)?;
        Ok((self.number_in(scalar, key)?, scalar.line))
    }

    /// The numbers of a list that must be there, and their lines.
    ///
    /// # Errors
    /// The key is absent, or no list of `N` numbers stands behind it.
    pub(super) fn numbers<const N: usize>(&self, key: &str) -> Result<[(f64, u64); N], DataError> {
        let entry = self.entry(key).ok_or_else(|| self.missing(key))?;
        let found = match &entry.value {
            Value::List(items) => items.as_slice(),
            _ => &[],
        };
        let numbers = found.iter().map(|item| Ok((self.number_in(item, key)?, item.line)));
        let numbers = numbers.collect::<Result<Vec<_>, DataError>>()?;
        <[_; N]>::try_from(numbers).map_err(|_| {
            let message = format!("{key} must be a list of {N} numbers (got {})", found.len());
            wrong(self.file, Some(entry.line), message)
        })
    }

    /// What is wrong with the value of a key.
    pub(super) fn unexpected(&self, key: &str, found: &Scalar<'_>, expected: &str) -> DataError {
        let found_text = excerpt(found.text.as_bytes());
        wrong(self.file, Some(found.line), format!("{key} is '{found_text}', expected {expected}"))
    }

    fn number_in(&self, scalar: &Scalar<'_>, key: &str) -> Result<f64, DataError> {
        scalar.number().ok_or_else(|| self.unexpected(key, scalar, "a number"))
    }

    fn entry(&self, key: &str) -> Option<&Entry<'a>> {
        self.entries.iter().find(|entry| entry.key == key)
    }

    fn missing(&self, key: &str) -> DataError {
        wrong(self.file, None, format!("the key {key} is missing; add a line `{key}: …`"))
    }
}

impl Scalar<'_> {
    pub(super) fn text(&self) -> &str {
        &self.text
    }

    /// A truth, written as such or as a number.
    pub(super) fn truth(&self) -> Option<bool> {
        match self.text.to_ascii_lowercase().as_str() {
            "true" | "yes" | "on" => Some(true),
            "false" | "no" | "off" => Some(false),
            digits => digits.parse::<u8>().ok().map(|number| number != 0),
        }
    }

    /// A number of YAML's core schema; too large a one is infinite.
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

/// The events of a text, one by one.
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
        wrong(self.file, Some(problem.marker().line() as u64), format!("is not YAML: {}", problem.info()))
    }

    /// Reads one value to its end.
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

    /// Passes over what is left of a list or mapping of which the start was read.
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
