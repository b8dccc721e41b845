//! Contour lines of a height map: [`contours`].
//!
//! The steps: heights are smoothed, if asked for ([`smoothed`]); each level is traced through
//! the squares of four cell centres; the traced lines get a smooth course with few vertices, within a tolerance. Lines
//! never cross or touch, by construction: each has its own windows on the sides of the squares.
//!
//! One rule for heights exactly at a level: they are above it. So each line depends on the heights beside it alone, and
//! height maps with common cells have the same lines there.

mod course;
mod trace;

use std::sync::{Mutex, PoisonError};

use geo::{BoundingRect, MultiPolygon};
use glam::DVec2;
use rayon::prelude::*;

use super::smooth::{HeightChange, smoothed};
use crate::base::error::{Error, Result};
use crate::base::progress::Progress;
use crate::base::rows::Rows;
use crate::base::{ElevationUnit, Grid, memory};
use crate::contour::{ContourLayer, ContourLine, Source, Target, clip_lines};
use crate::raster::Dem;
use crate::slice::{end_of_batch, signed_area};
use course::Workspace;
use trace::{Field, Freedom, NOT_VISITED, Trace};

/// Default of the tolerance, cells. Half a cell is how exactly a height map states where a height is.
pub const TOLERANCE: f64 = 0.5;
/// Smallest tolerance, cells. With none, lines through one cell centre would touch.
pub const SMALLEST_TOLERANCE: f64 = 1e-3;

/// Number of crossings of squares and levels in memory at a time. It limits memory.
const BATCH: usize = 1 << 25;
/// Bytes of memory per cell: its height, its rank, the list of squares, and the copies that smoothing takes.
const BYTES_PER_CELL: f64 = 24.0;
/// The same for each thread: the marks of squares.
const BYTES_PER_MARK: f64 = 4.0;
/// Bytes of memory per crossing of a side: for the vertices that are left, in their layer and while it is written.
const BYTES_PER_CROSSING: f64 = 24.0;
/// Levels are looked for a little beyond the lowest and the highest height. 100 feet may be just outside in metres.
const BEYOND: f64 = 1e-6;

/// Parameters of [`contours`].
#[derive(Debug, Clone, PartialEq)]
pub struct ContourParams {
    /// The levels of each layer.
    pub targets: Vec<Target>,
    /// The unit of these levels. The lines have their elevations in metres all the same.
    pub unit: ElevationUnit,
    /// One level in so many is an index contour, counted from the base; 0 for none. For a list of levels, the interval
    /// is the smallest difference between two of them.
    pub index_every: u32,
    /// Largest horizontal distance between a line and the contour of the height map, map units. If `None`,
    /// [`TOLERANCE`] times the smaller side of a cell. At least [`SMALLEST_TOLERANCE`] times this side is used;
    /// [`DemContours::tolerance`] tells.
    pub tolerance: Option<f64>,
    /// Standard deviation of the Gaussian that smooths the heights first, map units. `None` for none.
    pub smooth: Option<f64>,
    /// The part of the map that is wanted, in the coordinates of the height map. The lines are those of the whole map, cut at
    /// its border. `None` for the whole map.
    pub part: Option<MultiPolygon<f64>>,
    /// Memory that the work may take, bytes. Work that needs more is an error. No limit if `None`.
    pub memory: Option<u64>,
}

impl Default for ContourParams {
    /// No targets, levels in metres, every fifth level an index contour, half a cell, not smoothed, the whole map, no limit of
    /// memory.
    fn default() -> Self {
        let (unit, index_every) = (ElevationUnit::Metre, 5);
        Self { targets: Vec::new(), unit, index_every, tolerance: None, smooth: None, part: None, memory: None }
    }
}

/// Contour lines of a height map.
#[derive(Debug, Clone, PartialEq)]
pub struct DemContours {
    /// The lines of each target.
    pub layers: Vec<ContourLayer>,
    /// The tolerance that was used, map units.
    pub tolerance: f64,
    /// How often lines cross the sides of squares. This would be the number of vertices without the tolerance.
    pub crossings: u64,
    /// The lowest and the highest height, metres, after smoothing.
    pub heights: [f32; 2],
    /// The levels of each target from the lowest to the highest height, metres, ascending. One that is the lowest height
    /// has no line.
    pub levels: Vec<Vec<f64>>,
    /// What smoothing did to the heights, if it was asked for.
    pub smoothing: Option<HeightChange>,
}

