//! Why a verb did not finish.

use tokosen::Error;
use tokosen::base::Units;

use super::hints;

/// Why a verb did not finish.
#[derive(Debug)]
pub enum Failure {
    /// The arguments contradict each other.
    Usage(String),
    /// The library reported an error.
    Work(Error),
    /// The text of an error, in the units of the input.
    Told(String),
}

impl Failure {
    /// The same with the heights and lengths of its text in the units of the input.
    pub fn in_units(self, units: Units) -> Self {
        match self {
            Self::Work(error) => Self::Told(units.message(&hints::with_causes(&error))),
            other => other,
        }
    }
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
