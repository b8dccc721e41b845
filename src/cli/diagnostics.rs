//! `--diagnostics`: a GeoPackage with what became of streams and other lines, the pits that are left, and where the inputs
//! contradict each other.

use std::path::PathBuf;

use clap::Args;
use tokosen::Terrain;
use tokosen::base::ElevationUnit;
use tokosen::drain::Pit;
use tokosen::io::layer::{break_lines, of_conflicts, pit_points, stream_lines};
use tokosen::io::{PlannedOutput, StagedOutput, write_layers_back};

use super::console::Console;
use super::extensions::check_extension;
use super::failure::Failure;

#[derive(Debug, Clone, Args)]
pub struct DiagnosticsArgs {
    /// Also write the streams and break lines as they are used, the pits that are left with the reason why they stay, and the
    /// places where lines, lakes and spot heights contradict the contours: .gpkg
    #[arg(long, value_name = "FILE", hide_short_help = true)]
    pub diagnostics: Option<PathBuf>,
}

/// The layers.
const LAYERS: [&str; 4] = ["sinks", "streams", "breaklines", "conflicts"];

impl DiagnosticsArgs {
    /// The file as an output of the run.
    pub fn planned(&self) -> Option<PlannedOutput<'_>> {
        self.diagnostics.as_deref().map(|path| PlannedOutput { path, layers: &LAYERS })
    }

    /// Opens the file, if it is asked for.
    pub fn open(&self) -> Result<Option<Diagnostics>, Failure> {
        let Some(path) = &self.diagnostics else { return Ok(None) };
        check_extension(path, "diagnostics", &["gpkg"])?;
        Ok(Some(Diagnostics(StagedOutput::create(path)?)))
    }
}

/// The file that is written.
pub struct Diagnostics(StagedOutput);

impl Diagnostics {
    /// Writes the layers, in the coordinates of the contours: one each, even if it is empty.
    pub fn write(&self, terrain: &Terrain, pits: &[Pit], unit: ElevationUnit) -> Result<(), Failure> {
        let back = terrain.to_output(None)?.with_heights_in(unit);
        let layers = [
            pit_points(pits),
            stream_lines(&terrain.surface.streams),
            break_lines(&terrain.surface.break_lines),
            of_conflicts(&terrain.findings, &back),
        ];
        write_layers_back(&self.0, &layers, &back)?;
        Ok(())
    }

    /// Puts the file in its place.
    pub fn commit(self, console: &Console) -> Result<(), Failure> {
        console.say(&format!("written    {}", self.0.commit()?.display()));
        Ok(())
    }
}