impl DemContours {
    /// That and why the tolerance is larger than one that was asked for, as the rest of a sentence. `None` if it is not.
    pub fn raised_from(&self, asked: f64) -> Option<String> {
        (asked < self.tolerance).then(|| {
            format!(
                "{asked} is less than a thousandth of a cell: {} is used. Closer to cells exactly at a level, lines would touch",
                self.tolerance
            )
        })
    }
}

/// The contour lines of a height map at the levels of each target.
///
/// The contour of a height map is defined here by its cell centres. Four neighbouring ones are the corners of a square.
/// Heights are linear on its sides, and the contour is straight between two sides. A height equal to a level is always
/// above it: a line runs around single cells and rows of cells at the level too, close beside them. Where two corners above
/// the level lie across from each other, the mean of the four heights decides which sides are connected. These are the
/// lines that other programs trace.
///
/// The lines of the result:
/// * Each lies within the tolerance of that contour, and crosses the same sides of the same squares. So cell centres
///   stay on their side of every line.
/// * They do not cross or touch each other, nor themselves.
/// * They are closed, or end where the data end: at the outermost cell centres, and beside cells without data. The ends
///   are those of the contour, so lines of neighbouring height maps with common cells meet. Lines of a part end at its
///   border too, each with a vertex on it.
/// * Higher ground is on their right. They are ordered by elevation, and then in a fixed order.
///
/// The vertices are moved onto a smooth curve first (local regression). Then as many are left out as the tolerance
/// allows, if few vertices need it; fewer otherwise. Small rings are kept, also those around a single cell.
///
/// The work is done on the map plane, also for degrees. The time is proportional to the number of cells and crossings.
///
/// ```
/// use glam::DVec2;
/// use tokosen_core::base::Grid;
/// use tokosen_core::raster::Dem;
/// use tokosen_core::dem::contour::{ContourParams, contours};
/// use tokosen_core::contour::Target;
///
/// // A cone of 100 m with a slope of 1 : 1, on cells of 2 m.
/// let grid = Grid { corner: DVec2::ZERO, cell: DVec2::splat(2.0), cols: 101, rows: 101 };
/// let top = grid.center(50, 50);
/// let height = |i: usize| (100.0 - grid.center(i % 101, i / 101).distance(top)) as f32;
/// let dem = Dem { grid, values: (0..grid.len()).map(height).collect(), crs: None };
///
/// let targets = vec![Target::Interval { step: 10.0, base: 0.0 }];
/// let found = contours(&dem, &ContourParams { targets, ..ContourParams::default() }, &())?;
/// let line = found.layers[0].lines.iter().find(|line| line.elevation == 50.0).expect("the cone is higher");
/// assert!(line.is_closed() && !line.depression);
/// assert!(line.points.iter().all(|p| (p.distance(top) - 50.0).abs() < found.tolerance));
/// # Ok::<(), tokosen_core::Error>(())
/// ```
///
/// # Errors
/// When the levels of a target or the tolerance are out of range (see [`Target::levels`]), when there is no target, when
/// levels are closer than heights of 32 bits can tell, when no cell has a height, or when the work needs more memory
/// than it may take. [`Error::PartOutside`] for a part outside of the height map. As [`smoothed`].
pub fn contours(dem: &Dem, params: &ContourParams, progress: &dyn Progress) -> Result<DemContours> {
    let side = dem.grid.cell.min_element();
    let tolerance = params.tolerance.unwrap_or(TOLERANCE * side);
    if !(tolerance.is_finite() && tolerance >= 0.0) {
        return Err(Error::out_of_range("tolerance of contours", tolerance, "0 or more"));
    }
    params.part.iter().try_for_each(|part| check_part(dem, part))?;
    if dem.grid.len() >= NOT_VISITED as usize || dem.values.len() != dem.grid.len() {
        return Err(Error::Parameter(format!("{} heights for {} cells", dem.values.len(), dem.grid.len())));
    }
    let bytes = BYTES_PER_CELL + BYTES_PER_MARK * rayon::current_num_threads() as f64;
    let remedy = "clip the height map, or make its cells larger";
    let what = || format!("contours of {} cells", dem.grid.len());
    memory::check(bytes * dem.grid.len() as f64, params.memory, what(), remedy)?;
    let (changed, smoothing) = match params.smooth {
        Some(radius) => {
            let (changed, change) = smoothed(dem, radius, progress)?;
            (Some(changed), Some(change))
        }
        None => (None, None),
    };
    let dem = changed.as_ref().unwrap_or(dem);
    let heights = extremes(dem)?;
    let wanted = wanted(heights, params)?;
    let levels = together(&wanted)?;
    let tolerance = tolerance.max(SMALLEST_TOLERANCE * side);
    let traced = traced(dem, &levels, tolerance, params.memory, progress)?;
    let crossings = traced.iter().map(|level| level.crossings).sum();
    let mut layers = layers(params, &wanted, &levels, traced);
    if let Some(part) = &params.part {
        layers.iter_mut().for_each(|layer| clip_lines(&mut layer.lines, part));
    }
    Ok(DemContours { layers, tolerance, crossings, heights, levels: wanted, smoothing })
}

