//! What can go wrong ([`Error`]) and what was noticed on the way ([`Finding`]).
//!
//! An error stops the work. A finding does not: a step that finds something odd in its input goes on and hands the
//! finding back beside its result in a [`Report`], so that nothing is dropped without a word.

mod finding;

use std::path::{Path, PathBuf};

pub use finding::{Finding, FindingKind, Proposal, Severity};

/// The library's result.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// The cause below an error, as other crates report it.
pub type Cause = Box<dyn std::error::Error + Send + Sync + 'static>;

/// Why the work could not be done. The text says what, where and what to do about it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The operating system refused to open, read, write or rename a file.
    #[error("cannot {action} {}", path.display())]
    Io {
        /// What was tried, as a verb: "read", "write", "create".
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// The system's own word.
        source: std::io::Error,
    },
    /// A file is not what it should be. The message names the feature and the place where it can.
    #[error("{}: {message}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong and what to do.
        message: String,
        /// The error of the format's library, if that is where it came from.
        source: Option<Cause>,
    },
    /// The data were read, and no surface can be made of them.
    #[error("{0}")]
    Data(String),
    /// Parameters that contradict each other or are out of their range.
    #[error("{0}")]
    Parameter(String),
}

impl Error {
    /// An operating system error on `path`.
    pub fn io(action: &'static str, path: &Path, source: std::io::Error) -> Self {
        Self::Io { action, path: path.to_owned(), source }
    }

    /// A file whose content is wrong.
    pub fn file(path: &Path, message: impl Into<String>) -> Self {
        Self::File { path: path.to_owned(), message: message.into(), source: None }
    }

    /// The same, with the file that the data are from.
    pub fn in_file(self, path: &Path) -> Self {
        match self {
            Self::Data(message) => Self::file(path, message),
            other => other,
        }
    }

    /// A file that a format's library could not take.
    pub fn file_cause(path: &Path, message: impl Into<String>, cause: impl Into<Cause>) -> Self {
        Self::File { path: path.to_owned(), message: message.into(), source: Some(cause.into()) }
    }
}

/// A result and what was noticed while it was made.
#[derive(Debug, Clone, PartialEq)]
pub struct Report<T> {
    /// The result.
    pub value: T,
    /// What was noticed, in a fixed order.
    pub findings: Vec<Finding>,
}

impl<T> Report<T> {
    /// Takes the result and appends the findings to `all`.
    pub fn collect(self, all: &mut Vec<Finding>) -> T {
        all.extend(self.findings);
        self.value
    }
}
