//! Pits of the working grid and of height maps: those of [`Drain::All`] are drained, those that are left are listed.

use glam::DVec2;

use super::built::Surface;
use super::conditions::{is_hollow, on_contours};
use super::places::{InOther, triangle_at};
use crate::base::error::{Finding, FindingKind};
use crate::base::{Grid, parallel};
use crate::drain::{
    Bands, CellPit, Drain, Found, Ground, Kinds, Pit, Placed, Sink, SinkShape, cell_pits, drain, drainable, mark_sinks,
    ponds,
};
use crate::raster::{Dem, GroundScale, locate};
use crate::spline::WorkingGrid;
use crate::subdomains::Regions;
use crate::tin::NONE;

/// What the working grid is drained with.
pub(crate) struct Wanted<'a> {
    pub drain: Drain,
    pub sinks: Vec<Sink>,
    /// Lowest and highest height of each node, metres.
    pub bounds: &'a [Vec<f32>; 2],
    pub regions: &'a Regions,
    /// The triangle of each node.
    pub triangles: &'a [u32],
    /// Contour interval, metres.
    pub interval: f64,
}

/// Drains the working grid within its bands, if all pits are to be drained. Returns the sinks, with points moved to the
/// deepest place of their pits, and findings about sinks without a pit and about hollows.
pub(crate) fn drain_working(working: &mut WorkingGrid, wanted: Wanted<'_>) -> (Vec<Sink>, Vec<Finding>) {
    let Wanted { drain: how, mut sinks, bounds: [lo, hi], regions, triangles, interval } = wanted;
    let Grid { cols, rows, cell, .. } = working.grid;
    let mut findings = Vec::new();
    let mut stays = vec![false; working.heights.len()];
    let placed = Placed { grid: &working.grid, to_map: &Some, from_map: &Some };
    let found = mark_sinks(&working.heights, &placed, &sinks, &mut stays);
    for (sink, found) in sinks.iter_mut().zip(found) {
        match found {
            Found::Pit(bottom) => {
                if let SinkShape::Point(p) = &mut sink.shape {
                    *p = bottom;
                }
            }
            Found::NoPit => findings.push(about_sink(sink, FindingKind::SinkWithoutPit, "holds no pit of the surface")),
            Found::Outside => findings.push(about_sink(sink, FindingKind::SinkOutside, "lies outside the frame")),
        }
    }
    if how == Drain::All {
        for (stays, &t) in stays.iter_mut().zip(triangles) {
            *stays |= is_water(regions, t);
        }
        let ground = Ground { cols, rows, lo, hi, stays: &stays };
        let levels = drainable(&working.heights, &ground);
        for hollow in ponds(&working.heights, &levels, &ground) {
            let bottom = hollow.bottom(&working.heights);
            let (depth, area) = (hollow.level - working.heights[bottom], hollow.cells.len() as f64 * cell.x * cell.y);
            let message = format!(
                "a hollow inside contours, {depth:.2} m below the level at which it can drain and {area:.0} square map units \
                 large, is drained all the same"
            );
            let place = working.grid.center(bottom % cols, bottom / cols);
            findings
                .push(Finding::at(FindingKind::HollowDrained, place, message).of_elevations([f64::from(hollow.level)]));
        }
        drain(&mut working.heights, &ground, interval as f32, Bands::Kept);
    }
    (sinks, findings)
}

fn about_sink(sink: &Sink, kind: FindingKind, what: &str) -> Finding {
    let place = sink.place();
    Finding::new(kind, place, format!("the sink of feature {} {what}", sink.feature)).of_feature(sink.feature)
}

fn is_water(regions: &Regions, t: u32) -> bool {
    t != NONE && regions.region(t).is_some_and(|region| region.water.is_some())
}

/// What is known about the ground at the cells of a height map.
struct Cells {
    triangles: Vec<u32>,
    bounds: [Vec<f32>; 2],
    given: Vec<bool>,
    /// In water or in a given sink.
    stays: Vec<bool>,
}

