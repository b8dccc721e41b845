//! The arguments about lakes and the sea.

use std::path::{Path, PathBuf};

use clap::Args;
use tokosen::contour::ContourMap;
use tokosen::error::{Error, Finding};
use tokosen::io::{ReadOptions, read_water};
use tokosen::surface::Water;

use super::Failure;

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

    /// The water; reads the lakes if there are any, and adds what was noticed about them to `findings`.
    pub fn read(&self, map: &ContourMap, findings: &mut Vec<Finding>) -> Result<Water, Failure> {
        if let Some(sea) = self.sea.filter(|sea| !sea.is_finite()) {
            return Err(Failure::Usage(format!("--sea is {sea}, which is no elevation")));
        }
        let Some(path) = &self.water else { return Ok(Water { lakes: Vec::new(), sea: self.sea }) };
        let (lakes, crs) = read_water(path, &ReadOptions::default())?.collect(findings);
        if let (Some(a), Some(b)) = (&map.crs, &crs)
            && !a.matches(b)
        {
            let message = "is in another coordinate reference system than the contours; reproject one of them first";
            return Err(Failure::Work(Error::file(path, message)));
        }
        Ok(Water { lakes, sea: self.sea })
    }
}
