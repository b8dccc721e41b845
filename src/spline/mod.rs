//! The smooth surface: minimum curvature through the contours, on a working grid.
//!
//! The surface of least bending energy that passes through the contours, with three things added to the plain one:
//!
//! * Every node stays inside the band of its sub-domain while the surface is found, not only afterwards.
//! * Tension draws it to the slopes of the surface with ridge and canyon lines (the paper's), not to level ground: where
//!   contours are close, the straight way between them is the best guess, and shelves and bulges do not arise.
//! * It may bend sharply where it must, most of all along ridge and canyon lines.
//!
//! How much tension, and whether contours jitter and are to be smoothed, is seen from the data (`choose`, `roughness`).
//!
//! `stages` finds it from coarse to fine lattices (`lattice`), each by conjugate gradients between bounds
//! (`minimise`, `tile`, `stencil`) for the energy in `energy`, whose weights follow the surface (`reweight`).
//! Then heights are drawn away from the levels, and ridges and valleys get more relief, as far as hidden contours tell
//! (`expected`, `relief`), and last, ways out of pits are cut (`pits`).

mod blur;
mod energy;
mod expected;
pub(crate) mod grid;
mod lattice;
mod minimise;
mod pits;
mod relief;
mod residual;
mod reweight;
mod stages;
mod stencil;
mod tile;
mod unevenness;

pub(crate) use blur::blurred;
pub(crate) use grid::{bytes_on, working_grid};
pub(crate) use lattice::Lattice;

use std::borrow::Cow;

use glam::DVec2;
use rayon::prelude::*;

use crate::base::Grid;
use crate::base::progress::Progress;
use crate::contour::ContourMap;
use crate::dem::heights_at;
use crate::skeleton::BreakLine;
use crate::subdivision::Subdivision;
use crate::subdomains::{Side, line_at, line_starts, local_bands};
use crate::tin::NONE;
use energy::CrossingWeight;
use lattice::Crossing;
use pits::{Limits, breach};
use stages::{Problem, solve};

/// Weights of crossings against second differences: the contours are met within a thousandth of the interval, and where their
/// vertices lie on the lattice, which they were cut from then, as exactly as they can be found in so many steps.
const CONTOUR_WEIGHT: CrossingWeight = CrossingWeight { at_vertex: 1000.0, on_chord: 500.0 };
/// ... and where the noise is 1, on a grid with as many nodes a gap as it should have.
const NOISY_WEIGHT: f64 = 0.1;
/// Rounds of averaging over neighbours that smooth the tension.
const SMOOTHING: usize = 3;
/// Limits of the local gap between contours against the mean gap, for the tension.
const GAP_LIMITS: (f64, f64) = (1e-3, 1e3);
/// Share of the guide where the surface is level and the guide is not.
const SHELF_SHARE: f32 = 0.3;
/// Rows and columns on each side over which that share is averaged.
const SHELF_REACH: usize = 2;

/// What this step is called where progress is told.
pub(crate) const STEP: &str = "smooth surface";

/// What is left of a standard error in a band of a height, after heights were drawn in and bulges and hollows grew.
pub(crate) fn error_left(error: f64, height: f64, knobs: &Knobs) -> f64 {
    let error = if knobs.half_way > 0.0 { expected::left(error, height) } else { error };
    relief::left(error, knobs.relief)
}

/// Heights at the nodes of a working grid.
#[derive(Debug, Clone, PartialEq)]
pub struct WorkingGrid {
    /// Nodes are the cells' centres.
    pub grid: Grid,
    /// Heights, metres, within the band of each node's sub-domain; NaN outside the frame.
    pub heights: Vec<f32>,
}

/// Cells that heights are wanted on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Wanted {
    /// Square cells of this size (map units) on multiples of it.
    Cell(f64),
    /// These.
    Grid(Grid),
}

/// How the smooth surface is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SplineParams {
    /// Where heights are wanted, if anywhere: the working grid then shares its nodes.
    pub wanted: Option<Wanted>,
    /// Tension without dimension: weight of first against second differences, times mean gap times local gap between
    /// contours. More of it, and the surface is nearer to the one with ridge and canyon lines. `None`: chosen from the data.
    pub tension: Option<f64>,
    /// How much the contours jitter: 0 for smooth ones, 1 for those of unsmoothed lidar. The surface is first found with
    /// less regard for them, then moved to meet them. `None`: 0 or 1, as the contours look.
    pub noise: Option<f64>,
}

