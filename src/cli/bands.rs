//! `--bands`: the areas between the lines that are written.

use std::path::PathBuf;

use clap::Args;
use tokosen::bands::{BandArea, BandKind};
use tokosen::base::ElevationUnit;
use tokosen::contour::Target;
use tokosen::crs::FromWorking;
use tokosen::io::layer::{Layer, bands_layer, of_bands};
use tokosen::io::{StagedOutput, contour_files, write_layers_back};

use super::console::Console;
use super::extensions::check_vector;
use super::failure::Failure;
use super::plane::ToCrsArgs;
use super::unit::in_units;

#[derive(Debug, Clone, Args)]
pub struct BandArgs {
    /// Also write the areas between the lines, up to the frame, as polygons: .geojson, .gpkg, .fgb, .parquet, .dxf (outlines
    /// alone), .shp, .kml or .kmz. Where they meet, they have the vertices of the lines. Attributes: elev_from, elev_to,
    /// elev_mid (half-way between), kind (ground, lake or sea), area_m2 and share (of all areas). One layer for each
    /// interval; --levels 10,20,50 chooses other levels
    #[arg(long, value_name = "FILE")]
    pub bands: Option<PathBuf>,
}

impl BandArgs {
    /// The names of the layers, one for each target; none if no bands are asked for.
    pub fn names(&self, targets: &[Target], unit: ElevationUnit) -> Vec<String> {
        let names = targets.iter().map(|target| bands_layer(&target.layer_name(unit)));
        if self.bands.is_some() { names.collect() } else { Vec::new() }
    }

    /// The files that are written for layers of these names.
    pub fn files(&self, names: &[&str], to_crs: &ToCrsArgs) -> Result<Vec<PathBuf>, Failure> {
        let Some(path) = &self.bands else { return Ok(Vec::new()) };
        check_vector(path, "areas are written as .geojson, .gpkg, .fgb, .parquet, .dxf, .shp, .kml or .kmz")?;
        to_crs.check(path)?;
        Ok(contour_files(path, names)?)
    }

    /// Opens the file, if it is asked for.
    pub fn open(&self) -> Result<Option<BandOutput>, Failure> {
        Ok(self.bands.as_deref().map(StagedOutput::create).transpose()?.map(BandOutput))
    }
}

/// The file of the bands, under a temporary name.
pub struct BandOutput(StagedOutput);

impl BandOutput {
    /// Writes the areas as layers of these names. Returns what the summary says about them.
    pub fn write(&self, names: &[&str], areas: &[Vec<BandArea>], back: &FromWorking) -> Result<Vec<String>, Failure> {
        let layers: Vec<Layer<'_>> = names.iter().zip(areas).map(|(name, areas)| of_bands(name, areas)).collect();
        let files = write_layers_back(&self.0, &layers, back)?;
        let line = |(k, areas): (usize, &Vec<BandArea>)| {
            let file = files.get(k).or(files.first()).map(|file| file.display().to_string()).unwrap_or_default();
            let water = areas.iter().filter(|area| area.kind != BandKind::Ground).count();
            let water = if water == 0 { String::new() } else { format!(", {water} of water") };
            format!("written    {file}, layer {} ({} areas{water}{})", names[k], areas.len(), in_units(back))
        };
        Ok(areas.iter().enumerate().map(line).collect())
    }

    /// Gives the file its name, and prints what is in it.
    pub fn commit(self, lines: &[String], console: &Console) -> Result<(), Failure> {
        self.0.commit()?;
        lines.iter().for_each(|line| console.say(line));
        Ok(())
    }
}
