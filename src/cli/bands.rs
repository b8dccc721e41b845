//! `--bands`: the areas between the lines that are written.

use std::path::PathBuf;

use clap::Args;
use tokosen::bands::{BandArea, BandKind};
use tokosen::base::ElevationUnit;
use tokosen::base::error::{Finding, Report};
use tokosen::contour::{ContourLayer, Target};
use tokosen::crs::FromWorking;
use tokosen::draw::Scene;
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
    /// The names of the layers, one for each target; none if no bands are asked for. Without targets, the interval is chosen
    /// later, and the one layer does not name it.
    pub fn names(&self, targets: &[Target], unit: ElevationUnit) -> Vec<String> {
        let open = [Target::Levels(Vec::new())];
        let targets = if targets.is_empty() { &open } else { targets };
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

    /// A picture with one colour for each band, if bands are asked for. Its lines are those of a layer at the levels of a target.
    pub fn tinted<'a>(
        &self,
        scene: Scene<'a>,
        layer: Option<(&Target, &ContourLayer)>,
        unit: ElevationUnit,
    ) -> Scene<'a> {
        let Some((target, layer)) = layer.filter(|_| self.bands.is_some()) else { return scene };
        let levels = layer.lines.iter().map(|line| line.elevation).filter(|level| target.has(unit, *level));
        let mut levels: Vec<f64> = levels.collect();
        levels.sort_by(f64::total_cmp);
        levels.dedup();
        scene.in_bands(levels)
    }

    /// Opens the file, if it is asked for.
    pub fn open(&self) -> Result<Option<BandOutput>, Failure> {
        Ok(self.bands.as_deref().map(StagedOutput::create).transpose()?.map(BandOutput))
    }
}

/// The file of the bands, under a temporary name.
pub struct BandOutput(StagedOutput);

impl BandOutput {
    /// Finds the areas between the lines of layers, each with its name and its levels, and writes them. Returns what the summary
    /// says about them.
    pub fn write(
        &self,
        layers: &[(&str, &Target, &ContourLayer)],
        areas: impl Fn(&Target, &ContourLayer) -> Report<Vec<BandArea>>,
        back: &FromWorking,
        (findings, console): (&mut Vec<Finding>, &Console),
    ) -> Result<Vec<String>, Failure> {
        console.step("bands", || {
            let areas: Vec<Vec<BandArea>> =
                layers.iter().map(|(_, target, layer)| areas(target, layer).collect(findings)).collect();
            let named = layers.iter().map(|(name, ..)| *name).zip(&areas);
            let written: Vec<Layer<'_>> = named.clone().map(|(name, areas)| of_bands(name, areas)).collect();
            let files = write_layers_back(&self.0, &written, back)?;
            let line = |(k, (name, areas)): (usize, (&str, &Vec<BandArea>))| {
                let file = files.get(k).or(files.first()).map(|file| file.display().to_string()).unwrap_or_default();
                let water = areas.iter().filter(|area| area.kind != BandKind::Ground).count();
                let water = if water == 0 { String::new() } else { format!(", {water} of water") };
                format!("written    {file}, layer {name} ({} areas{water}{})", areas.len(), in_units(back))
            };
            Ok(named.enumerate().map(line).collect())
        })
    }

    /// Gives the file its name, and prints what is in it.
    pub fn commit(self, lines: &[String], console: &Console) -> Result<(), Failure> {
        self.0.commit()?;
        lines.iter().for_each(|line| console.say(line));
        Ok(())
    }
}
