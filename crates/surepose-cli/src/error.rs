//! The errors of the commands, with their exit codes.

use std::path::PathBuf;

use miette::{Diagnostic, GraphicalReportHandler};
use surepose_config::ConfigError;
use surepose_figures::PlotError;
use surepose_io::{DataError, Problem};

use crate::exit::Exit;

/// Columns of a message.
pub(crate) const WIDTH: u16 = 110;

/// The reason why a command failed.
#[derive(Debug, thiserror::Error, Diagnostic)]
pub(crate) enum CliError {
    /// Invalid configuration.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Config(#[from] ConfigError),
    /// Unusable recording, map or list of start poses.
    #[error(transparent)]
    Data(#[from] DataError),
    /// A recording that is readable but not usable.
    #[error("{}: {what}", .path.display())]
    Recording {
        /// The file or directory.
        path: PathBuf,
        /// The reason.
        what: String,
    },
    /// An invalid option or combination of options.
    #[error("{what}")]
    Usage {
        /// The problem.
        what: String,
        /// The remedy.
        #[help]
        help: String,
    },
    /// Standard output is not writable.
    #[error("standard output: cannot be written: {problem}")]
    #[diagnostic(help("free space at its destination, or redirect it"))]
    Print {
        /// The reason.
        problem: std::io::Error,
    },
    /// An output file or directory is not writable.
    #[error("{}: cannot be written: {problem}", .path.display())]
    #[diagnostic(help("{}", .wanted.help()))]
    Output {
        /// The file or directory.
        path: PathBuf,
        /// The reason.
        problem: PlotError,
        /// The kind of output.
        wanted: OutputKind,
    },
}

/// The kind of output, for the remedy in the error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum OutputKind {
    /// A directory for several files.
    Folder,
    /// A single file.
    File,
    /// The directory of a recording.
    Recording,
}

impl OutputKind {
    fn help(self) -> &'static str {
        match self {
            Self::Folder => "give --out a writable directory",
            Self::File => "give --out the name of a file in a writable directory",
            Self::Recording => "give --record a writable directory without a recording",
        }
    }
}

impl CliError {
    /// Returns the exit code of the error.
    pub(crate) fn exit(&self) -> Exit {
        match self {
            Self::Config(_) | Self::Usage { .. } | Self::Output { .. } | Self::Print { .. } => Exit::Usage,
            // The recording is valid; the option names a robot that it does not contain.
            Self::Data(error) if matches!(error.problem, Problem::UnknownRobot { .. }) => Exit::Usage,
            Self::Data(_) | Self::Recording { .. } => Exit::Data,
        }
    }
}

/// Installs the style of error messages: no links; on terminals, color and lines of width [`WIDTH`].
///
/// Elsewhere, lines are not broken, so that a search in a log finds a phrase whatever the length of the path
/// before it.
pub(crate) fn style_messages() {
    let install = miette::set_hook(Box::new(|_| {
        let terminal = std::io::IsTerminal::is_terminal(&std::io::stderr());
        let theme = if terminal && !no_color() {
            miette::GraphicalTheme::unicode()
        } else {
            miette::GraphicalTheme::unicode_nocolor()
        };
        // Paths are not broken, so that they can be searched and clicked.
        let handler = GraphicalReportHandler::new_themed(theme)
            .with_width(usize::from(WIDTH))
            .with_wrap_lines(terminal)
            .with_links(false)
            .with_break_words(false)
            .with_word_separator(textwrap::WordSeparator::AsciiSpace)
            .with_word_splitter(textwrap::WordSplitter::NoHyphenation);
        Box::new(handler)
    }));
    // If a hook is already installed, it prints the messages.
    drop(install);
}

fn no_color() -> bool {
    std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty())
}
