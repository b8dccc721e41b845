//! The argument about cliffs.

use std::path::Path;

use clap::Args;
use tokosen::Input;
use tokosen::io::VectorSource;

use super::failure::Failure;
use super::source::source;

#[derive(Debug, Clone, Args)]
pub struct CliffArgs {
    /// Cliffs: lines across which the surface may jump. Contours that end at them or run together in them are no fault. Can
    /// be given several times
    #[arg(long, value_name = "FILE", value_parser = source())]
    pub cliffs: Vec<VectorSource>,
}

impl CliffArgs {
    /// The files with cliffs.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        self.cliffs.iter().map(|source| source.path.as_path())
    }

    /// Adds the cliffs to an input; reads their files.
    pub fn add_to(&self, input: &mut Input) -> Result<(), Failure> {
        self.cliffs.iter().try_for_each(|source| Ok(input.read_cliffs(source)?))
    }
}