/// # Errors
/// [`Error::PartOutside`] if the boxes around the part and around the cells do not overlap.
fn check_part(dem: &Dem, part: &MultiPolygon<f64>) -> Result<()> {
    let map = dem.corners();
    let part = part.bounding_rect().map(|part| [part.min(), part.max()].map(|c| DVec2::new(c.x, c.y)));
    match part {
        Some(part) if part[0].cmplt(map[1]).all() && part[1].cmpgt(map[0]).all() => Ok(()),
        part => Err(Error::PartOutside { part: part.unwrap_or_default(), map, of: "the height map" }),
    }
}

/// The lines of each target.
fn layers(params: &ContourParams, wanted: &[Vec<f64>], levels: &[f64], mut traced: Vec<Level>) -> Vec<ContourLayer> {
    let place = |levels: &[f64], level: &f64| levels.binary_search_by(|other| other.total_cmp(level)).ok();
    let mut layers = Vec::new();
    for (t, target) in params.targets.iter().enumerate() {
        let interval = smallest_difference(&wanted[t]).unwrap_or(f64::NAN);
        let mut lines = Vec::new();
        for level in &wanted[t] {
            let Some(k) = place(levels, level) else { continue };
            let is_last = !wanted[t + 1..].iter().any(|later| place(later, level).is_some());
            let of_level = if is_last { std::mem::take(&mut traced[k].lines) } else { traced[k].lines.clone() };
            let index = target.is_index(interval, params.unit, params.index_every, *level);
            lines.extend(of_level.into_iter().map(|points| line(*level, points, index)));
        }
        let name = target.layer_name(params.unit);
        layers.push(ContourLayer { name, lines, artefact_rings: 0, dead_ends: 0 });
    }
    layers
}

fn line(elevation: f64, points: Vec<DVec2>, index: bool) -> ContourLine {
    let mut line = ContourLine {
        elevation,
        points,
        source: Source::HeightMap,
        index,
        kind: None,
        depression: false,
        expected: None,
    };
    // Higher ground is on the right. So it lies outside a counter-clockwise ring.
    line.depression = line.is_closed() && signed_area(&line.points) > 0.0;
    line
}

/// The lowest and the highest height.
fn extremes(dem: &Dem) -> Result<[f32; 2]> {
    let extremes = |(low, high): (f32, f32), height: f32| (low.min(height), high.max(height));
    let both = |a: (f32, f32), b: (f32, f32)| (a.0.min(b.0), a.1.max(b.1));
    let none = || (f32::INFINITY, f32::NEG_INFINITY);
    let (low, high) = dem.values.par_iter().copied().fold(none, extremes).reduce(none, both);
    if low > high {
        return Err(Error::Data("no cell of the height map has a height".into()));
    }
    Ok([low, high])
}

/// The levels of each target between the lowest and the highest height, metres.
fn wanted([low, high]: [f32; 2], params: &ContourParams) -> Result<Vec<Vec<f64>>> {
    if params.targets.is_empty() {
        return Err(Error::Parameter("no interval and no levels are given".into()));
    }
    let beyond = |height: f32, sign: f64| f64::from(height) + sign * BEYOND * f64::from(height.abs());
    let levels = |target: &Target| target.levels(params.unit, beyond(low, -1.0), beyond(high, 1.0));
    params.targets.iter().map(levels).collect()
}