/// What the surface on a grid is found from, whatever the [`Knobs`].
pub(crate) struct Draft<'a> {
    grid: Grid,
    subdivision: &'a Subdivision,
    break_lines: &'a [BreakLine],
    pub(crate) gap: f64,
    bounds: [Vec<f32>; 2],
    pub(crate) guide: Vec<f32>,
    /// Nodes where water may stay.
    hollows: Vec<bool>,
}

impl Draft<'_> {
    /// What bulges and hollows of a surface on the grid lack ([`relief::lacking`]) if it may be off by a metre half-way between
    /// contours in the mean.
    pub(crate) fn lacking_relief(&self, heights: &[f32]) -> Vec<f32> {
        let Draft { grid, subdivision, gap, bounds: [lo, hi], guide, .. } = self;
        let (lattice, interval) = (Lattice::of_grid(grid), subdivision.interval.step);
        let closeness = closeness(guide, grid, *gap, interval);
        let variances =
            expected::variances(1.0, heights, &closeness, *gap, &lattice, &spots(subdivision, &lattice, guide));
        relief::lacking(heights, [lo, hi], &variances, *gap, &lattice, interval)
    }
}

/// What is chosen from the data.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Knobs {
    /// See [`SplineParams::tension`].
    pub tension: f64,
    /// See [`SplineParams::noise`].
    pub noise: f64,
    /// The bending across ridge and canyon lines from which on it counts with its size, not its square, as a share of that
    /// elsewhere: less of it, and they are sharper.
    pub crease_knee: f64,
    /// Standard error half-way between two contours, metres, as hidden ones tell; 0 where it is not known. Heights are drawn
    /// from the levels towards the middle between them for it.
    pub half_way: f64,
    /// By how much the relief of the surface is less than the ground's, as a share of that error, as hidden contours tell.
    pub relief: f64,
}

/// Looks up bands and guide at the nodes of a grid. `subdivision` is the triangulation with ridge and canyon lines, `triangles` are
/// those that the nodes lie in.
pub(crate) fn draft<'a>(
    subdivision: &'a Subdivision,
    break_lines: &'a [BreakLine],
    grid: &Grid,
    triangles: &[u32],
) -> Draft<'a> {
    let (wrong, starts) = (subdivision.wrong_lines(), line_starts(&subdivision.map));
    let is_wrong = |v: u32| {
        !wrong.is_empty()
            && line_at(&subdivision.tin, &starts, v).is_some_and(|line| wrong.binary_search(&line).is_ok())
    };
    let local = local_bands(&subdivision.tin, &subdivision.regions, is_wrong);
    let of_region = |t: u32| subdivision.regions.region(t).map(|r| r.band);
    let band = |&t: &u32| if t == NONE { None } else { local.get(&t).copied().or_else(|| of_region(t)) };
    let mut lo: Vec<f32> = triangles.par_iter().map(|t| band(t).map_or(f32::NAN, |b| b.lo as f32)).collect();
    let mut hi: Vec<f32> = triangles.par_iter().map(|t| band(t).map_or(f32::NAN, |b| b.hi as f32)).collect();
    for (node, level) in on_contours(&subdivision.map, grid) {
        if !lo[node].is_nan() {
            (lo[node], hi[node]) = (level as f32, level as f32);
        }
    }
    let is_hollow = is_hollow(subdivision);
    let hollows: Vec<bool> = triangles
        .par_iter()
        .map(|&t| t != NONE && is_hollow[subdivision.regions.of_triangle[t as usize] as usize])
        .collect();
    let guide = heights_at(&subdivision.tin, grid, triangles);
    Draft { grid: *grid, subdivision, break_lines, gap: subdivision.sheet().gap, bounds: [lo, hi], guide, hollows }
}

/// The nodes of a grid that vertices of contours lie on, with the level: the band on either side of the contour would be too
/// wide.
pub(crate) fn on_contours<'a>(map: &'a ContourMap, grid: &Grid) -> impl Iterator<Item = (usize, f64)> + 'a {
    let lattice = Lattice::of_grid(grid);
    map.contours.iter().flat_map(move |contour| {
        let node = move |p: &DVec2| lattice.node_at(*p).map(|node| (node, contour.elevation));
        contour.points.iter().filter_map(node)
    })
}

