//! Defines configuration errors: each problem has its location in the file and a remedy.

use std::path::{Path, PathBuf};

use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode, SourceSpan};

/// An invalid configuration with all its problems; a single problem prints without a headline.
#[derive(Debug, thiserror::Error)]
#[error("{}", headline(.file, .problems, *.more))]
pub struct ConfigError {
    /// The file, or the option on the command line.
    pub file: PathBuf,
    text: Box<NamedSource<String>>,
    /// The problems, in the order of the file; at most 20.
    pub problems: Vec<ConfigProblem>,
    /// Number of further problems.
    more: usize,
}

/// Maximum number of problems that an error describes.
const MAX_PROBLEMS: usize = 20;

/// One problem; prints as `file:line: problem`.
#[derive(Debug, thiserror::Error, Diagnostic)]
#[error("{}{}: {what}", .file.display(), .line.map_or(String::new(), |line| format!(":{line}")))]
pub struct ConfigProblem {
    file: PathBuf,
    /// The line, counted from 1; `None` for a problem of the whole file.
    pub line: Option<usize>,
    /// The problem.
    pub what: String,
    #[label("{label}")]
    place: Option<SourceSpan>,
    label: String,
    /// The remedy.
    #[help]
    pub help: Option<String>,
}

impl Diagnostic for ConfigError {
    fn source_code(&self) -> Option<&dyn SourceCode> {
        Some(&*self.text)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        self.only()?.labels()
    }

    fn help(&self) -> Option<Box<dyn std::fmt::Display + '_>> {
        self.only()?.help()
    }

    fn related(&self) -> Option<Box<dyn Iterator<Item = &dyn Diagnostic> + '_>> {
        let all = || self.problems.iter().map(|problem| problem as &dyn Diagnostic);
        self.only().is_none().then(|| Box::new(all()) as Box<_>)
    }
}

impl ConfigError {
    /// Returns the problem if there is exactly one.
    fn only(&self) -> Option<&ConfigProblem> {
        if let [only] = &self.problems[..] { Some(only) } else { None }
    }

    /// Creates an error for a file that is unreadable as a whole.
    pub(super) fn unreadable(file: &Path, line: Option<usize>, what: String, help: &str) -> Self {
        let problem = ConfigProblem {
            file: file.to_owned(),
            line,
            what,
            place: None,
            label: String::new(),
            help: Some(help.to_owned()),
        };
        let text = Box::new(NamedSource::new("", String::new()));
        Self { file: file.to_owned(), text, problems: vec![problem], more: 0 }
    }
}

impl ConfigError {
    /// Creates an error of a command-line option.
    pub fn of_option(option: &str, what: String, help: &str) -> Self {
        Self::unreadable(Path::new(option), None, what, help)
    }

    /// Removes the line numbers, for a command-line option.
    pub(super) fn without_lines(mut self) -> Self {
        self.problems.iter_mut().for_each(|problem| problem.line = None);
        self
    }
}

/// Collects the problems of one file.
pub(super) struct Problems<'t> {
    file: &'t Path,
    text: &'t str,
    found: Vec<ConfigProblem>,
    more: usize,
}

impl<'t> Problems<'t> {
    pub(super) fn new(file: &'t Path, text: &'t str) -> Self {
        Self { file, text, found: Vec::new(), more: 0 }
    }

    /// Adds a problem of the text at `span`.
    pub(super) fn add(
        &mut self,
        span: core::ops::Range<usize>,
        what: String,
        label: impl Into<String>,
        help: Option<String>,
    ) {
        if self.is_full() {
            return self.count_only();
        }
        let line = Some(line_of(self.text.as_bytes(), span.start));
        let (file, label) = (self.file.to_owned(), label.into());
        self.found.push(ConfigProblem { file, line, what, place: Some(span.into()), label, help });
    }

    /// Whether further problems are only counted.
    pub(super) fn is_full(&self) -> bool {
        self.found.len() >= MAX_PROBLEMS
    }

    /// Counts a problem without a description.
    pub(super) fn count_only(&mut self) {
        self.more += 1;
    }

    /// Returns the error; `None` if there is no problem.
    pub(super) fn into_error(mut self) -> Option<ConfigError> {
        if self.found.is_empty() {
            return None;
        }
        self.found.sort_by_key(|problem| problem.line);
        let text = Box::new(NamedSource::new(self.file.display().to_string(), self.text.to_owned()));
        Some(ConfigError { file: self.file.to_owned(), text, problems: self.found, more: self.more })
    }
}

/// Returns the line, counted from 1, of the byte `offset`.
pub(super) fn line_of(text: &[u8], offset: usize) -> usize {
    1 + text.iter().take(offset).filter(|byte| **byte == b'\n').count()
}

fn headline(file: &Path, problems: &[ConfigProblem], more: usize) -> String {
    let (file, count) = (file.display(), problems.len() + more);
    match problems {
        [only] => only.to_string(),
        _ if more > 0 => {
            format!("{file}: invalid configuration ({count} problems, of which {} follow)", problems.len())
        }
        _ => format!("{file}: invalid configuration ({count} problems)"),
    }
}
