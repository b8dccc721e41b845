//! The arguments about the levels of contours, and about how lines are written.

use std::path::Path;

use clap::Args;
use tokosen::Interval;
use tokosen::contour::ContourLayer;
use tokosen::contour::Target;
use tokosen::crs::{FromWorking, Reprojection};
use tokosen::io::layer::{Layer, labels_layer, of_contours, of_labels};
use tokosen::slice::Label;

use super::bands::BandArgs;
use super::failure::Failure;
use super::labels::LabelArgs;
use super::plane::ToCrsArgs;
use super::unit::ToUnitArgs;
use super::zooms::ZoomArgs;

/// Levels named one by one, or how those of an interval are counted.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Output")]
pub struct WhichLevelsArgs {
    /// Elevations of the contours [metres, or the unit of --to-unit] instead of an interval: 12.5,13
    #[arg(
        long,
        value_name = "Z",
        value_delimiter = ',',
        conflicts_with_all = ["interval", "base_level"],
        hide_short_help = true
    )]
    pub levels: Vec<f64>,
    /// Levels are this one plus whole multiples of the interval [metres, or the unit of --to-unit]
    #[arg(long, alias = "base", value_name = "LEVEL", default_value_t = 0.0, hide_short_help = true)]
    pub base_level: f64,
    /// Every Nth level is an index contour; 0 for none
    #[arg(long, value_name = "N", default_value_t = 5, hide_short_help = true)]
    pub index: u32,
}

impl WhichLevelsArgs {
    /// The levels of each layer: those that are named, or else those of each interval.
    pub fn targets(&self, intervals: &[f64]) -> Result<Vec<Target>, Failure> {
        if let Some(bad) = self.levels.iter().chain([&self.base_level]).find(|level| !level.is_finite()) {
            return Err(Failure::Usage(format!("{bad} is no elevation")));
        }
        if let Some(bad) = intervals.iter().find(|step| !(step.is_finite() && **step > 0.0)) {
            return Err(Failure::Usage(format!("--interval is {bad}, it must be more than 0")));
        }
        if !self.levels.is_empty() {
            return Ok(vec![Target::Levels(self.levels.clone())]);
        }
        Ok(intervals.iter().map(|&step| Interval { step, base: self.base_level, rounding: 0.0 }.into()).collect())
    }
}

/// Which contours to write, in which coordinates and unit.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Output")]
pub struct LevelsArgs {
    /// Interval of the contours [metres, or the unit of --to-unit], or several: 5,2,1
    #[arg(short, long, value_name = "STEP", value_delimiter = ',', required_unless_present_any = ["levels", "zooms", "scale"])]
    interval: Vec<f64>,
    #[command(flatten)]
    pub which: WhichLevelsArgs,
    #[command(flatten)]
    pub zooms: ZoomArgs,
    #[command(flatten)]
    pub labels: LabelArgs,
    #[command(flatten)]
    pub bands: BandArgs,
    #[command(flatten)]
    pub to_crs: ToCrsArgs,
    #[command(flatten)]
    pub to_unit: ToUnitArgs,
    /// Also write depths, positive downwards, as attributes: depth of lines and labels; depth_from, depth_to and depth_mid of
    /// bands. The text of labels is then the depth. Heights in options, and z, stay heights
    #[arg(long, hide_short_help = true)]
    pub to_depths: bool,
}

impl LevelsArgs {
    /// The levels of each layer.
    pub fn targets(&self) -> Result<Vec<Target>, Failure> {
        // Tiles need the lines of the smallest interval.
        let smallest = || self.zooms.zooms.iter().map(|(_, step)| *step).min_by(f64::total_cmp);
        match self.interval.as_slice() {
            [] => self.which.targets(smallest().as_slice()),
            intervals => self.which.targets(intervals),
        }
    }

    /// The conversion from the working plane to what is written in a file.
    pub fn way(&self, output: &Path, reprojection: &Reprojection) -> Result<FromWorking, Failure> {
        let back = self.to_crs.way(Some(output), reprojection, self.to_unit.unit())?;
        Ok(if self.to_depths { back.with_depths() } else { back })
    }

    /// The names of all layers: of the contours, each followed by that of its labels if there are any. Without targets, the
    /// interval is chosen later, and the one layer does not name it.
    pub fn layer_names(&self, targets: &[Target]) -> Vec<String> {
        let open = [Target::Levels(Vec::new())];
        let targets = if targets.is_empty() { &open } else { targets };
        let contours = targets.iter().map(|target| target.layer_name(self.to_unit.unit()));
        if self.labels.labels.is_none() {
            return contours.collect();
        }
        let alone = targets.len() == 1;
        contours.flat_map(|name| [name.clone(), labels_layer(&name, alone)]).collect()
    }
}

/// The layers of contours, each followed by that of its labels if there are any. `names` are those of all layers.
pub fn output_layers<'a>(
    layers: &'a [ContourLayer],
    labels: Option<&'a [Vec<Label>]>,
    names: &[&'a str],
    back: &FromWorking,
) -> Vec<Layer<'a>> {
    let mut all = Vec::with_capacity(names.len());
    for (k, layer) in layers.iter().enumerate() {
        all.push(of_contours(layer));
        all.extend(labels.map(|labels| of_labels(names[2 * k + 1], &labels[k], back)));
    }
    all
}
