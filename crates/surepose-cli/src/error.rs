//! What stops a command, and the exit code it stops with.

use std::path::PathBuf;

use miette::{Diagnostic, GraphicalReportHandler};
use surepose_config::ConfigError;
use surepose_figures::PlotError;
use surepose_io::{DataError, Problem};

use crate::exit::Exit;

/// Columns of a message.
pub(crate) const WIDTH: u16 = 110;

/// Why a command could not do its work.
#[derive(Debug, thiserror::Error, Diagnostic)]
pub(crate) enum CliError {
    /// The configuration is wrong.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Config(#[from] ConfigError),
    /// A recording, map or list cannot be used.
    #[error(transparent)]
    Data(#[from] DataError),
    /// A recording can be read, but not used.
    #[error("{}: {what}", .path.display())]
    Recording {
        /// Which.
        path: PathBuf,
        /// Why.
        what: String,
    },
    /// The options do not make sense together.
    #[error("{what}")]
    Usage {
        /// What is wrong.
        what: String,
        /// What would be right.
        #[help]
        help: String,
    },
    /// The result cannot be printed.
    #[error("standard output cannot be written to: {problem}")]
    #[diagnostic(help("free space where it goes to, or send it elsewhere"))]
    Print {
        /// Why.
        problem: std::io::Error,
    },
    /// The results cannot be written.
    #[error("{}: cannot be written: {problem}", .path.display())]
    #[diagnostic(help("{}", .wanted.help()))]
    Output {
        /// Where to.
        path: PathBuf,
        /// Why.
        problem: PlotError,
        /// What it was to be.
        wanted: OutputKind,
    },
}

/// What results are written to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum OutputKind {
    /// Several of them.
    Folder,
    /// One.
    File,
}

impl OutputKind {
    fn help(self) -> &'static str {
        match self {
            Self::Folder => "give a folder that can be written to",
            Self::File => "give --out the name of a file, in a folder that can be written to",
        }
    }
}

impl CliError {
    /// The exit code that says so.
    pub(crate) fn exit(&self) -> Exit {
        match self {
            Self::Config(_) | Self::Usage { .. } | Self::Output { .. } | Self::Print { .. } => Exit::Usage,
            // The recording is in order: it is the option that asks for what is not there.
            Self::Data(error) if matches!(error.problem, Problem::UnknownRobot { .. }) => Exit::Usage,
            Self::Data(_) | Self::Recording { .. } => Exit::Data,
        }
    }
}

/// Makes messages as wide as the project's lines, without links, and with colours on a terminal only.
pub(crate) fn style_messages() {
    let install = miette::set_hook(Box::new(|_| {
        let theme = if std::io::IsTerminal::is_terminal(&std::io::stderr()) && !no_color() {
            miette::GraphicalTheme::unicode()
        } else {
            miette::GraphicalTheme::unicode_nocolor()
        };
        // A path must stay in one piece, to be found and clicked.
        let handler = GraphicalReportHandler::new_themed(theme)
            .with_width(usize::from(WIDTH))
            .with_links(false)
            .with_break_words(false)
            .with_word_separator(textwrap::WordSeparator::AsciiSpace)
            .with_word_splitter(textwrap::WordSplitter::NoHyphenation);
        Box::new(handler)
    }));
    // A hook that is set already prints as well.
    drop(install);
}

fn no_color() -> bool {
    std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty())
}
