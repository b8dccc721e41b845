//! The choice of the working grid.

use glam::DVec2;

use super::params::Wanted;
use crate::base::Grid;
use crate::contour::{SourceRaster, source_raster};
use crate::subdomains::MapExtent;
use crate::tuning::GridTuning;

/// Largest number of nodes. It limits memory. It is the same on all machines, because the surface must not depend on
/// the machine.
const MOST_NODES: f64 = 40e6;
/// Nodes that every map may have, besides those of the cells that are wanted.
const FREE_NODES: f64 = 2e5;
/// Further nodes per vertex of the contours. Ten real maps have 1 to 10. Only lines that are straight over many times their
/// spacing need more, and there more nodes add nothing.
const NODES_PER_VERTEX: f64 = 16.0;
/// The user is told of nodes that are further apart than this many times what the contours ask for.
const COARSER: f64 = 1.5;
/// Largest number of nodes of a grid that is divided for break lines. It limits time.
const MOST_NODES_FOR_LINES: f64 = 10e6;
/// The first node of a part's grid is a multiple of this many nodes of the whole map's: a power of two, times three because of
/// the solver's tiles.
const ALIGNED: usize = 192;
/// A divided grid is cut to the map again if that leaves less than one node in so many.
const WASTE: usize = 4;
/// Bytes of memory per node while the surface is found, as measured. They include one crossing of a contour per node.
const BYTES_PER_NODE: f64 = 120.0;
/// Bytes of memory per further crossing of a contour with an edge between nodes, as measured.
const BYTES_PER_CROSSING: f64 = 100.0;
/// Nodes per mean segment of the contours, at most. What lies between two vertices is unknown.
const NODES_PER_SEGMENT: f64 = 2.0;
/// Nodes per spacing, at least, however long the segments are.
const MIN_NODES_PER_SPACING: f64 = 3.0;
/// Largest cell of a height map, in spacings, that is not divided for the working grid. Above it, several
/// contours cross the edges between nodes.
const MAX_SPACINGS_PER_CELL: f64 = 2.0;

/// Mean distance between neighbouring vertices of contours, map units.
fn vertex_spacing(extent: &MapExtent<'_>) -> f64 {
    let contours = &extent.map.contours;
    let length: f64 = contours.iter().map(|c| c.length()).sum();
    let segments: usize = contours.iter().map(|c| c.points.len().saturating_sub(1)).sum();
    length / segments.max(1) as f64
}

/// The working grid. It is fine enough for the contours, and it shares nodes with the grid that heights are wanted on.
///
/// * The wanted grid itself is used where its cells suit the contours.
/// * Cells that are too large are divided into an odd number of rows and columns. So their centres stay nodes.
/// * Of cells that are much too small, every n-th row and column is used.
/// * Without a wanted grid, the raster that the contours were cut from takes its place. The contours give heights at
///   its cells.
/// * Without such a raster, cells lie on multiples of their size.
pub fn working_grid(extent: &MapExtent<'_>, wanted: Option<Wanted>, tuning: &GridTuning) -> Grid {
    of_sizes(extent.spacing, Sizes::new(extent, wanted, tuning), tuning)
}

/// The working grid of a whole map, of which only parts are computed: [`working_grid`], but its size does not make it coarse.
pub fn whole_grid(extent: &MapExtent<'_>, wanted: Option<Wanted>, tuning: &GridTuning) -> Grid {
    let sizes = Sizes::new(extent, wanted, tuning);
    let is_coarse = sizes.least > COARSER * sizes.asked;
    let sizes = if is_coarse { Sizes { least: 0.0, most: f64::INFINITY, ..sizes } } else { sizes };
    of_sizes(extent.spacing, sizes, tuning)
}

/// The part of a whole map's grid around a box. It begins where a tile of the solver does, so that the nodes of its coarser
/// lattices are those of the whole map too.
pub fn part_of_grid(whole: &Grid, lo: DVec2, hi: DVec2) -> Grid {
    let part = clipped(whole, lo, hi);
    let first = ((part.corner - whole.corner) / whole.cell).abs().round();
    let [west, north] = [first.x, first.y].map(|first| first as usize % ALIGNED);
    let corner = part.corner - DVec2::new(west as f64, -(north as f64)) * whole.cell;
    Grid { corner, cols: part.cols + west, rows: part.rows + north, ..*whole }
}