/// All levels, ascending.
///
/// # Errors
/// Two levels that are the same number of 32 bits.
fn together(wanted: &[Vec<f64>]) -> Result<Vec<f64>> {
    let mut levels: Vec<f64> = wanted.iter().flatten().copied().collect();
    levels.sort_by(f64::total_cmp);
    levels.dedup();
    match levels.windows(2).find(|pair| pair[0] as f32 >= pair[1] as f32) {
        Some(pair) => Err(Error::Parameter(format!(
            "the levels {} and {} m are closer than heights of 32 bits can tell: choose a larger interval",
            pair[0], pair[1]
        ))),
        None => Ok(levels),
    }
}

fn smallest_difference(levels: &[f64]) -> Option<f64> {
    levels.windows(2).map(|pair| pair[1] - pair[0]).reduce(f64::min)
}

/// The lines of one level, map coordinates.
#[derive(Debug, Default)]
struct Level {
    lines: Vec<Vec<DVec2>>,
    crossings: u64,
}

/// Traces all levels.
fn traced(
    dem: &Dem,
    levels: &[f64],
    tolerance: f64,
    budget: Option<u64>,
    progress: &dyn Progress,
) -> Result<Vec<Level>> {
    let Grid { cols, cell, .. } = dem.grid;
    let heights: Vec<f32> = levels.iter().map(|&level| level as f32).collect();
    let field = Field::new(&dem.values, cols, &heights);
    let counts = counts(&field, dem.values.len(), levels.len());
    let crossings = counts.iter().sum::<usize>() as f64;
    let what = format!("contours at {} levels with about {crossings:.0} crossings of cells", levels.len());
    memory::check(BYTES_PER_CROSSING * crossings, budget, what, "choose a larger interval, or fewer levels")?;
    let marks: Vec<Mutex<Vec<u32>>> = (0..rayon::current_num_threads().max(1)).map(|_| Mutex::default()).collect();
    let first = dem.grid.center(0, 0);
    progress.start("tracing", levels.len() as u64);
    let mut found = Vec::with_capacity(levels.len());
    while found.len() < levels.len() {
        let from = found.len();
        let to = end_of_batch(&counts, from, BATCH);
        let batch = from as u32..to as u32;
        let squares = Rows::new(to - from, || {
            (0..dem.values.len()).flat_map(|square| {
                let crossed = field.levels_of(square);
                let crossed = crossed.start.max(batch.start)..crossed.end.min(batch.end);
                crossed.map(move |k| (k as usize - from, square as u32))
            })
        });
        found.par_extend((from..to).into_par_iter().map(|k| {
            // Levels have different marks. So an array that another level used needs no clearing.
            let own = rayon::current_thread_index().unwrap_or(0) % marks.len();
            let mut visited = marks[own].lock().unwrap_or_else(PoisonError::into_inner);
            visited.resize(dem.values.len(), NOT_VISITED);
            let freedom = Freedom { tolerance: tolerance / cell, gap: gap(&heights, k) };
            let mut trace = Trace { field: &field, k: k as u32, freedom, visited: &mut visited };
            let (mut level, mut space) = (Level::default(), Workspace::default());
            trace.lines(squares.of(k - from), |course| {
                level.crossings += course.crossings.len() as u64;
                let vertices = course::vertices(&course, freedom.tolerance, &mut space);
                level.lines.push(vertices.into_iter().map(|p| first + p * cell).collect());
            });
            progress.advance(1);
            level
        }));
    }
    progress.finish();
    Ok(found)
}

/// How many squares each level crosses.
fn counts(field: &Field<'_>, squares: usize, levels: usize) -> Vec<usize> {
    // Starts and ends of ranges; the sum up to a level is its count.
    let changes = (0..squares).into_par_iter().fold(
        || vec![0_i64; levels + 1],
        |mut changes, square| {
            let crossed = field.levels_of(square);
            changes[crossed.start as usize] += 1;
            changes[crossed.end as usize] -= 1;
            changes
        },
    );
    let sum = |mut a: Vec<i64>, b: Vec<i64>| {
        a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
        a
    };
    let changes = changes.reduce(|| vec![0; levels + 1], sum);
    let mut count = 0;
    let through = |change: &i64| {
        count += change;
        count as usize
    };
    changes[..levels].iter().map(through).collect()
}

/// Difference between a level and the nearest other one, metres; infinite if there is none.
fn gap(levels: &[f32], k: usize) -> f64 {
    let difference = |pair: &[f32]| f64::from(pair[1]) - f64::from(pair[0]);
    let below = k.checked_sub(1).map_or(f64::INFINITY, |below| difference(&levels[below..=k]));
    levels.get(k..k + 2).map_or(f64::INFINITY, difference).min(below)
}
