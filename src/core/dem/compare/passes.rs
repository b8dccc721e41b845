//! The three passes of a comparison over the rows of both height maps.

use super::CompareParams;
use super::SIGNIFICANT;
use super::classes::{distance_bounds, elevation_bounds};
use super::group::Group;
use super::heights::Scan;
use super::levels::LevelCounts;
use super::rows::{Cells, Row, fill};
use super::slopes::SlopeSums;
use super::tally::{Collector, Tally};
use crate::base::error::Result;
use crate::base::{Grid, parallel};
use crate::raster::{Block, RasterRows, each_pair};

/// What the first pass finds: ranges, from which the classes follow.
#[derive(Debug)]
pub(super) struct Ranges {
    /// The heights of A and of B.
    pub sides: [Scan; 2],
    /// The bounds of the classes of elevation and of distance.
    elevations: Vec<f64>,
    distances: Vec<f64>,
}

/// What the second pass counts and sums up.
#[derive(Debug)]
pub(super) struct Counted {
    /// All cells; the classes by slope, by elevation and by distance.
    pub groups: [Group<Tally>; 4],
    pub slopes: SlopeSums,
    /// Number of differences beyond the accuracy that is stated.
    pub beyond: usize,
    /// The heights of A and of B.
    pub levels: [LevelCounts; 2],
}

/// The first pass. `None` if no cell has a height in both.
pub(super) fn find_ranges(sides: [&dyn RasterRows; 2], params: &CompareParams<'_>) -> Result<Option<Ranges>> {
    let [mut of_a, mut of_b] = [Scan::new(); 2];
    let (mut lowest, mut highest) = (f32::INFINITY, f32::NEG_INFINITY);
    let mut known = Vec::new();
    each_pair(sides, |a, b| {
        let compared = || a.heights().iter().zip(b.heights()).map(|(a, b)| a.is_finite() && b.is_finite());
        let range = || {
            for (height, _) in b.heights().iter().zip(compared()).filter(|(_, is_compared)| *is_compared) {
                (lowest, highest) = (lowest.min(*height), highest.max(*height));
            }
        };
        rayon::join(|| of_a.add(a.heights()), || rayon::join(|| of_b.add(b.heights()), range));
        let distances = distances_from(params, b.rows.start * sides[1].grid().cols);
        known.extend(distances.iter().zip(compared()).filter(|(_, is_compared)| *is_compared).map(|(d, _)| *d));
    })?;
    let elevations = elevation_bounds(lowest.into(), highest.into());
    let distances = distance_bounds(known.into_iter());
    Ok((lowest <= highest).then_some(Ranges { sides: [of_a, of_b], elevations, distances }))
}

/// The second pass.
pub(super) fn count(sides: [&dyn RasterRows; 2], params: &CompareParams<'_>, ranges: &Ranges) -> Result<Counted> {
    let Grid { cell, cols, .. } = sides[1].grid();
    let cell = cell * params.metres_per_unit;
    let limit = params.sigma.map_or(f64::INFINITY, |sigma| SIGNIFICANT * sigma);
    let Ranges { elevations, distances, .. } = ranges;
    let mut groups = [Group::all(), Group::by_slope(), Group::by_elevation(elevations), Group::by_distance(distances)];
    let mut levels = [0, 1].map(|side: usize| ranges.sides[side].levels(params.interval.as_ref()));
    let (mut slopes, mut beyond) = (SlopeSums::default(), 0);
    let mut rows = Vec::new();
    each_pair(sides, |a, b| {
        fill(b, &mut rows, |row, out| {
            out.subtract(a.row(row), b.row(row));
            out.compare_slopes(a.around(row), b.around(row), cell);
        });
        // Each task goes through the rows in order. So sums do not depend on the threads.
        rayon::scope(|scope| {
            for (levels, heights) in levels.iter_mut().zip([a.heights(), b.heights()]) {
                scope.spawn(move |_| levels.add(heights));
            }
            for group in &mut groups {
                let cells = cells(b, &rows, cols, params);
                scope.spawn(move |_| cells.for_each(|cells| group.add(&cells)));
            }
            for row in &rows {
                slopes.add(&row.slopes);
                beyond += row.differences.iter().filter(|d| d.abs() > limit).count();
            }
        });
    })?;
    Ok(Counted { groups, slopes, beyond, levels })
}

/// The third pass: collects what the quantiles lie between, and sums up the squares of the distances from the means.
pub(super) fn collect(
    sides: [&dyn RasterRows; 2],
    params: &CompareParams<'_>,
    groups: [Group<Tally>; 4],
) -> Result<[Group<Option<Collector>>; 4]> {
    let Grid { cell, cols, .. } = sides[1].grid();
    let cell = cell * params.metres_per_unit;
    let mut groups = groups.map(Group::collectors);
    let mut rows = Vec::new();
    each_pair(sides, |a, b| {
        fill(b, &mut rows, |row, out| {
            out.subtract(a.row(row), b.row(row));
            out.incline(b.around(row), cell);
        });
        parallel::update(&mut groups, |_, group| cells(b, &rows, cols, params).for_each(|cells| group.add(&cells)));
    })?;
    Ok(groups)
}

/// The cells of each row of a block of B.
fn cells<'a>(
    b: &'a Block,
    rows: &'a [Row],
    cols: usize,
    params: &CompareParams<'a>,
) -> impl Iterator<Item = Cells<'a>> + use<'a> {
    let distances = distances_from(params, b.rows.start * cols);
    b.rows.clone().zip(rows).map(move |(number, row)| {
        let before = (number - b.rows.start) * cols;
        let distances = distances.get(before..).unwrap_or_default();
        Cells { first: number * cols, row, heights: b.row(number), distances }
    })
}

/// The distances of the cells from one of them on. None if there are no contours.
fn distances_from<'a>(params: &CompareParams<'a>, cell: usize) -> &'a [f64] {
    params.distances.and_then(|distances| distances.get(cell..)).unwrap_or_default()
}
