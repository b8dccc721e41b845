//! The arguments about break lines.

use std::path::Path;

use clap::Args;
use tokosen::Input;
use tokosen::io::VectorSource;

use super::failure::Failure;
use super::source::source;

#[derive(Debug, Clone, Args)]
pub struct BreakLineArgs {
    /// Break lines: lines along which the ground bends sharply, such as edges of ditches and embankments. Lines with z give
    /// heights, which the surface then passes through. An attribute kind = ridge, valley or edge says how the ground bends.
    /// Can be given several times
    #[arg(long, value_name = "FILE", value_parser = source())]
    pub breaklines: Vec<VectorSource>,
}

impl BreakLineArgs {
    /// The files with break lines.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        self.breaklines.iter().map(|source| source.path.as_path())
    }

    /// Adds the break lines to an input; reads their files.
    pub fn add_to(&self, input: &mut Input) -> Result<(), Failure> {
        self.breaklines.iter().try_for_each(|source| Ok(input.read_break_lines(source)?))
    }
}
