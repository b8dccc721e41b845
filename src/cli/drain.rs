//! The arguments about pits.

use std::path::Path;

use clap::{Args, ValueEnum};
use tokosen::Input;
use tokosen::drain::Drain;
use tokosen::io::VectorSource;

use super::failure::Failure;
use super::source::source;

#[derive(Debug, Clone, Args)]
pub struct DrainArgs {
    /// Points or polygons where water may stay, for instance in karst or quarries: a point keeps the pit that holds it, a
    /// polygon keeps all inside. May be given several times
    #[arg(long, value_name = "FILE", value_parser = source())]
    pub sinks: Vec<VectorSource>,
    /// Which pits get a way out
    #[arg(long, value_enum, value_name = "WHICH", default_value_t = DrainArg::Safe, hide_short_help = true)]
    pub drain: DrainArg,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum DrainArg {
    /// None: pits stay
    None,
    /// Pits that no contour speaks for
    Safe,
    /// All pits, except in --sinks and in water: height maps then leave the contours where nothing else drains a pit
    All,
}

impl DrainArg {
    /// The library's setting.
    pub fn drain(self) -> Drain {
        match self {
            Self::None => Drain::None,
            Self::Safe => Drain::Safe,
            Self::All => Drain::All,
        }
    }
}

impl DrainArgs {
    /// The files that are read.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        self.sinks.iter().map(|source| source.path.as_path())
    }

    /// Adds the sinks to an input; reads their files.
    pub fn add_to(&self, input: &mut Input) -> Result<(), Failure> {
        self.sinks.iter().try_for_each(|source| Ok(input.read_sinks(source)?))
    }

    /// Whether a flag is given. Then the summary tells of pits.
    pub fn is_given(&self) -> bool {
        self.flags().iter().any(|(is_given, _)| *is_given)
    }

    /// The flags, and whether they are given.
    pub fn flags(&self) -> [(bool, &'static str); 2] {
        [(!self.sinks.is_empty(), "--sinks"), (self.drain != DrainArg::Safe, "--drain")]
    }
}