/// Finds the smooth surface on the grid of a draft.
pub(crate) fn spline<'a>(draft: &'a Draft<'_>, knobs: &Knobs, progress: &dyn Progress) -> WorkingGrid {
    let Draft { grid, subdivision, break_lines, gap, bounds: [lo, hi], guide, hollows } = draft;
    let lattice = Lattice::of_grid(grid);
    let interval = subdivision.interval.step;
    let contours = subdivision.map.contours.iter().map(|c| (c.elevation, c.points.as_slice())).collect();
    let flat = |line: &BreakLine| line.points.iter().map(|p| p.truncate()).collect();
    let slack = if knobs.noise > 0.0 { (residual::SLACK * interval) as f32 } else { 0.0 };
    let moved = |bound: &'a [f32], by: f32| -> Cow<'a, [f32]> {
        if by == 0.0 { Cow::Borrowed(bound) } else { bound.iter().map(|b| b + by).collect() }
    };
    let closeness = closeness(guide, grid, *gap, interval);
    let problem = Problem {
        lattice,
        contours,
        spots: spots(subdivision, &lattice, guide),
        creases: break_lines.iter().map(flat).collect::<Vec<Vec<DVec2>>>(),
        crease_knee: knobs.crease_knee,
        bounds: [moved(lo, -slack), moved(hi, slack)],
        guide,
        tension: tension(&closeness, grid, *gap, knobs.tension),
        contour_weight: contour_weight(knobs.noise, grid, *gap),
        interval,
        gap: *gap,
        hollows,
    };
    let z = solve(&problem, progress);
    progress.start(STEP, 0);
    let mut heights: Vec<f32> = z.into_iter().map(|v| v as f32).collect();
    let share = shelves(&heights, guide, grid);
    heights.par_iter_mut().enumerate().for_each(|(n, z)| {
        if !guide[n].is_nan() {
            *z += share[n] * (guide[n] - *z);
        }
    });
    if knobs.noise > 0.0 {
        residual::meet(&problem, &mut heights);
    }
    heights.par_iter_mut().enumerate().for_each(|(n, z)| {
        *z = if lo[n].is_nan() { f32::NAN } else { z.clamp(lo[n], hi[n]) };
    });
    if knobs.half_way > 0.0 {
        let variances = expected::variances(knobs.half_way, &heights, &closeness, *gap, &lattice, &problem.spots);
        expected::draw_in(&mut heights, [lo, hi], &variances);
        if knobs.relief > 0.0 {
            let lacking = relief::lacking(&heights, [lo, hi], &variances, *gap, &lattice, interval);
            relief::grow(&mut heights, [lo, hi], &lacking, knobs.relief);
        }
    }
    let limits = Limits { lo, depth: interval as f32 };
    breach(&mut heights, &lattice, &limits, |n| hollows[n]);
    progress.finish();
    WorkingGrid { grid: *grid, heights }
}

/// By sub-domain: whether the ground lies in a hollow that contours enclose, or may: all its levels are above it.
fn is_hollow(subdivision: &Subdivision) -> Vec<bool> {
    let regions = &subdivision.regions.regions;
    regions.iter().map(|r| r.levels.iter().all(|(_, side)| *side == Side::Below)).collect()
}

/// Weight of a crossing against a second difference: a contour's weight for its length is the same on every grid.
fn contour_weight(noise: f64, grid: &Grid, gap: f64) -> CrossingWeight {
    let cell = (grid.cell.x * grid.cell.y).sqrt();
    let noisy = NOISY_WEIGHT / (noise * noise) * (grid::NODES_A_GAP * cell / gap).powi(3);
    CONTOUR_WEIGHT.map(|weight| noisy.min(weight))
}

