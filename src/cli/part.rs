//! The arguments about the part of the map that is written.

use std::path::Path;

use clap::Args;
use geo::MultiPolygon;
use tokosen::Input;
use tokosen::crs::Crs;
use tokosen::io::VectorSource;
use tokosen::raster::Dem;
use tokosen::terrain::{extent_on, read_area_on};

use super::failure::Failure;
use super::flags::first_given;
use super::memory;
use super::plane;
use super::source::source;

/// The part of the map that is written.
#[derive(Debug, Clone, Args)]
pub struct PartArgs {
    /// Write this part of the map only; the contours around it still count [coordinates of the input]
    #[arg(
        long,
        value_name = "XMIN,YMIN,XMAX,YMAX",
        value_parser = extent,
        conflicts_with = "clip"
    )]
    pub extent: Option<Extent>,
    /// Coordinate reference system of --extent, if it is not that of the input
    #[arg(long, value_name = "CRS", value_parser = plane::crs, requires = "extent", hide_short_help = true)]
    pub extent_crs: Option<Crs>,
    /// Write the part of the map inside the polygons of this file only; the contours around it still count. With --frame,
    /// the ground ends at the polygon
    #[arg(long, value_name = "FILE", value_parser = source())]
    pub clip: Option<VectorSource>,
}

/// Least x, least y, greatest x, greatest y.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent([f64; 4]);

fn extent(text: &str) -> Result<Extent, String> {
    let numbers = text.split([',', ' ']).filter(|part| !part.is_empty()).map(|part| part.trim().parse::<f64>());
    let numbers: Result<Vec<f64>, _> = numbers.collect();
    match numbers.as_deref() {
        Ok(&[west, south, east, north]) if west < east && south < north => Ok(Extent([west, south, east, north])),
        Ok(&[west, south, east, north]) => {
            Err(format!("{west} must be less than {east}, and {south} less than {north}: xmin,ymin,xmax,ymax"))
        }
        _ => Err("it must be four numbers: xmin,ymin,xmax,ymax".into()),
    }
}

impl PartArgs {
    /// The file that is read.
    pub fn file(&self) -> Option<&Path> {
        self.clip.as_ref().map(|source| source.path.as_path())
    }

    /// The first flag that is given.
    pub fn given(&self) -> Option<&'static str> {
        first_given([(self.extent.is_some(), "--extent"), (self.clip.is_some(), "--clip")])
    }

    /// Limits an input to the part; reads its file if there is one.
    pub fn add_to(&self, input: &mut Input) -> Result<(), Failure> {
        if let Some(Extent(extent)) = self.extent {
            input.set_extent(extent, self.extent_crs.as_ref())?;
        }
        if let Some(source) = &self.clip {
            input.read_part(source)?;
        }
        Ok(())
    }

    /// The part in the coordinates of a height map, if one is asked for; reads its file if there is one.
    pub fn on(&self, dem: &Dem) -> Result<Option<MultiPolygon<f64>>, Failure> {
        Ok(match (self.extent, &self.clip) {
            (Some(Extent(extent)), _) => Some(extent_on(dem, extent, self.extent_crs.as_ref())?),
            (None, Some(source)) => Some(read_area_on(dem, source, memory::available())?),
            (None, None) => None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_extent_is_four_numbers_in_order() {
        assert_eq!(extent("-10,20,30,40.5"), Ok(Extent([-10.0, 20.0, 30.0, 40.5])));
        assert_eq!(extent("1 2 3 4"), Ok(Extent([1.0, 2.0, 3.0, 4.0])));
        for wrong in ["", "1,2,3", "1,2,3,x", "30,20,10,40", "1,2,3,nan"] {
            assert!(extent(wrong).is_err(), "{wrong}");
        }
    }
}
