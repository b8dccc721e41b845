//! The argument about the coast.

use clap::builder::TypedValueParser;
use tokosen::Input;
use tokosen::io::VectorSource;

use super::failure::Failure;
use super::source::source;

/// Where the coast is.
#[derive(Debug, Clone, PartialEq)]
pub enum CoastArg {
    /// The contours of a level.
    Level(f64),
    /// The lines or polygons of a file.
    File(VectorSource),
}

impl CoastArg {
    /// Reads a level, otherwise the name of a file.
    pub fn parser() -> impl TypedValueParser<Value = Self> {
        source().map(|source| match source.path.to_str().map(str::parse) {
            Some(Ok(level)) if source.layer.is_none() => Self::Level(level),
            _ => Self::File(source),
        })
    }

    /// The file, if it is one.
    pub fn source(&self) -> Option<&VectorSource> {
        match self {
            Self::Level(_) => None,
            Self::File(source) => Some(source),
        }
    }

    /// Adds the coast to an input; reads its file if there is one.
    pub fn add_to(&self, input: &mut Input) -> Result<(), Failure> {
        match self {
            Self::Level(level) if !level.is_finite() => {
                Err(Failure::Usage(format!("--coast is {level}, which is no elevation")))
            }
            Self::Level(level) => Ok(input.set_coast_level(*level)?),
            Self::File(source) => Ok(input.read_coast(source)?),
        }
    }
}
