//! The arguments about floods, and the ground under water.

use std::path::{Path, PathBuf};

use clap::Args;
use tokosen::base::Units;
use tokosen::base::error::Finding;
use tokosen::dem::derive::{Flood, FlowDirections, StreamFlood, check_depths, flood_along_streams, flood_to_level};
use tokosen::io::layer::of_flood;
use tokosen::io::raster::{Quantity, RasterParams};
use tokosen::io::{StagedOutput, write_layers};
use tokosen::raster::{Dem, GroundScale};
use tokosen::terrain::flood_source;

use super::console::Console;
use super::extensions::{check_vector, is_raster};
use super::failure::Failure;
use super::memory;
use super::output::write_if_asked;
use super::places::{self, PlaceArg};

/// Water that is deeper than this many times its height above the streams stands in a pit.
const DEEPER: f64 = 1.01;

#[derive(Debug, Clone, Args)]
pub struct FloodArgs {
    /// Ground under water at --flood-level: the depth (.tif, .exr, .png, .asc or .xyz), or areas with their volume (.gpkg,
    /// .geojson or .shp)
    #[arg(long, value_name = "FILE", requires = "flood_level")]
    pub flood: Option<PathBuf>,
    /// Level of the water [metres]: only ground that is joined to the edge of the map, or to --flood-from, by lower ground is
    /// under water. +H: H metres above the streams, see --threshold
    #[arg(long, value_name = "LEVEL|+H", value_parser = FloodLevel::parse, requires = "flood")]
    pub flood_level: Option<FloodLevel>,
    /// The water of --flood-level LEVEL comes from this place, or from the points of this file, and not from the edge of the
    /// map [coordinates of the height map]. May be given several times
    #[arg(long, value_name = "X,Y|FILE", value_parser = PlaceArg::parser(), requires = "flood", hide_short_help = true)]
    pub flood_from: Vec<PlaceArg>,
    /// Part the areas of --flood at these depths: 0.5,1,2 [metres]. Each has its depths as depth_from and depth_to; together they
    /// cover the ground under water once
    #[arg(long, value_name = "DEPTHS", value_delimiter = ',', requires = "flood", hide_short_help = true)]
    pub flood_bands: Vec<f64>,
}

/// How high water stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FloodLevel {
    /// At one level everywhere, metres.
    At(f64),
    /// So many metres above the streams.
    AboveStreams(f64),
}

impl FloodLevel {
    /// Reads a level, or a height after a plus sign.
    fn parse(text: &str) -> Result<Self, String> {
        let number = |text: &str| match text.trim().parse::<f64>() {
            Ok(number) if number.is_finite() && !text.starts_with('+') => Ok(number),
            _ => Err("it must be a level such as 12.5, or a height above the streams such as +3".to_owned()),
        };
        match text.strip_prefix('+') {
            Some(rise) => match number(rise)? {
                rise if rise > 0.0 => Ok(Self::AboveStreams(rise)),
                _ => Err("a height above the streams must be more than 0".into()),
            },
            None => number(text).map(Self::At),
        }
    }
}

/// What a flood along streams needs: where water flows, and how much ground drains through each cell.
pub struct Streams<'a> {
    pub directions: &'a FlowDirections,
    pub areas: &'a Dem,
    pub threshold: f64,
}

impl FloodArgs {
    /// Whether water rises above streams.
    pub fn is_above_streams(&self) -> bool {
        matches!(self.flood_level, Some(FloodLevel::AboveStreams(_)))
    }

    /// Refuses files that hold neither a raster nor areas, and arguments that contradict each other.
    pub fn check(&self) -> Result<(), Failure> {
        if !self.flood_from.is_empty() && self.is_above_streams() {
            let message = "--flood-from goes with --flood-level LEVEL; with +H, the water comes from the streams";
            return Err(Failure::Usage(message.into()));
        }
        check_depths(&self.flood_bands).map_err(|error| Failure::Usage(format!("--flood-bands: {error}")))?;
        if self.raster().is_some() && !self.flood_bands.is_empty() {
            return Err(Failure::Usage("--flood-bands parts areas: write --flood as .gpkg, .geojson or .shp".into()));
        }
        let kinds = "a flood is written as .gpkg, .geojson or .shp, or as a raster: .tif, .exr, .png, .asc or .xyz";
        self.areas().map_or(Ok(()), |path| check_vector(path, kinds))
    }

