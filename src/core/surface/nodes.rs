//! The smooth surface as triangles, for slicing and meshes.
//!
//! Contours keep their levels and stay edges, and so do ridge and canyon lines. Between them go nodes of the working
//! grid, where contours are further apart than the nodes. New contours through such triangles cannot cross an input
//! contour, whatever the surface is like.
//!
//! Nodes near a contour, near a ridge or canyon line or near the frame are left out, because they would make slivers.
//! Nodes are also left out where straight lines between their neighbours are close enough ([`thinned`]).

use glam::DVec2;

use super::parted::{PartedPiece, part_long_borders, part_long_pieces};
use super::smooth_height::smooth_height;
use crate::base::error::Result;
use crate::base::{Grid, parallel};
use crate::contour::source_raster;
use crate::skeleton::{Axis, SkeletonLine, flow, skeleton_lines};
use crate::spline::{Lattice, WorkingGrid, WorkingGrids};
use crate::subdivision::Subdivision;
use crate::tin::{InnerPoint, NONE, PartedEdge, VertexKind};
use crate::tuning::Tuning;

/// Side of the largest square without a node inside, in steps between nodes. It is a power of two, because squares are
/// halved.
const LARGEST: usize = 16;

/// The triangulation of the smooth surface, and the ridge and canyon lines with heights on it.
///
/// `subdivision` holds the triangulation with the points and pieces of `axis`. `working` holds the surface; the nodes of
/// each of its grids lie in `triangles`.
pub(crate) fn with_nodes(
    mut subdivision: Subdivision,
    mut axis: Axis,
    working: &WorkingGrids,
    triangles: &[Vec<u32>],
    tuning: &Tuning,
) -> Result<(Subdivision, Vec<SkeletonLine>)> {
    let (tuning, of_lines) = (&tuning.nodes, &tuning.skeleton);
    let (vertices, mut heights) = smooth_heights(&subdivision, &mut axis, working);
    let contour_spacing = subdivision.extent().spacing;
    let strided = |part: &WorkingGrid| Strided::new(&part.grid, contour_spacing, tuning.vertices_per_spacing);
    let coarse: Vec<Strided> = working.0.iter().map(strided).collect();
    let spacing = coarse.iter().map(Strided::step).fold(0.0, f64::max);
    let parted = part_long_pieces(&subdivision, &mut axis, (&vertices, &mut heights), working, spacing);
    let flow = flow(&subdivision.tin, &subdivision.regions, &axis, heights, of_lines);
    let lines = skeleton_lines(&subdivision.tin, &subdivision.regions, &axis, &flow);

    let source = source_raster(&subdivision.map.contours);
    let mut points = Vec::new();
    for ((working, triangles), coarse) in working.0.iter().zip(triangles).zip(&coarse) {
        let is_source = source.as_ref().is_some_and(|raster| raster.has_cells_of(&working.grid));
        let clearance = if is_source { tuning.clearance_of_source } else { tuning.clearance };
        let regions = clear_nodes(&subdivision, working, triangles, coarse, clearance);
        let kept = thinned(&regions, working, coarse, tuning.tolerance * subdivision.interval.step);
        let cols = working.grid.cols;
        let point = |k: usize| {
            let (region, node) = (regions[k], coarse.node(k));
            let band = subdivision.regions.regions[region as usize].band;
            let position = working.grid.center(node % cols, node / cols) - subdivision.tin.origin;
            let height = band.strictly_inside(f64::from(working.heights[node]));
            InnerPoint { region, kind: VertexKind::Axis, position, height }
        };
        points.extend(parallel::map_each(&kept, |&k| point(k)));
    }
    let mut edges = part_long_borders(&subdivision, spacing, &mut points);
    for PartedPiece { edge, points: between } in parted {
        let first = points.len();
        let each = axis.points[between.clone()].iter().zip(&flow.heights[between]);
        points.extend(each.map(|(p, &height)| InnerPoint {
            region: p.region,
            kind: VertexKind::Axis,
            position: p.position,
            height,
        }));
        edges.push(PartedEdge { edge, points: first..points.len() });
    }
    for (&v, &height) in vertices.iter().zip(&flow.heights) {
        subdivision.tin.heights[v as usize] = height;
    }
    drop((axis, flow));
    let tin = subdivision.tin.refined(&subdivision.regions.of_triangle, &points, &edges)?;
    drop((points, edges));
    Ok((subdivision.retriangulated(tin, &|p| Some(f64::from(working.at(p)))), lines))
}

