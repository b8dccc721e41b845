//! Distances from the nodes of a grid to the contours on both sides.
//!
//! The nearest known place is passed from node to node inside a sub-domain. So ground beyond a contour does not count.
//! The places start where contours cross the edges between nodes.

use glam::DVec2;

use crate::base::Grid;
use crate::spline::{CrossingKind, Lattice};
use crate::subdivision::Subdivision;
use crate::subdomains::Band;
use crate::tin::NONE;

/// Largest number of rounds, each with four sweeps. Sub-domains that wind need more than one. It limits the
/// time.
const ROUNDS: usize = 4;
/// Marks nodes without a known place.
const NOWHERE: [f32; 2] = [f32::INFINITY; 2];

/// The nearest known places below and above each node.
pub struct Sides {
    /// Where the nodes are.
    pub lattice: Lattice,
    /// Sub-domain of each node, [`NONE`] outside the frame.
    pub regions: Vec<u32>,
    /// Column and row of the nearest place on a lower and on a higher contour, or at a spot height. Infinite if there
    /// is none.
    nearest: [Vec<[f32; 2]>; 2],
    /// Number of crossings of contours with the eastward and the southward edge of each node.
    pub crossings: Vec<f32>,
    /// Share of these crossings that are at vertices of the contours.
    pub share_at_vertices: f64,
}

/// Finds the nearest known places for nodes that lie in `triangles`.
pub fn sides(subdivision: &Subdivision, grid: &Grid, triangles: &[u32]) -> Sides {
    let lattice = Lattice::of_grid(grid);
    let region = |&t: &u32| if t == NONE { NONE } else { subdivision.regions.of_triangle[t as usize] };
    let regions: Vec<u32> = triangles.iter().map(region).collect();
    let nearest = [vec![NOWHERE; regions.len()], vec![NOWHERE; regions.len()]];
    let crossings = vec![0.0; regions.len()];
    let mut sides = Sides { lattice, regions, nearest, crossings, share_at_vertices: 0.0 };
    let bands: Vec<Band> = subdivision.regions.regions.iter().map(|r| r.band).collect();
    sides.start(subdivision, &bands);
    let Sides { lattice, regions, nearest: [below, above], .. } = &mut sides;
    rayon::join(|| spread(lattice, regions, below), || spread(lattice, regions, above));
    sides
}

/// Passes the nearest places on until no node changes.
fn spread(lattice: &Lattice, regions: &[u32], nearest: &mut [[f32; 2]]) {
    for _ in 0..ROUNDS {
        if !sweep(lattice, regions, nearest) {
            break;
        }
    }
}

/// Passes places southwards and northwards, and in each row eastwards and westwards. Returns whether a node changed.
fn sweep(lattice: &Lattice, regions: &[u32], nearest: &mut [[f32; 2]]) -> bool {
    let (cols, rows) = (lattice.cols, lattice.rows);
    let mut taken = false;
    let mut pass = |from: usize, to: usize| {
        let place = nearest[from];
        let known = place[0].is_finite() && place != nearest[to];
        taken |= known && regions[from] == regions[to] && regions[to] != NONE && nearer(lattice, nearest, to, place);
    };
    for k in 0..2 * rows {
        let southwards = k < rows;
        let row = if southwards { k } else { 2 * rows - 1 - k };
        let before = if southwards { row.checked_sub(1) } else { Some(row + 1).filter(|&r| r < rows) };
        for col in 0..cols {
            let node = row * cols + col;
            if let Some(before) = before {
                for other in col.saturating_sub(1)..(col + 2).min(cols) {
                    pass(before * cols + other, node);
                }
            }
            if col > 0 {
                pass(node - 1, node);
            }
        }
        for col in (1..cols).rev() {
            pass(row * cols + col, row * cols + col - 1);
        }
    }
    taken
}

/// Gives a node a place if it is nearer than the node's present one. Returns whether it was.
fn nearer(lattice: &Lattice, nearest: &mut [[f32; 2]], node: usize, place: [f32; 2]) -> bool {
    let at = DVec2::new((node % lattice.cols) as f64, (node / lattice.cols) as f64);
    let squared = |[col, row]: [f32; 2]| ((DVec2::new(col.into(), row.into()) - at) * lattice.step).length_squared();
    let is = squared(place) < squared(nearest[node]);
    if is {
        nearest[node] = place;
    }
    is
}

