//! Catchments: the cells that drain to the same outlet, as labels and as polygons.

use glam::DVec2;

use super::directions::FlowDirections;
use crate::base::Grid;
use crate::base::error::{Error, Result};
use crate::crs::Crs;
use crate::dem::derive::outline::{OUTSIDE, Part, area, on_map, outlines};
use crate::drain::ways_end;
use crate::raster::{Dem, GroundScale};

/// Up to this number, an `f32` represents all whole numbers.
const GREATEST_NUMBER: usize = 1 << 24;

/// The catchment that each cell of a height map belongs to.
#[derive(Debug, Clone, PartialEq)]
pub struct Catchments {
    grid: Grid,
    crs: Option<Crs>,
    /// The catchment of each cell, from 0; [`OUTSIDE`] without data.
    labels: Vec<u32>,
    /// The outlet of each catchment: a cell.
    outlets: Vec<usize>,
}

/// A polygon of a catchment. Polygons of one catchment meet at corners of cells only.
#[derive(Debug, Clone, PartialEq)]
pub struct CatchmentPart {
    /// The number of the catchment, from 1.
    pub catchment: u32,
    /// The outer ring, then the holes, along cell edges, in map units. Each ring ends where it begins.
    pub rings: Vec<Vec<DVec2>>,
    /// Area of this polygon on the map, square metres.
    pub area: f64,
    /// The centre of the cell at the outlet of the catchment, map units.
    pub outlet: DVec2,
}

/// Finds the catchments: all cells that drain to one outlet are a catchment. Outlets are at the border of the height map
/// and beside cells without data ([`flow_directions`](super::flow_directions)). Catchments are numbered in the order of
/// their outlets, row by row from the north-west.
///
/// The time is in proportion to the number of cells.
pub fn catchments(directions: &FlowDirections) -> Catchments {
    let grid = directions.grid();
    let is_outlet = |cell: &usize| directions.has_data(*cell) && directions.downstream(*cell).is_none();
    let outlets: Vec<usize> = (0..grid.len()).filter(is_outlet).collect();
    let mut numbers = vec![OUTSIDE; grid.len()];
    for (number, &outlet) in (0..).zip(&outlets) {
        numbers[outlet] = number;
    }
    let next = |cell: usize| directions.downstream(cell).unwrap_or(cell) as u32;
    let ends = ways_end((0..grid.len()).map(next).collect());
    let labels = ends.into_iter().map(|end| numbers[end as usize]).collect();
    Catchments::new(directions, labels, outlets)
}

impl Catchments {
    /// Catchments on the grid of directions: the label of each cell, and the outlet of each label.
    pub(super) fn new(directions: &FlowDirections, labels: Vec<u32>, outlets: Vec<usize>) -> Self {
        Self { grid: *directions.grid(), crs: directions.crs().cloned(), labels, outlets }
    }

    /// The catchment of each cell, from 0; [`OUTSIDE`] if it belongs to none.
    pub(super) fn labels(&self) -> &[u32] {
        &self.labels
    }

    /// The outlet of each catchment: a cell.
    pub(super) fn outlets(&self) -> &[usize] {
        &self.outlets
    }

    /// The number of catchments.
    pub fn count(&self) -> usize {
        self.outlets.len()
    }

    /// The catchments as a raster of their numbers from 1. NaN without data and outside of all catchments.
    ///
    /// # Errors
    /// [`Error::Data`] if there are more catchments than an `f32` can number.
    pub fn raster(&self) -> Result<Dem> {
        let count = self.count();
        if count > GREATEST_NUMBER {
            let message = format!("{count} catchments are more than a raster can number; write them as polygons");
            return Err(Error::Data(message));
        }
        let number = |&label: &u32| if label == OUTSIDE { f32::NAN } else { (label + 1) as f32 };
        Ok(Dem { grid: self.grid, values: self.labels.iter().map(number).collect(), crs: self.crs.clone() })
    }
}

/// The outlines of catchments, from the north-west. `scale` gives their areas.
pub fn catchment_parts(catchments: &Catchments, scale: &GroundScale) -> Vec<CatchmentPart> {
    let grid = &catchments.grid;
    let part = |part: Part| {
        let label = catchments.labels[part.cell];
        let outlet = catchments.outlets[label as usize];
        CatchmentPart {
            catchment: label + 1,
            rings: on_map(&part.rings, grid),
            area: area(&part.rings, grid, scale),
            outlet: grid.center(outlet % grid.cols, outlet / grid.cols),
        }
    };
    outlines(grid.cols, &catchments.labels).into_iter().map(part).collect()
}
