//! The arguments about lakes and the sea.

use std::path::{Path, PathBuf};

use clap::Args;
use tokosen::base::error::Error;
use tokosen::contour::Lake;
use tokosen::io::{ReadOptions, read_water};
use tokosen::subdivision::Water;

use super::Failure;
use super::map::Input;
use super::plane;

#[derive(Debug, Clone, Args)]
pub struct WaterArgs {
    /// Lakes: polygons that are level, at their elevation attribute or z, else at the height of their shore. Holes are
    /// islands
    #[arg(long, value_name = "FILE")]
    pub water: Option<PathBuf>,
    /// The level of the coast [metres], one that the input has contours at: ground that reaches only down to it is the sea,
    /// level there
    #[arg(long, value_name = "LEVEL", allow_negative_numbers = true)]
    pub sea: Option<f64>,
}

impl WaterArgs {
    /// The file with lakes, if there is one.
    pub fn file(&self) -> Option<&Path> {
        self.water.as_deref()
    }

    /// The water; reads the lakes if there are any, and adds what was noticed about them to the input's findings.
    pub fn read(&self, input: &mut Input) -> Result<Water, Failure> {
        if let Some(sea) = self.sea.filter(|sea| !sea.is_finite()) {
            return Err(Failure::Usage(format!("--sea is {sea}, which is no elevation")));
        }
        let Some(path) = &self.water else { return Ok(Water { lakes: Vec::new(), sea: self.sea }) };
        let (lakes, crs) = read_water(path, &ReadOptions::default())?.collect(&mut input.findings);
        let bring = plane::bringer(&input.places, path, crs.as_ref())?;
        let lake = |lake: Lake| -> Result<Lake, Error> {
            let polygon = bring.polygon(&lake.polygon)?;
            Ok(input.unit.lake_in_metres(Lake { polygon, ..lake }))
        };
        let lakes = lakes.into_iter().map(lake).collect::<Result<_, _>>();
        let lakes = lakes.map_err(|e| Error::file(path, e.to_string()))?;
        Ok(Water { lakes, sea: self.sea })
    }
}
