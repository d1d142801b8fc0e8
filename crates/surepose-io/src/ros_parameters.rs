//! Reads parameter files of ROS 2: YAML of node names, `ros__parameters` and nested names.
//!
//! ```yaml
//! /**:
//!   ros__parameters:
//!     law: {k_v: 2.0}
//!     robot.track_m: 0.4
//! ```

use std::path::Path;

use saphyr_parser::{Event, Parser, Span};

use crate::document::{utf8, wrong};
use crate::error::DataError;
use crate::source::{MAX_DOCUMENT_BYTES, read_all};

/// Key that separates the name of the node from those of its parameters.
const SEPARATOR: &str = "ros__parameters";

/// Maximum number of nested mappings.
const MAX_DEPTH: usize = 32;

/// A parameter of a node.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RosParameter {
    /// Name of the node, which may contain the wildcards `*` (one token) and `**` (any number of tokens).
    pub node: String,
    /// Name of the parameter: nested names are joined by dots.
    pub name: String,
    /// Value as written.
    pub value: String,
    /// Line in the file, from 1.
    pub line: u64,
}

impl RosParameter {
    /// Whether the parameter is one of the node with this full name, such as `/robot1/surepose`.
    pub fn is_of(&self, node: &str) -> bool {
        let tokens = |name: &str| -> Vec<String> {
            name.split('/').filter(|token| !token.is_empty()).map(str::to_owned).collect()
        };
        let (pattern, node) = (tokens(&self.node), tokens(node));
        // A name without a slash is that of a node in the root namespace.
        matches(&pattern, &node)
    }
}

fn matches(pattern: &[String], node: &[String]) -> bool {
    match (pattern.split_first(), node.split_first()) {
        (None, None) => true,
        (Some((first, rest)), _) if first == "**" => {
            (0..=node.len()).any(|skipped| matches(rest, &node[skipped..]))
        }
        (Some((first, rest)), Some((token, others))) => {
            (first == "*" || first == token) && matches(rest, others)
        }
        _ => false,
    }
}

/// Reads the parameters of a file, in its order.
///
/// # Errors
/// A missing, unreadable or malformed file, with name and line.
pub fn read(path: &Path) -> Result<Vec<RosParameter>, DataError> {
    parse(path, &read_all(path, MAX_DOCUMENT_BYTES)?)
}

/// Parses the text of a file; `file` is its name in errors.
///
/// # Errors
/// Invalid YAML, a list, or a value outside of `ros__parameters`, with the line.
pub fn parse(file: &Path, bytes: &[u8]) -> Result<Vec<RosParameter>, DataError> {
    let mut parser = Parser::new_from_str(utf8(file, bytes)?);
    let mut parameters = Vec::new();
    // Keys of the open mappings; `None` where a key is expected.
    let mut keys: Vec<Option<String>> = Vec::new();
    while let Some(event) = parser.next_event() {
        let (event, Span { start, .. }) = event.map_err(|problem| {
            let line = problem.marker().line() as u64;
            wrong(file, Some(line), format!("invalid YAML: {}", problem.info()))
        })?;
        let line = start.line() as u64;
        match event {
            Event::MappingStart(..) if keys.len() == MAX_DEPTH => {
                return Err(wrong(
                    file,
                    Some(line),
                    format!("nested too deeply (expected at most {MAX_DEPTH} levels)"),
                ));
            }
            Event::MappingStart(..) => keys.push(None),
            Event::MappingEnd => {
                keys.pop();
                if let Some(key) = keys.last_mut() {
                    *key = None;
                }
            }
            Event::Scalar(text, ..) => match keys.last_mut() {
                None => {
                    return Err(wrong(file, Some(line), "expected a mapping from node names to parameters"));
                }
                Some(key @ None) => *key = Some(text.into_owned()),
                Some(_) => {
                    parameters.push(parameter(file, &keys, text.into_owned(), line)?);
                    if let Some(key) = keys.last_mut() {
                        *key = None;
                    }
                }
            },
            Event::SequenceStart(..) | Event::Alias(_) => {
                let name = keys.last().and_then(Option::as_deref).unwrap_or_default();
                return Err(wrong(
                    file,
                    Some(line),
                    format!("{name}: expected a single value (got a list or an alias)"),
                ));
            }
            _ => {}
        }
    }
    Ok(parameters)
}

fn parameter(
    file: &Path,
    keys: &[Option<String>],
    value: String,
    line: u64,
) -> Result<RosParameter, DataError> {
    let path: Vec<&str> = keys.iter().flatten().map(String::as_str).collect();
    let Some(at) = path.iter().position(|key| *key == SEPARATOR) else {
        let message = format!(
            "{}: outside of {SEPARATOR}; write NODE: {{{SEPARATOR}: {{NAME: VALUE}}}}",
            path.join(".")
        );
        return Err(wrong(file, Some(line), message));
    };
    Ok(RosParameter { node: path[..at].join("/"), name: path[at + 1..].join("."), value, line })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> Result<Vec<RosParameter>, String> {
        parse(Path::new("p.yaml"), text.as_bytes()).map_err(|error| error.to_string())
    }

    #[test]
    fn nested_names_are_joined() {
        let text = "/**:\n  ros__parameters:\n    law: {k_v: 2.0}\n    robot.track_m: 0.4\nrobot1:\n  surepose:\n    ros__parameters:\n      law:\n        name: paper\n";
        let parameters = parsed(text).unwrap();
        let short: Vec<_> =
            parameters.iter().map(|p| (p.node.as_str(), p.name.as_str(), p.value.as_str(), p.line)).collect();
        assert_eq!(
            short,
            [
                ("/**", "law.k_v", "2.0", 3),
                ("/**", "robot.track_m", "0.4", 4),
                ("robot1/surepose", "law.name", "paper", 9)
            ]
        );
        assert!(parameters[0].is_of("/surepose") && parameters[0].is_of("/robot1/surepose"));
        assert!(parameters[2].is_of("/robot1/surepose") && !parameters[2].is_of("/surepose"));
    }

    #[test]
    fn wildcards_stand_for_tokens() {
        let is = |pattern: &str, node: &str| {
            let (name, value) = (String::new(), String::new());
            RosParameter { node: pattern.to_owned(), name, value, line: 1 }.is_of(node)
        };
        assert!(is("/*", "/surepose") && !is("/*", "/a/surepose"));
        assert!(
            is("/*/surepose", "/a/surepose")
                && is("/**/surepose", "/surepose")
                && is("/**/surepose", "/a/b/surepose")
        );
        assert!(is("surepose", "/surepose") && !is("other", "/surepose"));
    }

    #[test]
    fn mistakes_are_named_with_their_line() {
        assert!(
            parsed("surepose:\n  law: 1\n")
                .unwrap_err()
                .contains("p.yaml:2: surepose.law: outside of ros__parameters")
        );
        let list = parsed("a:\n  ros__parameters:\n    b: [1, 2]\n").unwrap_err();
        assert!(list.contains("p.yaml:3: b: expected a single value"), "{list}");
        assert!(parsed("a: [").is_err() && parsed("text").is_err());
        let deep = "a: {".repeat(100) + &"}".repeat(100);
        assert!(parsed(&deep).unwrap_err().contains("nested too deeply"));
    }
}
