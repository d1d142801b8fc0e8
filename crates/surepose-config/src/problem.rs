//! What can be wrong with a configuration: each problem points into the file and says what would be right.

use std::path::{Path, PathBuf};

use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode, SourceSpan};

/// A configuration that cannot be used, with every reason; it prints as the only reason where there is one.
#[derive(Debug, thiserror::Error)]
#[error("{}", headline(.file, .problems))]
pub struct ConfigError {
    /// The file that is to blame.
    pub file: PathBuf,
    text: NamedSource<String>,
    /// What is wrong with it, in the order of the file.
    pub problems: Vec<ConfigProblem>,
}

/// One thing that is wrong; it prints as `file:line: problem`.
#[derive(Debug, thiserror::Error, Diagnostic)]
#[error("{}{}: {what}", .file.display(), .line.map_or(String::new(), |line| format!(":{line}")))]
pub struct ConfigProblem {
    file: PathBuf,
    /// The line, from 1; absent where the file as a whole is to blame.
    pub line: Option<usize>,
    /// What is wrong.
    pub what: String,
    #[label("{label}")]
    place: Option<SourceSpan>,
    label: String,
    /// What would be right.
    #[help]
    pub help: Option<String>,
}

impl Diagnostic for ConfigError {
    fn source_code(&self) -> Option<&dyn SourceCode> {
        Some(&self.text)
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
    /// The problem, where there is one only.
    fn only(&self) -> Option<&ConfigProblem> {
        if let [only] = &self.problems[..] { Some(only) } else { None }
    }

    /// A file that cannot be read as text at all.
    pub(super) fn unreadable(file: &Path, line: Option<usize>, what: String, help: &str) -> Self {
        let problem = ConfigProblem {
            file: file.to_owned(),
            line,
            what,
            place: None,
            label: String::new(),
            help: Some(help.to_owned()),
        };
        Self { file: file.to_owned(), text: NamedSource::new("", String::new()), problems: vec![problem] }
    }
}

impl ConfigError {
    /// The same, of what has no lines: an option.
    pub(super) fn without_lines(mut self) -> Self {
        self.problems.iter_mut().for_each(|problem| problem.line = None);
        self
    }
}

/// Gathers the problems of one file.
pub(super) struct Problems<'t> {
    file: &'t Path,
    text: &'t str,
    found: Vec<ConfigProblem>,
}

impl<'t> Problems<'t> {
    pub(super) fn new(file: &'t Path, text: &'t str) -> Self {
        Self { file, text, found: Vec::new() }
    }

    /// Notes that the text at `span` is wrong.
    pub(super) fn add(
        &mut self,
        span: core::ops::Range<usize>,
        what: String,
        label: impl Into<String>,
        help: Option<String>,
    ) {
        let line = Some(line_of(self.text.as_bytes(), span.start));
        let (file, label) = (self.file.to_owned(), label.into());
        self.found.push(ConfigProblem { file, line, what, place: Some(span.into()), label, help });
    }

    /// The error, where there is any problem.
    pub(super) fn into_error(mut self) -> Option<ConfigError> {
        if self.found.is_empty() {
            return None;
        }
        self.found.sort_by_key(|problem| problem.line);
        let text = NamedSource::new(self.file.display().to_string(), self.text.to_owned());
        Some(ConfigError { file: self.file.to_owned(), text, problems: self.found })
    }
}

/// The line, from 1, on which the byte `offset` lies.
pub(super) fn line_of(text: &[u8], offset: usize) -> usize {
    1 + text.iter().take(offset).filter(|byte| **byte == b'\n').count()
}

fn headline(file: &Path, problems: &[ConfigProblem]) -> String {
    match problems {
        [only] => only.to_string(),
        _ => format!("{} cannot be used as a configuration, for {} reasons", file.display(), problems.len()),
    }
}