impl Sides {
    /// Distances of a place from the known ground below and above it inside sub-domain `region`, map units. Infinite
    /// where there is none. `None` where no node around lies in the sub-domain.
    pub fn at(&self, p: DVec2, region: u32) -> Option<[f64; 2]> {
        let place = self.lattice.place(p);
        let (col, row) = (place.x.floor(), place.y.floor());
        let mut found = None;
        for (i, j) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
            let (c, r) = (col + i, row + j);
            if c < 0.0 || r < 0.0 || c >= self.lattice.cols as f64 || r >= self.lattice.rows as f64 {
                continue;
            }
            let node = r as usize * self.lattice.cols + c as usize;
            if self.regions[node] == region {
                let best = found.get_or_insert([f64::INFINITY; 2]);
                for (side, best) in best.iter_mut().enumerate() {
                    *best = best.min(self.distance(self.nearest[side][node], place));
                }
            }
        }
        found
    }

    /// These distances for a node.
    pub fn of_node(&self, node: usize) -> [f64; 2] {
        let place = DVec2::new((node % self.lattice.cols) as f64, (node / self.lattice.cols) as f64);
        [0, 1].map(|side| self.distance(self.nearest[side][node], place))
    }

    fn distance(&self, [col, row]: [f32; 2], place: DVec2) -> f64 {
        let by = (DVec2::new(col.into(), row.into()) - place) * self.lattice.step;
        if by.is_finite() { by.length() } else { f64::INFINITY }
    }

    /// Starts at both ends of every edge that a contour crosses, and at the nodes around spot heights.
    fn start(&mut self, subdivision: &Subdivision, bands: &[Band]) {
        let tin = &subdivision.tin;
        let lattice = self.lattice;
        let (mut all, mut at_vertices) = (0usize, 0usize);
        for t in (0..tin.len() as u32).filter(|&t| tin.is_inside(t)) {
            for i in 0..3 {
                let Some(level) = tin.border_level(t, i) else { continue };
                if tin.inner_neighbour(t, i).is_some_and(|n| n < t) {
                    continue;
                }
                let line = tin.edge(t, i).map(|v| tin.point(v).truncate());
                let (mut east, mut south) = (Vec::new(), Vec::new());
                lattice.cross(&line, |c| east.push((c, [1.0, 0.0], 1)), |c| south.push((c, [0.0, 1.0], lattice.cols)));
                for (crossing, [x, y], step) in east.into_iter().chain(south) {
                    all += 1;
                    at_vertices += usize::from(crossing.kind == CrossingKind::Vertex);
                    let node = crossing.node as usize;
                    self.crossings[node] += 1.0;
                    let [col, row] = [node % lattice.cols, node / lattice.cols].map(|k| k as f64);
                    let place = [(col + x * crossing.along) as f32, (row + y * crossing.along) as f32];
                    self.mark(node, place, level, bands);
                    self.mark(node + step, place, level, bands);
                }
            }
        }
        self.share_at_vertices = at_vertices as f64 / all.max(1) as f64;
        for spot in subdivision.used_spots() {
            let place = lattice.place(spot.truncate());
            let (col, row) = (place.x.floor(), place.y.floor());
            if col < 0.0 || row < 0.0 || col as usize + 1 >= lattice.cols || row as usize + 1 >= lattice.rows {
                continue;
            }
            let node = row as usize * lattice.cols + col as usize;
            for node in [node, node + 1, node + lattice.cols, node + lattice.cols + 1] {
                for side in 0..2 {
                    nearer(&lattice, &mut self.nearest[side], node, place.as_vec2().to_array());
                }
            }
        }
    }

    /// Gives a node a place on a contour of `level`, as its nearest one below, above, or both.
    fn mark(&mut self, node: usize, place: [f32; 2], level: f64, bands: &[Band]) {
        let Some(band) = bands.get(self.regions[node] as usize) else { return };
        if level < band.hi {
            nearer(&self.lattice, &mut self.nearest[0], node, place);
        }
        if level > band.lo {
            nearer(&self.lattice, &mut self.nearest[1], node, place);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_passed_on_inside_a_sub_domain_only_and_round_corners() {
        // A wall through the middle of a square, open at its southern end.
        let size = 9;
        let lattice = Lattice { first: DVec2::ZERO, step: DVec2::new(2.0, 1.0), cols: size, rows: size };
        let is_wall = |n: usize| n % size == 4 && n / size < 8;
        let regions: Vec<u32> = (0..size * size).map(|n| if is_wall(n) { NONE } else { 7 }).collect();
        let mut nearest = vec![NOWHERE; size * size];
        nearest[0] = [0.0, 0.0];
        nearest[8 * size] = [0.25, 8.0];
        spread(&lattice, &regions, &mut nearest);
        for (n, found) in nearest.iter().enumerate() {
            let (col, row) = (n % size, n / size);
            let at = DVec2::new(col as f64, row as f64);
            let to = |place: [f64; 2]| ((DVec2::from(place) - at) * lattice.step).length();
            let found = found.map(f64::from);
            if is_wall(n) {
                assert!(found[0].is_infinite());
            } else if col < 4 {
                assert!((to(found) - to([0.0, 0.0]).min(to([0.25, 8.0]))).abs() < 1e-9, "{col} {row}: {found:?}");
            } else {
                assert!(to(found) < 40.0, "{col} {row}: {found:?}");
            }
        }
    }
}