fn of_sizes(spacing: f64, sizes: Sizes, tuning: &GridTuning) -> Grid {
    let Sizes { lo, hi, asked, finest, least, cut, most } = sizes;
    let cells = cut.map_or(0, |cut| cut.len()) as f64;
    let size = hi - lo;
    let cell = asked.max(least).max(1e-6 * size.max_element());
    let Some(cut) = cut else { return with_border(&Grid::on_multiples(lo, hi, cell)) };
    let is = (cut.cell.x * cut.cell.y).sqrt();
    if is > MAX_SPACINGS_PER_CELL * spacing {
        let whole = divided(&cut, odd_above(is / spacing.max(least), most / cells));
        let on_map = clipped(&divided(&cut, odd_above(is / spacing.max(least), f64::INFINITY)), lo, hi);
        if on_map.len() < whole.len() / WASTE { on_map } else { whole }
    } else if is >= finest.max(least / tuning.max_times_finer) && cells <= most {
        cut
    } else {
        thinned(&cut, (cell / is).ceil() as usize)
    }
}

/// The distance between nodes that the contours ask for, and the least that a map of this extent may have, if that is
/// larger. Both are in map units.
pub fn coarser_than_asked(extent: &MapExtent<'_>, wanted: Option<Wanted>, tuning: &GridTuning) -> Option<[f64; 2]> {
    let Sizes { asked, least, .. } = Sizes::new(extent, wanted, tuning);
    (least > COARSER * asked).then_some([asked, least])
}

/// What the size of the nodes follows from.
struct Sizes {
    /// The box around the frame.
    lo: DVec2,
    hi: DVec2,
    /// The distance between nodes that the contours ask for.
    asked: f64,
    /// The least cell of a height map whose grid is the working grid.
    finest: f64,
    /// The least distance that the limit of nodes allows.
    least: f64,
    /// The grid that is wanted, cut to the box.
    cut: Option<Grid>,
    /// The limit of nodes.
    most: f64,
}

impl Sizes {
    fn new(extent: &MapExtent<'_>, wanted: Option<Wanted>, tuning: &GridTuning) -> Self {
        let (lo, hi) = extent.frame.extent();
        let spacing = extent.spacing;
        let of_vertices = (vertex_spacing(extent) / NODES_PER_SEGMENT).min(spacing / MIN_NODES_PER_SPACING);
        let asked = (spacing / tuning.nodes_per_spacing).max(of_vertices);
        let finest = (2.0 * spacing / tuning.nodes_per_spacing).max(of_vertices) / tuning.max_times_finer;
        let is_given = matches!(wanted, Some(Wanted::Grid(_)));
        let cut = match wanted {
            Some(Wanted::Grid(grid)) if !grid.is_empty() => Some(grid),
            Some(Wanted::Cell(cell)) => Some(Grid::on_multiples(lo, hi, cell)),
            _ => source_raster(&extent.map.contours).map(|raster| cells_of(&raster, lo, hi)),
        };
        let cut = cut.map(|wanted| clipped(&wanted, lo, hi));
        let cells = cut.map_or(0, |cut| cut.len()) as f64;
        let most = MOST_NODES.min(FREE_NODES + NODES_PER_VERTEX * extent.map.vertex_count() as f64 + cells);
        // Ground outside the grid that is wanted needs no nodes.
        let covered = cut.filter(|_| is_given).map(|cut| cut.cell * DVec2::new(cut.cols as f64, cut.rows as f64));
        let size = covered.map_or(hi - lo, |covered| covered.min(hi - lo));
        Self { lo, hi, asked, finest, least: (size.x * size.y / most).sqrt(), cut, most }
    }
}

/// A grid with `times` as many rows and columns, or with fewer if there would be too many nodes. The factor is rounded up to an
/// odd number, so that all nodes of the grid stay.
pub fn finer_grid(grid: &Grid, times: f64) -> Grid {
    divided(grid, odd_above(times, MOST_NODES_FOR_LINES / grid.len().max(1) as f64))
}

/// About how many bytes the smooth surface takes on a grid. `length` is the length of all contours, map units.
///
/// Where contours are much closer than nodes, their crossings with the edges between nodes take most of the memory.
pub fn bytes_on(grid: &Grid, length: f64) -> f64 {
    let nodes = grid.cols as f64 * grid.rows as f64;
    // Crossings of a line of any direction: the mean of |cos| and of |sin| is 2/π each.
    let crossings = 2.0 * std::f64::consts::FRAC_2_PI * length / (grid.cell.x * grid.cell.y).sqrt();
    BYTES_PER_NODE * nodes + BYTES_PER_CROSSING * (crossings - nodes).max(0.0)
}

/// The cells of a raster that cover the box, and one more on each side.
fn cells_of(raster: &SourceRaster, lo: DVec2, hi: DVec2) -> Grid {
    let cell = raster.cell;
    let first = ((lo - raster.centre) / cell).floor() - 1.0;
    let count = ((hi - raster.centre) / cell).ceil() + 2.0 - first;
    let top = raster.centre.y + (first.y + count.y - 0.5) * cell.y;
    let corner = DVec2::new(raster.centre.x + (first.x - 0.5) * cell.x, top);
    Grid { corner, cell, cols: count.x as usize, rows: count.y as usize }
}