impl Cells {
    fn new(surface: &Surface, dem: &Dem, other: Option<InOther<'_>>) -> Self {
        let grid = &dem.grid;
        let triangles = match other {
            None => locate(&surface.tin, grid, &()),
            Some(other) => triangles_in(surface, grid, other.to_surface),
        };
        let regions = &surface.regions;
        let bound = |of: fn([f64; 2]) -> f64| -> Vec<f32> {
            let value = |&t: &u32| match t {
                NONE => f32::NAN,
                t => regions.region(t).map_or(f32::NAN, |r| of([r.band.lo, r.band.hi]) as f32),
            };
            parallel::values_each(&triangles, value)
        };
        let mut bounds = [bound(|[lo, _]| lo), bound(|[_, hi]| hi)];
        if other.is_none() {
            for (cell, level) in on_contours(&surface.map, grid) {
                bounds.iter_mut().for_each(|bound| bound[cell] = level as f32);
            }
        }
        let placed = Placed {
            grid,
            to_map: other.map_or(&Some, |other| other.to_surface),
            from_map: other.map_or(&Some, |other| other.from_surface),
        };
        let mut given = vec![false; grid.len()];
        mark_sinks(&dem.values, &placed, &surface.sinks, &mut given);
        let stays = given.iter().zip(&triangles).map(|(&given, &t)| given || is_water(regions, t)).collect();
        Self { triangles, bounds, given, stays }
    }

    fn ground(&self, grid: &Grid) -> Ground<'_> {
        let [lo, hi] = &self.bounds;
        Ground { cols: grid.cols, rows: grid.rows, lo, hi, stays: &self.stays }
    }
}

/// The triangle at each cell centre of a grid in other coordinates.
fn triangles_in(surface: &Surface, grid: &Grid, to_surface: &(dyn Fn(DVec2) -> Option<DVec2> + Sync)) -> Vec<u32> {
    let mut triangles = vec![NONE; grid.len()];
    if grid.is_empty() || surface.tin.is_empty() {
        return triangles;
    }
    parallel::chunks(&mut triangles, grid.cols, |row, cells| {
        let mut near = 0;
        for (col, triangle) in cells.iter_mut().enumerate() {
            if let Some(p) = to_surface(grid.center(col, row)) {
                *triangle = triangle_at(surface, &mut near, p).unwrap_or(NONE);
            }
        }
    });
    triangles
}

/// Drains the pits of a height map of a surface, if all are to be drained: within the bands of the sub-domains as far as
/// this is possible.
pub(super) fn drain_heights(surface: &Surface, dem: &mut Dem, other: Option<InOther<'_>>) {
    if surface.drain != Drain::All {
        return;
    }
    let cells = Cells::new(surface, dem, other);
    drain(&mut dem.values, &cells.ground(&dem.grid), surface.interval.step as f32, Bands::Left);
}

/// The pits of a height map of a surface, on the map of the surface.
pub fn pits_of(surface: &Surface, dem: &Dem, other: Option<InOther<'_>>) -> Vec<Pit> {
    let cells = Cells::new(surface, dem, other);
    let is_hollow = is_hollow(&surface.regions);
    let hollow = |cell: usize| match cells.triangles[cell] {
        NONE => false,
        t => is_hollow.get(surface.regions.of_triangle[t as usize] as usize).is_some_and(|hollow| *hollow),
    };
    let Grid { cols, cell: size, .. } = dem.grid;
    let scale = GroundScale::of(dem);
    let pit = |found: CellPit| {
        let (col, row) = (found.cell % cols, found.cell / cols);
        let centre = dem.grid.center(col, row);
        let place = other.map_or(Some(centre), |other| (other.to_surface)(centre))?;
        let area = found.cells as f64 * (size * scale.row(row)).element_product();
        let [bottom, spill] = [found.bottom, found.spill].map(f64::from);
        Some(Pit { place, bottom, spill, area, reason: found.reason })
    };
    let kinds = Kinds { given: &cells.given, hollow: &hollow };
    cell_pits(&dem.values, &cells.ground(&dem.grid), &kinds).into_iter().filter_map(pit).collect()
}

/// The pits of the smooth surface, at the nodes of its working grids. `None` for other surfaces.
pub fn working_pits(surface: &Surface) -> Option<Vec<Pit>> {
    let pits = |WorkingGrid { grid, heights }: &WorkingGrid| {
        let dem = Dem { grid: *grid, values: heights.clone(), crs: surface.map.crs.clone() };
        pits_of(surface, &dem, None)
    };
    Some(surface.working.as_ref()?.0.iter().flat_map(pits).collect())
}