    /// The raster.
    pub fn raster(&self) -> Option<&Path> {
        self.flood.as_deref().filter(|path| is_raster(path))
    }

    /// The file of areas.
    pub fn areas(&self) -> Option<&Path> {
        self.flood.as_deref().filter(|path| !is_raster(path))
    }

    /// Computes the flood and writes it, still under its temporary name. `streams` are there if water rises above streams.
    pub fn write(
        &self,
        staged: &StagedOutput,
        (dem, scale, params): (&Dem, &GroundScale, &RasterParams),
        streams: Option<Streams<'_>>,
        (findings, console): (&mut Vec<Finding>, &Console),
    ) -> Result<Flood, Failure> {
        let memory = memory::available();
        let flood = match (self.flood_level, streams) {
            (Some(FloodLevel::AboveStreams(rise)), Some(Streams { directions, areas, threshold })) => {
                let params = StreamFlood { threshold, rise, memory };
                console.step("flood", || flood_along_streams(dem, directions, areas, scale, params))?
            }
            (Some(FloodLevel::At(level)), _) => {
                let places = places::read(&self.flood_from, dem.crs.as_ref(), findings)?;
                let from = flood_source(&places, dem, level)?.collect(findings);
                console.step("flood", || flood_to_level(dem, scale, level, &from, memory))?
            }
            _ => return Err(Failure::Usage("--flood needs --flood-level LEVEL or +H".into())),
        };
        if is_raster(&staged.path()) {
            let params = RasterParams { quantity: Quantity::Depth, ..*params };
            write_if_asked(Some(staged), &params, &flood.depths, console)?;
        } else {
            let parts = console.step("flood", || flood.parts(scale, &self.flood_bands));
            console.step("writing", || write_layers(staged, &[of_flood(&parts)], dem.crs.as_ref()))?;
        }
        Ok(flood)
    }

    /// The line of the summary.
    pub fn describe(&self, flood: &Flood, path: &Path, console: &Console) {
        let level = match self.flood_level {
            Some(FloodLevel::AboveStreams(rise)) => format!("{rise} m above the streams"),
            Some(FloodLevel::At(level)) if self.flood_from.is_empty() => format!("up to {level} m from the edge"),
            Some(FloodLevel::At(level)) => format!("up to {level} m"),
            None => String::new(),
        };
        console.say(&format!(
            "flood      {level}: {}, {:.0} m³, depth {:.2} m at most",
            Units::METRES.area(flood.area),
            flood.volume,
            flood.deepest
        ));
        let explained = match self.flood_level {
            Some(FloodLevel::At(_)) if flood.cells == 0 && self.flood_from.is_empty() => {
                "no ground below the level is joined to the edge of the map; --flood-from names places that water comes from"
            }
            Some(FloodLevel::AboveStreams(_)) if flood.cells == 0 => {
                "there is no stream: nowhere does so much ground as --threshold drain through a cell"
            }
            Some(FloodLevel::AboveStreams(rise)) if flood.deepest > rise * DEEPER => {
                "pits are full up to their rims, and the water there is deeper; of contours, --drain all cuts ways out of pits"
            }
            _ => "",
        };
        if !explained.is_empty() {
            console.say(&format!("           {explained}"));
        }
        console.say(&format!("written    {}", path.display()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plus_sign_is_above_the_streams() {
        assert_eq!(FloodLevel::parse("12.5"), Ok(FloodLevel::At(12.5)));
        assert_eq!(FloodLevel::parse("-3"), Ok(FloodLevel::At(-3.0)));
        assert_eq!(FloodLevel::parse("+3"), Ok(FloodLevel::AboveStreams(3.0)));
        for wrong in ["", "+", "+0", "+-1", "nan", "+inf", "3 m", "++2"] {
            assert!(FloodLevel::parse(wrong).is_err(), "{wrong}");
        }
    }
}