/// The grid with one cell more on each side.
fn with_border(grid: &Grid) -> Grid {
    let corner = grid.corner + DVec2::new(-grid.cell.x, grid.cell.y);
    Grid { corner, cols: grid.cols + 2, rows: grid.rows + 2, ..*grid }
}

/// The part of a grid that covers the box and one cell around it; at least two by two cells.
fn clipped(grid: &Grid, lo: DVec2, hi: DVec2) -> Grid {
    let limit = |v: f64, most: usize| v.clamp(0.0, most as f64) as usize;
    let west = limit(((lo.x - grid.corner.x) / grid.cell.x).floor() - 1.0, grid.cols.saturating_sub(2));
    let east = limit(((hi.x - grid.corner.x) / grid.cell.x).ceil() + 1.0, grid.cols).max((west + 2).min(grid.cols));
    let north = limit(((grid.corner.y - hi.y) / grid.cell.y).floor() - 1.0, grid.rows.saturating_sub(2));
    let south = limit(((grid.corner.y - lo.y) / grid.cell.y).ceil() + 1.0, grid.rows).max((north + 2).min(grid.rows));
    let corner = grid.corner + DVec2::new(west as f64 * grid.cell.x, -(north as f64) * grid.cell.y);
    Grid { corner, cols: east - west, rows: south - north, ..*grid }
}

/// The least odd whole number that is not below `ratio`, but at most the largest whose square is within `most`.
fn odd_above(ratio: f64, most: f64) -> usize {
    let largest = most.sqrt().clamp(1.0, MOST_NODES) as usize;
    (ratio.min(MOST_NODES).ceil() as usize | 1).min((largest - 1) | 1)
}

/// Divides every cell into `by` times `by` cells. `by` is odd, so the centres stay nodes.
fn divided(grid: &Grid, by: usize) -> Grid {
    Grid { cell: grid.cell / by as f64, cols: grid.cols * by, rows: grid.rows * by, ..*grid }
}

/// Every `by`th row and column of cells, from the first on, until all cells are covered.
fn thinned(grid: &Grid, by: usize) -> Grid {
    let cell = grid.cell * by as f64;
    let first = grid.center(0, 0);
    let corner = first + DVec2::new(-cell.x / 2.0, cell.y / 2.0);
    Grid { corner, cell, cols: grid.cols.div_ceil(by) + 1, rows: grid.rows.div_ceil(by) + 1 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cells_of_a_raster_reach_beyond_the_box() {
        let raster = SourceRaster { centre: DVec2::new(100.5, -7.25), cell: DVec2::new(3.0, 2.0) };
        for (lo, hi) in [((-50.0, -80.0), (20.0, 33.0)), ((500.0, 7.0), (501.0, 7.5)), ((100.5, -7.25), (103.5, -5.25))]
        {
            let (lo, hi) = (DVec2::from(lo), DVec2::from(hi));
            let grid = cells_of(&raster, lo, hi);
            assert!(raster.has_cells_of(&grid), "{grid:?}");
            let (first, last) = (grid.center(0, grid.rows - 1), grid.center(grid.cols - 1, 0));
            let margins = [(lo - first) / raster.cell, (last - hi) / raster.cell];
            assert!(margins.iter().all(|m| m.min_element() >= 1.0 && m.max_element() < 3.0), "{margins:?}");
        }
    }

    #[test]
    fn a_finer_grid_keeps_the_nodes_and_has_not_too_many() {
        let grid = Grid { corner: DVec2::new(100.0, 50.0), cell: DVec2::new(2.0, 3.0), cols: 500, rows: 400 };
        for (times, by) in [(0.3, 1), (1.0, 1), (1.2, 3), (3.0, 3), (3.1, 5), (5.1, 7), (9.0, 7), (1e300, 7)] {
            let found = finer_grid(&grid, times);
            assert_eq!([found.cols, found.rows], [500 * by, 400 * by], "{times}");
            let (col, row) = (7 * by + by / 2, 9 * by + by / 2);
            assert!(found.center(col, row).distance(grid.center(7, 9)) < 1e-9, "{times}");
        }
        let large = Grid { cols: 5_000, rows: 4_000, ..grid };
        assert_eq!(finer_grid(&large, 9.0), large);
    }

    #[test]
    fn contours_closer_than_nodes_count_by_their_crossings() {
        let grid = Grid { corner: DVec2::ZERO, cell: DVec2::splat(10.0), cols: 1_000, rows: 1_000 };
        let lines = |spacing: f64| bytes_on(&grid, 1e8 / spacing);
        assert_eq!(lines(60.0), 1.2e8);
        assert!(lines(0.01) > 1e11, "a thousand lines between two nodes");
    }
}