/// The vertices of the axis points in `subdivision`, and their heights on the smooth surface. `axis` gets the
/// sub-domains and triangles of `subdivision`. It loses the points that have no vertex of their own.
fn smooth_heights(subdivision: &Subdivision, axis: &mut Axis, working: &WorkingGrids) -> (Vec<u32>, Vec<f64>) {
    let tin = &subdivision.tin;
    let mut vertex_of = vec![NONE; tin.source.iter().max().map_or(0, |&s| s as usize + 1)];
    for (v, &source) in tin.source.iter().enumerate() {
        vertex_of[source as usize] = v as u32;
    }
    let mut triangle_of = vec![NONE; tin.positions.len()];
    let mut contour_distance = vec![f64::INFINITY; tin.positions.len()];
    for t in (0..tin.len() as u32).filter(|&t| tin.is_inside(t)) {
        for i in 0..3 {
            let [u, v] = tin.edge(t, i).map(|v| v as usize);
            triangle_of[u] = t;
            let length = tin.edge_length(t, i);
            for (v, w) in [(u, v), (v, u)] {
                if tin.kinds[w] == VertexKind::Contour {
                    contour_distance[v] = contour_distance[v].min(length);
                }
            }
        }
    }
    let mut heights = Vec::with_capacity(axis.points.len());
    let mut vertices = Vec::with_capacity(axis.points.len());
    let mut known = vec![true; axis.points.len()];
    for (k, point) in axis.points.iter_mut().enumerate() {
        let vertex = vertex_of.get(subdivision.given + k).copied().filter(|&v| v != NONE);
        let triangle = vertex.map(|v| triangle_of[v as usize]).filter(|&t| t != NONE);
        let (Some(v), Some(t)) = (vertex, triangle) else {
            known[k] = false;
            continue;
        };
        point.triangle = t;
        point.region = subdivision.regions.of_triangle[t as usize];
        let before = tin.heights[v as usize];
        let height = smooth_height(working, point.position + tin.origin, before, contour_distance[v as usize]);
        vertices.push(v);
        heights.push(subdivision.regions.regions[point.region as usize].band.strictly_inside(height));
    }
    // Some points share their place with another vertex or lie outside the frame. The pieces that lead to them are
    // dropped.
    axis.retain(&known);
    (vertices, heights)
}

/// Every `stride`th node of a lattice in both directions.
struct Strided {
    lattice: Lattice,
    stride: usize,
}

impl Strided {
    /// The nodes of a grid of which at least `per_spacing` go into the spacing of the contours, or all nodes.
    fn new(grid: &Grid, spacing: f64, per_spacing: f64) -> Self {
        let lattice = Lattice::of_grid(grid);
        let stride = (spacing / (per_spacing * lattice.step.max_element())).floor().max(1.0) as usize;
        Self { lattice, stride }
    }

    /// The larger distance between neighbouring nodes, map units.
    fn step(&self) -> f64 {
        self.stride as f64 * self.lattice.step.max_element()
    }

    fn cols(&self) -> usize {
        self.lattice.cols.div_ceil(self.stride)
    }

    fn rows(&self) -> usize {
        self.lattice.rows.div_ceil(self.stride)
    }

    /// The number of node `k` in the whole lattice.
    fn node(&self, k: usize) -> usize {
        let (col, row) = (k % self.cols(), k / self.cols());
        row * self.stride * self.lattice.cols + col * self.stride
    }

    /// Column and row of a map position, with fractions.
    fn place(&self, p: DVec2) -> DVec2 {
        self.lattice.place(p) / self.stride as f64
    }
}

/// The sub-domain of each node. It is [`NONE`] where there is no height, and near edges that the triangulation must
/// hold.
fn clear_nodes(
    subdivision: &Subdivision,
    working: &WorkingGrid,
    triangles: &[u32],
    nodes: &Strided,
    clearance: f64,
) -> Vec<u32> {
    let tin = &subdivision.tin;
    let region = |k: usize| {
        let node = nodes.node(k);
        let t = triangles[node];
        if t == NONE || working.heights[node].is_nan() { NONE } else { subdivision.regions.of_triangle[t as usize] }
    };
    let mut regions: Vec<u32> = parallel::values(nodes.cols() * nodes.rows(), region);
    let place = |v: u32| nodes.place(tin.positions[v as usize] + tin.origin);
    let mut clear = |a: DVec2, b: DVec2| {
        for_each_near(a, b, clearance, [nodes.cols(), nodes.rows()], |k| regions[k] = NONE);
    };
    for t in (0..tin.len() as u32).filter(|&t| tin.is_inside(t)) {
        for i in 0..3 {
            let other = tin.inner_neighbour(t, i);
            let [u, v] = tin.edge(t, i);
            if other.is_none_or(|n| t < n && tin.is_constraint(t, i)) {
                clear(place(u), place(v));
            }
            if matches!(tin.kinds[u as usize], VertexKind::Spot | VertexKind::Axis) {
                clear(place(u), place(u));
            }
        }
    }
    regions
}

