//! The flow of water over a height map: what `derive` makes of it.

use glam::DVec2;
use pyo3::prelude::*;
use tokosen::base::error::{Error, Finding};
use tokosen::crs::Reprojection;
use tokosen::dem::derive::{
    Accumulated, FloodFrom, FlowDirections, StreamFlood, catchment_parts, catchments, check_depths,
    flood_along_streams, flood_to_level, flow_accumulation, flow_directions, flow_lines,
};
use tokosen::io::layer::{Layer as OutLayer, of_catchments, of_flood, of_flow_lines, of_outlets};
use tokosen::io::raster::Quantity;
use tokosen::raster::{Dem, GroundScale};
use tokosen::terrain::{Outlets, Place, flood_source};

use crate::derived::Derived;
use crate::error::Warned;
use crate::error::parameter;
use crate::input::failed;
use crate::layer::Layer;
use crate::raster::Raster;
use crate::terrain::warned;
use crate::unit::one_of;
use crate::work::work;

/// The products, for the message about an unknown one.
pub const PRODUCTS: &str = "flow_direction, flow_accumulation, catchments, stream_lines, flood or flood_areas";

/// The arguments about water.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Water {
    accumulation_unit: String,
    outlet: Vec<[f64; 2]>,
    outlet_snap: Option<f64>,
    threshold: Option<f64>,
    flood_level: Option<f64>,
    flood_rise: Option<f64>,
    flood_from: Vec<[f64; 2]>,
    flood_bands: Vec<f64>,
}

/// What is made.
#[derive(Clone, Copy, PartialEq)]
enum Product {
    Directions,
    Accumulation,
    Catchments,
    Lines,
    Depths,
    FloodAreas,
}

/// A result, before it becomes an object of Python.
enum Made {
    Raster(Dem, Quantity),
    Layer(Layer),
}

/// Derives what has to do with water. The second value is what to warn of.
pub fn derive(
    py: Python<'_>,
    dem: &Dem,
    what: &str,
    water: &Water,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(Derived, Vec<Warned>)> {
    let product = match what {
        "flow_direction" => Product::Directions,
        "flow_accumulation" => Product::Accumulation,
        "catchments" => Product::Catchments,
        "stream_lines" => Product::Lines,
        "flood" => Product::Depths,
        "flood_areas" => Product::FloodAreas,
        other => return Err(one_of(py, "what", other, &format!("slope, aspect, hillshade, steep, {PRODUCTS}"))),
    };
    let is_cells = match water.accumulation_unit.as_str() {
        "cells" => true,
        "m2" => false,
        other => return Err(one_of(py, "accumulation_unit", other, "cells or m2")),
    };
    failed(py, check_depths(&water.flood_bands))?;
    let is_flood = matches!(product, Product::Depths | Product::FloodAreas);
    if is_flood && water.flood_level.is_none() == water.flood_rise.is_none() {
        let message = "a flood needs flood_level: a level, or \"+H\" for a height above the streams";
        return Err(parameter(py, message.to_owned()));
    }
    if (product == Product::Lines || (is_flood && water.flood_rise.is_some())) && water.threshold.is_none() {
        let message = "streams need threshold: the upstream area from which on there is one";
        return Err(parameter(py, message.to_owned()));
    }
    let (made, findings) = work(py, progress, |progress| {
        progress.start("deriving", 0);
        let mut findings = Vec::new();
        let made = make(dem, product, is_cells.then_some(Accumulated::Cells), water, &mut findings)?;
        Ok((made, findings))
    })?;
    let derived = match made {
        Made::Raster(dem, quantity) => Derived::Raster(Raster::new(py, dem, None, quantity, &[])?),
        Made::Layer(layer) => Derived::Layer(layer),
    };
    let back = Reprojection::unmoved(dem.crs.clone()).from_working(None);
    Ok((derived, warned(&findings, &crate::input::failed(py, back)?)))
}

fn make(
    dem: &Dem,
    product: Product,
    cells: Option<Accumulated<'_>>,
    water: &Water,
    findings: &mut Vec<Finding>,
) -> tokosen::Result<Made> {
    let scale = GroundScale::of(dem);
    let memory = tokosen::cli::available_memory();
    let directions = || flow_directions(dem, &scale, memory);
    let areas = |directions: &FlowDirections| flow_accumulation(directions, Accumulated::SquareMetres(&scale));
    let layer = |layer: &OutLayer<'_>| Layer::new(layer, dem.crs.as_ref()).map(Made::Layer);
    let places = |given: &[[f64; 2]]| -> Vec<Place> {
        given.iter().map(|place| Place::at(DVec2::from_array(*place), dem.crs.as_ref())).collect()
    };
    match product {
        Product::Directions => Ok(Made::Raster(directions()?.raster(), Quantity::FlowDirection)),
        Product::Accumulation => {
            let quantity = if cells.is_some() { Quantity::FlowAccumulation } else { Quantity::UpstreamArea };
            let accumulated = cells.unwrap_or(Accumulated::SquareMetres(&scale));
            Ok(Made::Raster(flow_accumulation(&directions()?, accumulated), quantity))
        }
        Product::Catchments if water.outlet.is_empty() => {
            layer(&of_catchments(&catchment_parts(&catchments(&directions()?), &scale)))
        }
        Product::Catchments => {
            let directions = directions()?;
            let found = Outlets::find(&places(&water.outlet), &areas(&directions), &scale, water.outlet_snap)?;
            let outlets = found.collect(findings);
            let above = outlets.catchments(&directions).collect(findings);
            layer(&of_outlets(&catchment_parts(&above, &scale), &outlets.outlets))
        }
        Product::Lines => {
            let directions = directions()?;
            let threshold = water.threshold.unwrap_or(f64::NAN);
            layer(&of_flow_lines(&flow_lines(dem, &directions, &areas(&directions), &scale, threshold)?))
        }
        Product::Depths | Product::FloodAreas => {
            let flood = match (water.flood_level, water.flood_rise) {
                (Some(level), _) if !level.is_finite() => {
                    return Err(Error::Parameter(format!("flood_level is {level}, which is no elevation")));
                }
                (Some(level), _) => {
                    let from: FloodFrom = flood_source(&places(&water.flood_from), dem, level)?.collect(findings);
                    flood_to_level(dem, &scale, level, &from, memory)?
                }
                (None, rise) => {
                    let directions = directions()?;
                    let (threshold, rise) = (water.threshold.unwrap_or(f64::NAN), rise.unwrap_or(f64::NAN));
                    let params = StreamFlood { threshold, rise, memory };
                    flood_along_streams(dem, &directions, &areas(&directions), &scale, params)?
                }
            };
            match product {
                Product::FloodAreas => layer(&of_flood(&flood.parts(&scale, &water.flood_bands))),
                _ => Ok(Made::Raster(flood.depths, Quantity::Depth)),
            }
        }
    }
}
