//! Heights and their standard errors at single places.

use std::path::Path;

use glam::DVec2;

use super::compare::{Kind, Side};
use super::facade::Terrain;
use tokosen_core::base::Grid;
use tokosen_core::base::error::Result;
use tokosen_core::crs::{Crs, converted};
use tokosen_core::dem::compare::heights_at_places;
use tokosen_core::raster::Dem;
use tokosen_core::surface::{Surface, heights_on, standard_errors_on};

/// A height, and how sure it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// The height, metres; NaN where there is none.
    pub height: f64,
    /// Its standard error, metres; NaN if it is not known.
    pub error: f64,
}

impl Terrain {
    /// Heights and standard errors at places on the working plane. Errors are known if the options asked for them.
    pub fn sample(&self, places: &[DVec2]) -> Vec<Sample> {
        on_surface(&self.surface, &|k| places.get(k).copied(), places.len())
    }
}

impl Side {
    /// Heights and standard errors at places in some system; that of the side's file if `crs` is `None`. Height maps are
    /// interpolated (bilinear) between the centres of cells. `path` is the file of the places, for the error.
    ///
    /// # Errors
    /// If the system cannot be converted to that of the side, or rows of a height map cannot be read.
    pub fn sample(&self, places: &[DVec2], crs: Option<&Crs>, path: &Path) -> Result<Vec<Sample>> {
        let transform = self.transform_from(crs, path)?;
        let place = |k: usize| places.get(k).and_then(|p| converted(transform.as_ref(), *p));
        Ok(match &self.kind {
            Kind::Dem(dem) => {
                let places: Vec<DVec2> = (0..places.len()).map(|k| place(k).unwrap_or(DVec2::NAN)).collect();
                let errors = match (self.sigma, &self.errors) {
                    (None, Some(errors)) => heights_at_places(&**errors, &places)?,
                    (sigma, _) => vec![sigma.unwrap_or(f64::NAN); places.len()],
                };
                let heights = heights_at_places(&**dem, &places)?;
                heights.into_iter().zip(errors).map(|(height, error)| Sample { height, error }).collect()
            }
            Kind::Surface(surface) => on_surface(surface, &place, places.len()),
        })
    }
}

/// Samples of a surface at `count` places. Each is treated as a cell of one row.
fn on_surface(surface: &Surface, place: &(impl Fn(usize) -> Option<DVec2> + Sync), count: usize) -> Vec<Sample> {
    let row = Grid { corner: DVec2::ZERO, cell: DVec2::ONE, cols: count, rows: 1 };
    let at = |p: DVec2| place(p.x as usize);
    let values = heights_on(surface, &row, &at, &());
    let dem = Dem { grid: row, values, crs: None };
    let errors = standard_errors_on(surface, &dem, &at);
    let error = |k: usize| errors.as_ref().and_then(|errors| errors.get(k)).map_or(f64::NAN, |error| f64::from(*error));
    dem.values.iter().enumerate().map(|(k, height)| Sample { height: f64::from(*height), error: error(k) }).collect()
}