/// Calls `each` for the nodes that are nearer to a segment than `clearance`.
fn for_each_near(a: DVec2, b: DVec2, clearance: f64, [cols, rows]: [usize; 2], mut each: impl FnMut(usize)) {
    let (lo, hi) = (a.min(b) - clearance, a.max(b) + clearance);
    let range = |lo: f64, hi: f64, count: usize| {
        lo.ceil().max(0.0) as usize..(hi.floor() + 1.0).clamp(0.0, count as f64) as usize
    };
    let along = b - a;
    let length = along.length_squared();
    for row in range(lo.y, hi.y, rows) {
        let y = row as f64;
        // Only the part of the segment near this row counts. A long slanting segment is near few nodes of each row.
        let (from, to) = if along.y == 0.0 {
            (lo.x, hi.x)
        } else {
            let at = |y: f64| a.x + along.x * ((y - a.y) / along.y).clamp(0.0, 1.0);
            let (p, q) = (at(y - clearance), at(y + clearance));
            (p.min(q) - clearance, p.max(q) + clearance)
        };
        for col in range(from, to, cols) {
            let p = DVec2::new(col as f64, y);
            let t = if length > 0.0 { ((p - a).dot(along) / length).clamp(0.0, 1.0) } else { 0.0 };
            if p.distance_squared(a + t * along) < clearance * clearance {
                each(row * cols + col);
            }
        }
    }
}

/// The nodes that the surface needs, ascending. They are the corners of squares. A square is halved until straight
/// lines between its corners are within `tolerance` (metres) of all nodes in it.
fn thinned(regions: &[u32], working: &WorkingGrid, nodes: &Strided, tolerance: f64) -> Vec<usize> {
    let squares = Squares { regions, heights: &working.heights, nodes, tolerance };
    let (across, down) = (nodes.cols().div_ceil(LARGEST), nodes.rows().div_ceil(LARGEST));
    let found: Vec<Vec<usize>> = parallel::map(across * down, |s| {
        let mut corners = Vec::new();
        squares.divide([s % across * LARGEST, s / across * LARGEST], LARGEST, &mut corners);
        corners
    });
    let mut kept = vec![false; regions.len()];
    found.into_iter().flatten().for_each(|k| kept[k] = true);
    (0..kept.len()).filter(|&k| kept[k]).collect()
}

/// The squares of nodes that [`thinned`] divides.
struct Squares<'a> {
    regions: &'a [u32],
    heights: &'a [f32],
    nodes: &'a Strided,
    tolerance: f64,
}

