//! What the surface of a part takes from the whole map, so that it is the whole map's surface there.

use glam::DVec2;

use super::groups::{Groups, node_grid};
use super::params::{SurfaceKind, SurfaceParams};
use super::trial_builder::TrialBuilder;
use crate::base::Grid;
use crate::base::error::Result;
use crate::contour::{ContourMap, Interval};
use crate::spline::{part_of_grid, whole_grid};
use crate::subdivision::{Prepared, prepare};
use crate::subdomains::MapExtent;
use crate::validate::{Chosen, TrialParams, choose};

/// Figures of a whole map that the surface of each of its parts needs.
#[derive(Debug, Clone, PartialEq)]
pub struct Whole {
    /// The vertical interval.
    pub interval: Interval,
    /// Mean spacing of the contours, map units.
    pub spacing: f64,
    /// The working grid of the smooth surface.
    pub grid: Grid,
    /// The hyper-parameters of the smooth surface; `None` for the other kinds.
    pub chosen: Option<Chosen>,
}

impl Whole {
    /// Takes the figures from a clean map. Nothing is triangulated but what the choice of hyper-parameters tries. `None` if the
    /// map falls into groups of ground far from each other: each has figures of its own then.
    ///
    /// # Errors
    /// As [`build`](super::build).
    pub fn of(map: &ContourMap, params: &SurfaceParams) -> Result<Option<Self>> {
        params.check()?;
        let Prepared { map, frame, interval, .. } = prepare(map.clone(), &params.frame, &params.water)?;
        let extent = MapExtent::new(&map, &frame, interval);
        if Groups::new(&extent, params).largest().is_some() {
            return Ok(None);
        }
        let tuning = &params.tuning;
        let builder = TrialBuilder { resolution: Some(params.resolution), tuning: &tuning.skeleton };
        let wanted = params.spline.wanted;
        let trials = TrialParams { frame: &params.frame, wanted, builder: &builder, tuning, needless: None };
        let chosen = (params.kind == SurfaceKind::Spline).then(|| choose(&extent, &params.spline, &trials));
        let grid = node_grid(whole_grid(&extent, wanted, &tuning.spline.grid), params);
        Ok(Some(Self { interval, spacing: extent.spacing, grid, chosen }))
    }

    /// The working grid of the part in a box.
    pub(super) fn grid_of(&self, [lo, hi]: [DVec2; 2]) -> Grid {
        part_of_grid(&self.grid, lo, hi)
    }
}
