//! The cells of a grid that lie in given sinks and in other areas of the map.

use std::collections::BTreeSet;

use geo::MultiPolygon;
use glam::DVec2;

use super::flood::neighbours;
use super::ground::Ground;
use super::levels::flooded;
use super::params::{Sink, SinkShape};
use crate::base::{Grid, parallel};
use crate::geometry::Border;

/// A point counts for the nearest pit within this many cells.
const REACH: isize = 5;

/// What became of a sink on a grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Found {
    /// It holds a pit. For a point: the place of its deepest cell.
    Pit(DVec2),
    /// There is no pit.
    NoPit,
    /// It lies outside.
    Outside,
}

/// A grid, and how its positions and those of shapes on the map, such as sinks, are converted to each other.
pub(crate) struct Placed<'a> {
    pub grid: &'a Grid,
    /// From the grid to the map.
    pub to_map: &'a (dyn Fn(DVec2) -> Option<DVec2> + Sync),
    /// From the map to the grid.
    pub from_map: &'a (dyn Fn(DVec2) -> Option<DVec2> + Sync),
}

impl Placed<'_> {
    /// The cell at a position on the map, if there is one.
    fn cell(&self, p: DVec2) -> Option<usize> {
        let place = self.grid.place((self.from_map)(p)?).round();
        let size = DVec2::new(self.grid.cols as f64, self.grid.rows as f64);
        let is_on = place.cmpge(DVec2::ZERO).all() && place.cmplt(size).all();
        is_on.then(|| place.y as usize * self.grid.cols + place.x as usize)
    }
}

/// Marks the cells of sinks in `given`: of an area all inside, of a point the deepest cell of the pit that holds it, or of
/// the nearest one. Returns what became of each sink.
pub(crate) fn mark_sinks(heights: &[f32], placed: &Placed<'_>, sinks: &[Sink], given: &mut [bool]) -> Vec<Found> {
    if sinks.is_empty() {
        return Vec::new();
    }
    let Grid { cols, rows, .. } = *placed.grid;
    let nowhere = vec![false; heights.len()];
    let ground = Ground { cols, rows, lo: &[], hi: &[], stays: &nowhere };
    let levels = flooded(heights, &ground, |cell| ground.is_outlet(heights, cell));
    let is_in_pit = |cell: usize| levels[cell] > heights[cell];
    let point = |cell: Option<usize>| {
        let Some(cell) = cell.filter(|&cell| heights[cell].is_finite()) else { return (Found::Outside, None) };
        match nearest(cell, [cols, rows], is_in_pit) {
            Some(start) => {
                let bottom = bottom_below(heights, start, [cols, rows]);
                let place = placed.grid.center(bottom % cols, bottom / cols);
                (Found::Pit((placed.to_map)(place).unwrap_or(place)), Some(bottom))
            }
            None => (Found::NoPit, None),
        }
    };
    let mut found = Vec::with_capacity(sinks.len());
    for sink in sinks {
        match &sink.shape {
            SinkShape::Point(p) => {
                let (what, bottom) = point(placed.cell(*p));
                bottom.iter().for_each(|&cell| given[cell] = true);
                found.push(what);
            }
            SinkShape::Area(area) => {
                let cells = cells_in(placed, area);
                let inside: Vec<usize> = cells.into_iter().filter(|&cell| heights[cell].is_finite()).collect();
                if inside.is_empty() {
                    // An area smaller than a cell counts as a point.
                    let (what, bottom) = point(sink.place().and_then(|p| placed.cell(p)));
                    bottom.iter().for_each(|&cell| given[cell] = true);
                    found.push(what);
                    continue;
                }
                let has_pit = inside.iter().any(|&cell| is_in_pit(cell));
                inside.into_iter().for_each(|cell| given[cell] = true);
                found.push(match sink.place().filter(|_| has_pit) {
                    Some(middle) => Found::Pit(middle),
                    None => Found::NoPit,
                });
            }
        }
    }
    found
}

/// The nearest cell of a kind, of those within [`REACH`] columns and rows.
fn nearest(cell: usize, [cols, rows]: [usize; 2], is_wanted: impl Fn(usize) -> bool) -> Option<usize> {
    let (col, row) = (cell % cols, cell / cols);
    let steps = (-REACH..=REACH).flat_map(|j| (-REACH..=REACH).map(move |i| (i, j)));
    let near = steps.filter_map(|(i, j)| {
        let col = col.checked_add_signed(i).filter(|col| *col < cols)?;
        let row = row.checked_add_signed(j).filter(|row| *row < rows)?;
        Some((i * i + j * j, row * cols + col))
    });
    near.filter(|&(_, cell)| is_wanted(cell)).min().map(|(_, cell)| cell)
}

/// The end of the steepest way down from a cell. Level ground is crossed.
fn bottom_below(heights: &[f32], start: usize, [cols, rows]: [usize; 2]) -> usize {
    let around = |cell: usize| neighbours(cell, cols, rows).flatten().map(|(_, near)| near);
    let (mut cell, mut level) = (start, BTreeSet::from([start]));
    let mut stack = vec![start];
    // The next cell of this level, or the lowest one around it, which begins a new level.
    while let Some(next) = stack.pop() {
        let height = heights[next];
        let lowest =
            around(next).filter(|&near| heights[near] < height).min_by(|&a, &b| heights[a].total_cmp(&heights[b]));
        if let Some(lower) = lowest {
            cell = lower;
            (level, stack) = (BTreeSet::from([lower]), vec![lower]);
        } else {
            stack.extend(around(next).filter(|&near| heights[near] == height && level.insert(near)));
        }
    }
    cell
}

/// The cells whose centres lie inside an area.
pub(crate) fn cells_in(placed: &Placed<'_>, area: &MultiPolygon<f64>) -> Vec<usize> {
    let grid = placed.grid;
    let places = area.iter().flat_map(|polygon| polygon.exterior().coords()).map(|c| DVec2::new(c.x, c.y));
    let (mut lo, mut hi) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for place in places.filter_map(|p| (placed.from_map)(p)).map(|p| grid.place(p)) {
        (lo, hi) = (lo.min(place), hi.max(place));
    }
    // Edges may bend between their ends in other coordinates.
    let margin = 1.0 + 0.1 * (hi - lo);
    let last = DVec2::new(grid.cols as f64 - 1.0, grid.rows as f64 - 1.0);
    let (lo, hi) = ((lo - margin).floor().max(DVec2::ZERO), (hi + margin).ceil().min(last));
    if !(lo.is_finite() && hi.is_finite() && lo.cmple(hi).all()) {
        return Vec::new();
    }
    let border = Border::new(area);
    let is_in = |col: usize, row: usize| (placed.to_map)(grid.center(col, row)).is_some_and(|p| border.contains(p));
    let (first, rows) = (lo.y as usize, (hi.y - lo.y) as usize + 1);
    parallel::flat_map(rows, |row| {
        let cols = lo.x as usize..=hi.x as usize;
        cols.filter(move |&col| is_in(col, first + row)).map(move |col| (first + row) * grid.cols + col)
    })
}