impl Squares<'_> {
    fn divide(&self, [col, row]: [usize; 2], side: usize, corners: &mut Vec<usize>) {
        let (cols, rows) = (self.nodes.cols(), self.nodes.rows());
        if col >= cols || row >= rows {
            return;
        }
        if side > 1 && !self.is_straight([col, row], side) {
            let half = side / 2;
            for [i, j] in [[0, 0], [half, 0], [0, half], [half, half]] {
                self.divide([col + i, row + j], half, corners);
            }
            return;
        }
        let ends = [[col, row], [col + side, row], [col, row + side], [col + side, row + side]];
        let on_grid = ends.into_iter().filter(|&[i, j]| i < cols && j < rows).map(|[i, j]| j * cols + i);
        corners.extend(on_grid.filter(|&k| self.regions[k] != NONE));
    }

    /// Whether all nodes of a square have heights near the triangles between its corners, whichever diagonal cuts the
    /// square.
    ///
    /// Contours may run through the square. Their vertices lie on the surface too, so triangles between them and the
    /// corners are as near to it.
    fn is_straight(&self, [col, row]: [usize; 2], side: usize) -> bool {
        let cols = self.nodes.cols();
        if col + side >= cols || row + side >= self.nodes.rows() {
            return false;
        }
        let height = |i: usize, j: usize| f64::from(self.heights[self.nodes.node((row + j) * cols + col + i)]);
        let [nw, ne, sw, se] = [height(0, 0), height(side, 0), height(0, side), height(side, side)];
        let twist = (nw - ne - sw + se).abs() / 4.0;
        let near = |i: usize, j: usize| {
            let (u, v) = (i as f64 / side as f64, j as f64 / side as f64);
            let between = (1.0 - v) * (nw + u * (ne - nw)) + v * (sw + u * (se - sw));
            (height(i, j) - between).abs() + twist <= self.tolerance
        };
        (0..=side).all(|j| (0..=side).all(|i| near(i, j)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIDE: usize = 33;
    const CLEARANCE: f64 = 0.6;

    fn kept(height: impl Fn(usize, usize) -> f32, region: impl Fn(usize, usize) -> u32) -> Vec<usize> {
        let grid = Grid { corner: DVec2::new(0.0, SIDE as f64), cell: DVec2::splat(1.0), cols: SIDE, rows: SIDE };
        let heights = (0..SIDE * SIDE).map(|n| height(n % SIDE, n / SIDE)).collect();
        let regions: Vec<u32> = (0..SIDE * SIDE).map(|n| region(n % SIDE, n / SIDE)).collect();
        let nodes = Strided { lattice: Lattice::of_grid(&grid), stride: 1 };
        thinned(&regions, &WorkingGrid { grid, heights }, &nodes, 0.01)
    }

    #[test]
    fn a_plane_needs_few_nodes_and_a_bump_all_of_its_own() {
        let plane = |i: usize, j: usize| (i + 2 * j) as f32;
        // Squares that reach beyond the last row and column are always divided.
        let inner = |kept: Vec<usize>| -> Vec<usize> {
            kept.into_iter().filter(|k| k % SIDE + 1 < SIDE && k / SIDE + 1 < SIDE).collect()
        };
        assert_eq!(inner(kept(plane, |_, _| 0)), [0, 16, 16 * SIDE, 16 * SIDE + 16]);
        let bump = inner(kept(|i, j| plane(i, j) + if (i, j) == (21, 9) { 1.0 } else { 0.0 }, |_, _| 0));
        assert!(bump.contains(&(9 * SIDE + 21)), "{bump:?}");
        assert!(bump.len() < 40, "{bump:?}");
    }

    #[test]
    fn nodes_stand_close_along_a_crease_and_not_where_a_plane_goes_on_beyond_a_contour() {
        let halves = |i: usize, _: usize| match i {
            0..13 => 0,
            13 => NONE,
            _ => 1,
        };
        let plane = kept(|i, j| (i + 2 * j) as f32, halves);
        assert!(plane.iter().all(|k| k % SIDE != 13), "{plane:?}");
        let is_coarse = |k: &usize| (k % SIDE).is_multiple_of(LARGEST) || k % SIDE + 1 == SIDE || k / SIDE + 1 == SIDE;
        assert!(plane.iter().all(is_coarse), "{plane:?}");
        let crease = kept(|i, _| (i as f32 - 13.0).abs(), halves);
        assert!((0..SIDE).all(|j| crease.contains(&(j * SIDE + 12)) && crease.contains(&(j * SIDE + 14))));
    }

    #[test]
    fn nodes_near_a_segment_are_those_within_the_clearance() {
        let size = [9, 9];
        for (a, b) in
            [((0.3, 0.2), (8.4, 5.1)), ((2.0, 7.5), (2.0, 1.0)), ((-4.0, 3.4), (20.0, 3.4)), ((5.0, 5.5), (5.0, 5.5))]
        {
            let (a, b) = (DVec2::from(a), DVec2::from(b));
            let mut found = Vec::new();
            for_each_near(a, b, CLEARANCE, size, |k| found.push(k));
            let distance = |k: usize| {
                let p = DVec2::new((k % 9) as f64, (k / 9) as f64);
                let t = (p - a).dot(b - a) / (b - a).length_squared().max(f64::MIN_POSITIVE);
                p.distance(a + (b - a) * t.clamp(0.0, 1.0))
            };
            let wanted: Vec<usize> = (0..81).filter(|&k| distance(k) < CLEARANCE).collect();
            assert!(!wanted.is_empty());
            assert_eq!(found, wanted, "{a} {b}");
        }
    }
}
