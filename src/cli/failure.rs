//! Why a verb did not finish.

use tokosen::Error;

use super::hints;

/// Why a verb did not finish.
#[derive(Debug)]
pub enum Failure {
    /// The arguments contradict each other.
    Usage(String),
    /// The library reported an error.
    Work(Error),
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        if error.is_about_parameters() {
            Self::Usage(hints::with_flags(&error, error.to_string()))
        } else {
            Self::Work(error)
        }
    }
}
