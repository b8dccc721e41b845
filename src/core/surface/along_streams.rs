//! Height maps along streams: cells come near to the heights of the streams, and river areas are level.

use std::cell::{Cell, RefCell};

use foldhash::HashMap;
use geo::MultiPolygon;
use glam::DVec2;

use super::built::Surface;
use super::conditions::on_contours;
use super::places::{InOther, triangle_at};
use crate::base::Grid;
use crate::drain::{Placed, cells_in};
use crate::raster::Dem;
use crate::streams::{AreaLevels, RiverArea, Stream, Ways};
use crate::tin::NONE;

/// Where the cells of a height map have their centres.
#[derive(Debug, Clone, Copy)]
pub(super) enum Centres<'a> {
    /// On nodes of the working grid.
    OnNodes,
    /// Between nodes. For each cell, the triangle that its centre lies in.
    BetweenNodes(&'a [u32]),
}

/// Brings a height map into agreement with the streams and river areas. Cells on vertices of contours keep their heights.
pub(super) fn flow_along(surface: &Surface, grid: &Grid, values: &mut [f32], centres: Centres<'_>) {
    if surface.streams.is_empty() {
        return;
    }
    let mut fixed: Vec<usize> = on_contours(&surface.map, grid).map(|(cell, _)| cell).collect();
    fixed.sort_unstable();
    let look_up = regions_at(surface, grid, &Some);
    let region = |cell: usize| match centres {
        Centres::OnNodes => look_up(cell),
        Centres::BetweenNodes(triangles) => region_of(surface, triangles[cell]),
    };
    let placed = Placed { grid, to_map: &Some, from_map: &Some };
    settle(surface, &surface.streams, &placed, values, |cell, wanted| {
        let is_fixed = fixed.binary_search(&cell).is_ok();
        (!is_fixed).then(|| within(surface, region(cell), wanted))
    });
}

/// Brings a height map in other coordinates into agreement with the streams and river areas.
pub(super) fn follow_streams(surface: &Surface, dem: &mut Dem, other: InOther<'_>) {
    let Dem { grid, values, .. } = dem;
    if surface.streams.is_empty() || grid.is_empty() {
        return;
    }
    let in_other = |stream: &Stream| {
        let points = stream.points.iter().filter_map(|p| Some((other.from_surface)(p.truncate())?.extend(p.z)));
        Stream { points: points.collect(), ..stream.clone() }
    };
    let streams: Vec<Stream> = surface.streams.iter().map(in_other).collect();
    let placed = Placed { grid, to_map: other.to_surface, from_map: other.from_surface };
    let region = regions_at(surface, grid, other.to_surface);
    settle(surface, &streams, &placed, values, |cell, wanted| Some(within(surface, region(cell), wanted)));
}

/// The largest difference between the smooth surface, within the bands of the contours, and the streams that fall on it,
/// metres. 0 without streams.
pub fn largest_stream_change(surface: &Surface) -> f64 {
    let Some(working) = &surface.working else { return 0.0 };
    let height = |p: DVec2| f64::from(working.at(p));
    let change = |stream: &Stream| stream.change_from(height);
    surface.streams.iter().map(change).fold(0.0, f64::max)
}

/// Brings cells near to the heights of the streams through them, and levels river areas. All this depends on the size of
/// the cells. So the surface itself stays as it is.
fn settle(
    surface: &Surface,
    streams: &[Stream],
    placed: &Placed<'_>,
    values: &mut [f32],
    allowed: impl Fn(usize, f32) -> Option<f32>,
) {
    let ways = Ways::new(streams, placed.grid);
    ways.follow(values, [surface.stream_tolerance, surface.interval.step], &allowed);
    let cells = |area: &RiverArea| cells_in(placed, &MultiPolygon::from(area.polygon.clone()));
    let areas: Vec<Vec<usize>> = surface.river_areas.iter().map(cells).collect();
    AreaLevels::new(&areas, streams, &ways, values).level(values, allowed);
}

/// The height in the band of a sub-domain that is nearest to a wanted one.
fn within(surface: &Surface, region: Option<usize>, wanted: f32) -> f32 {
    let band = region.map(|r| surface.regions.regions[r].band);
    band.map_or(wanted, |band| wanted.min(band.hi as f32).max(band.lo as f32))
}

/// The sub-domain at each cell of a grid, if there is ground. `to_surface` converts positions on the grid.
fn regions_at<'a>(
    surface: &'a Surface,
    grid: &'a Grid,
    to_surface: &'a dyn Fn(DVec2) -> Option<DVec2>,
) -> impl Fn(usize) -> Option<usize> + 'a {
    // Cells are asked for in the order of streams. So the triangle of one is mostly near that of the one before. From one
    // stream to the next it may be far, so that a sub-domain is looked up only once.
    let near = Cell::new(0);
    let known: RefCell<HashMap<usize, Option<usize>>> = RefCell::default();
    let look_up = move |cell: usize| {
        let mut from = near.get();
        let place = to_surface(grid.center(cell % grid.cols, cell / grid.cols));
        let triangle = place.and_then(|p| triangle_at(surface, &mut from, p));
        near.set(from);
        triangle.and_then(|t| region_of(surface, t))
    };
    move |cell| *known.borrow_mut().entry(cell).or_insert_with(|| look_up(cell))
}

/// The sub-domain of a triangle; none outside the frame.
fn region_of(surface: &Surface, triangle: u32) -> Option<usize> {
    let region = *surface.regions.of_triangle.get(triangle as usize)?;
    (region != NONE).then_some(region as usize)
}