/// Mean gap between contours over the local one at each node, which is the interval over the guide's slope.
fn closeness(guide: &[f32], grid: &Grid, gap: f64, interval: f64) -> Vec<f32> {
    let slopes = slopes(guide, grid);
    let relative = |s: &f32| {
        let gaps = f64::from(*s) * gap / interval;
        if gaps.is_nan() { 1.0 } else { gaps.clamp(GAP_LIMITS.0, GAP_LIMITS.1) as f32 }
    };
    let mut factor: Vec<f32> = slopes.par_iter().map(relative).collect();
    for _ in 0..SMOOTHING {
        factor = around(&factor, grid, |old, n| {
            (4.0 * old[n] + old[n - 1] + old[n + 1] + old[n - grid.cols] + old[n + grid.cols]) / 8.0
        });
    }
    factor
}

/// Tension at each node, per square of the eastward step: `k / (mean gap · local gap)`.
fn tension(closeness: &[f32], grid: &Grid, gap: f64, k: f64) -> Vec<f32> {
    let whole = k * (grid.cell.x / gap).powi(2);
    closeness.par_iter().map(|f| (whole * f64::from(*f)) as f32).collect()
}

/// A new value for every node that has all its neighbours.
fn around(old: &[f32], grid: &Grid, value: impl Fn(&[f32], usize) -> f32 + Sync) -> Vec<f32> {
    let at = |n: usize| {
        let (i, j) = (n % grid.cols, n / grid.cols);
        let inner = i > 0 && i + 1 < grid.cols && j > 0 && j + 1 < grid.rows;
        if inner { value(old, n) } else { old[n] }
    };
    (0..old.len()).into_par_iter().map(at).collect()
}

/// Slope at every node, rise over run; NaN beside nodes outside the frame.
pub(crate) fn slopes(heights: &[f32], grid: &Grid) -> Vec<f32> {
    let at = |n: usize| {
        let (i, j) = (n % grid.cols, n / grid.cols);
        let (w, e) = (i.saturating_sub(1), (i + 1).min(grid.cols - 1));
        let (s, t) = (j.saturating_sub(1), (j + 1).min(grid.rows - 1));
        let east =
            (heights[j * grid.cols + e] - heights[j * grid.cols + w]) / ((e - w).max(1) as f64 * grid.cell.x) as f32;
        let south =
            (heights[t * grid.cols + i] - heights[s * grid.cols + i]) / ((t - s).max(1) as f64 * grid.cell.y) as f32;
        (east * east + south * south).sqrt()
    };
    (0..heights.len()).into_par_iter().map(at).collect()
}

/// How much of the guide to take at each node: where the surface is a shelf or a bulge, less steep than the guide.
fn shelves(heights: &[f32], guide: &[f32], grid: &Grid) -> Vec<f32> {
    let (own, other) = (slopes(heights, grid), slopes(guide, grid));
    let share = |(own, other): (&f32, &f32)| {
        let less = 1.0 - own / other.max(f32::MIN_POSITIVE);
        if less.is_nan() { 0.0 } else { SHELF_SHARE * less.clamp(0.0, 1.0) }
    };
    let shares: Vec<f32> = own.par_iter().zip(&other).map(share).collect();
    blurred(&shares, grid.cols, SHELF_REACH)
}

/// Spot heights, carried to the four nodes around each along the guide.
fn spots(subdivision: &Subdivision, lattice: &Lattice, guide: &[f32]) -> Vec<(Crossing, f64)> {
    let mut found = Vec::new();
    for spot in subdivision.used_spots() {
        let place = lattice.place(spot.truncate());
        let (col, row) = (place.x.floor(), place.y.floor());
        if col < 0.0 || row < 0.0 || col as usize + 1 >= lattice.cols || row as usize + 1 >= lattice.rows {
            continue;
        }
        let (u, v) = (place.x - col, place.y - row);
        let node = row as usize * lattice.cols + col as usize;
        let below = node + lattice.cols;
        let g = |n: usize| f64::from(guide[n]);
        let north = g(node) * (1.0 - u) + g(node + 1) * u;
        let south = g(below) * (1.0 - u) + g(below + 1) * u;
        let here = north * (1.0 - v) + south * v;
        if here.is_finite() {
            // The guide passes through the spot itself; its slope carries the height to the edges north and south.
            found.push((Crossing { node: node as u32, along: u, at_vertex: false }, spot.z + north - here));
            found.push((Crossing { node: below as u32, along: u, at_vertex: false }, spot.z + south - here));
        }
    }
    found
}
