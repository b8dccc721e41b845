//! The arguments about streams, and the file that tells what became of them.

use std::path::Path;

use clap::Args;
use tokosen::Input;
use tokosen::io::VectorSource;

use super::failure::Failure;
use super::source::source;

#[derive(Debug, Clone, Args)]
pub struct StreamArgs {
    /// Lines of rivers and streams, drawn in any direction: the surface falls steadily along them. Contours count more
    /// than streams. May be given several times
    #[arg(long, value_name = "FILE", value_parser = source())]
    pub streams: Vec<VectorSource>,
    /// Move streams up to this distance into the bends of contours; beyond it, contours cut streams [units of the working
    /// CRS; default: a quarter of the mean spacing of the contours]
    #[arg(long, value_name = "DISTANCE", requires = "streams", hide_short_help = true)]
    pub stream_tolerance: Option<f64>,
}

impl StreamArgs {
    /// The files that are read.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        self.streams.iter().map(|source| source.path.as_path())
    }

    /// Adds the streams to an input; reads their files.
    pub fn add_to(&self, input: &mut Input) -> Result<(), Failure> {
        self.streams.iter().try_for_each(|source| Ok(input.read_streams(source)?))
    }
}
