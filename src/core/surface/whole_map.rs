//! Takes the figures that the surfaces of parts need from the whole map.

use super::given::Given;
use super::groups::{Groups, node_grid};
use super::params::{SurfaceKind, SurfaceParams};
use super::trial_builder::TrialBuilder;
use super::whole::Whole;
use crate::base::error::Result;
use crate::contour::ContourMap;
use crate::spline::whole_grid;
use crate::subdivision::{Prepared, prepare};
use crate::subdomains::MapExtent;
use crate::validate::{TrialParams, choose};

/// The figures of a clean map that the surfaces of its parts need. Nothing is triangulated but what the choice of hyper-parameters tries. `None` if the
/// map falls into groups of ground far from each other: each has figures of its own then.
///
/// # Errors
/// As [`build`](super::build).
pub fn whole_map(map: &ContourMap, given: &Given, params: &SurfaceParams) -> Result<Option<Whole>> {
    params.check()?;
    let Prepared { map, frame, interval, .. } = prepare(map.clone(), &params.frame, &given.water)?;
    let extent = MapExtent::new(&map, &frame, interval);
    if Groups::new(&extent, params).largest().is_some() {
        return Ok(None);
    }
    let tuning = &params.tuning;
    let builder = TrialBuilder { resolution: Some(params.resolution), tuning: &tuning.skeleton };
    let wanted = params.spline.wanted;
    let trials = TrialParams { frame: &params.frame, wanted, builder: &builder, tuning, needless: None };
    let chosen = (params.kind == SurfaceKind::Spline).then(|| choose(&extent, &params.spline, &trials));
    let grid = node_grid(whole_grid(&extent, wanted, &tuning.spline.grid), &given.break_lines, &tuning.break_lines);
    Ok(Some(Whole { interval, spacing: extent.spacing, grid, chosen }))
}
