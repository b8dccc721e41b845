//! Few triangles within a tolerance of the heights of cells: greedy insertion (Garland and Heckbert 1995, *Fast polygonal
//! approximation of terrains and height fields*, CMU-CS-95-181).
//!
//! It begins with the outline of the ground, triangulated. The cell that is furthest from its triangle becomes a vertex, and so on,
//! until no cell is further than the tolerance. Cells do not look for their triangle: each triangle that is new looks through its
//! cells, row by row. In the end all triangles do so once more, and go on if one is too far from a cell.
//!
//! All places are in cells: x is the column, y the negative row. So the centres of cells have whole numbers.

use std::collections::{BinaryHeap, HashMap, HashSet};

use glam::{DVec2, DVec3};
use robust::{Coord, incircle, orient2d};

use super::check_heights;
use super::outline::{Outline, height_at};
use crate::base::bits::bits;
use crate::base::error::{Error, Result};
use crate::base::{Key, parallel};
use crate::raster::Dem;
use crate::tin::{NONE, Tin, TinInput, VertexKind, triangulate};

/// A place that is nearer to a cell's centre or to an edge than this lies on it, in cells: a tolerance of rounding.
const ON: f64 = 1e-6;
/// Rows of a triangle reach this far beyond its edges, in cells. So each centre on an edge is seen from both sides.
const MARGIN: f64 = 1e-9;

/// The triangles of the ground inside an outline, none of them further than `tolerance` (metres) from the height of a
/// cell whose centre it covers. The outline keeps its corners; between them, its heights are within half of the tolerance.
///
/// # Errors
/// [`Error::OutOfRange`] for a tolerance that is not above 0. [`Error::Data`] if the triangles do not come within the tolerance. As
/// [`triangulate`].
pub(super) fn light(outline: &Outline, dem: &Dem, tolerance: f64) -> Result<Tin> {
    if !(tolerance.is_finite() && tolerance > 0.0) {
        return Err(Error::out_of_range("tolerance", tolerance, "more than 0"));
    }
    let mut mesh = Light::of_outline(outline, dem, tolerance)?;
    // The second pass only finds something if a cell changed its triangle unseen.
    while mesh.look(0..mesh.triangles.len() as u32) {
        mesh.refine()?;
    }
    Ok(mesh.tin(outline.origin))
}

/// The triangles up to now.
struct Light<'a> {
    dem: &'a Dem,
    tolerance: f64,
    /// Places of the vertices, in cells.
    points: Vec<DVec2>,
    /// Vertices relative to the origin of the triangulation, map units and metres.
    vertices: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    /// Beyond the edge from corner i to corner i+1.
    neighbours: Vec<[u32; 3]>,
    /// The largest error of each triangle, and its cell.
    worst: Vec<(f64, u32)>,
    /// Triangles by their error; those that have changed since then are passed over.
    queue: BinaryHeap<(Key, u32, u32)>,
    origin: DVec2,
}

impl<'a> Light<'a> {
    /// An outline, triangulated.
    fn of_outline(border: &Outline, dem: &'a Dem, tolerance: f64) -> Result<Self> {
        let grid = &dem.grid;
        let place = |v: DVec3| grid.place(v.truncate() + border.origin) * DVec2::new(1.0, -1.0);
        check_heights(&border.vertices, border.origin)?;
        let mut input = TinInput::new([DVec2::ZERO, DVec2::new(grid.cols as f64, grid.rows as f64)], -1.0);
        let (mut outline, mut edges) = (Vec::new(), Vec::new());
        for ring in rings(&border.vertices, &border.edges, &place, tolerance / 2.0) {
            let first = outline.len();
            let mut at: Vec<DVec2> = ring.iter().map(|v| place(*v)).collect();
            for (at, v) in at.iter_mut().zip(&ring) {
                // A vertex at a cell's centre has the height of the cell.
                let near = at.round();
                let of_cell = height_at(dem, near).filter(|_| (*at - near).abs().max_element() < ON);
                *at = if of_cell.is_some() { near } else { *at };
                outline.push(v.truncate().extend(of_cell.unwrap_or(v.z)));
                input.push_local(*at, v.z, VertexKind::Frame);
            }
            for k in 0..ring.len() {
                let after = (k + 1) % ring.len();
                input.push_edge((first + k) as u32, (first + after) as u32);
                edges.push([at[k], at[after]]);
            }
        }
        let base = triangulate(&input)?;
        // The ground lies on the left of the outline.
        let inside = inside(&base, &edges);
        let mut number = vec![NONE; base.len()];
        let kept = (0..base.len()).filter(|&t| inside[t]);
        kept.enumerate().for_each(|(k, t)| number[t] = k as u32);
        let numbered = |n: &u32| if *n == NONE { NONE } else { number[*n as usize] };
        let of = |t: &usize| inside[*t];
        let triangles: Vec<[u32; 3]> = (0..base.len()).filter(of).map(|t| base.triangles[t]).collect();
        let neighbours = (0..base.len()).filter(of).map(|t| base.neighbours[t].each_ref().map(numbered)).collect();
        Ok(Self {
            dem,
            tolerance,
            points: base.positions.clone(),
            vertices: base.source.iter().map(|&v| outline[v as usize]).collect(),
            worst: vec![(0.0, 0); triangles.len()],
            triangles,
            neighbours,
            queue: BinaryHeap::new(),
            origin: border.origin,
        })
    }

    /// Finds the largest error of some triangles. Whether one is above the tolerance.
    fn look(&mut self, triangles: std::ops::Range<u32>) -> bool {
        let (this, first) = (&*self, triangles.start);
        let found = parallel::values(triangles.len(), |k| this.worst_of(first + k as u32));
        let mut is_above = false;
        for (t, worst) in triangles.zip(found) {
            is_above |= self.note(t, worst);
        }
        is_above
    }

    /// Keeps the largest error of a triangle. Whether it is above the tolerance.
    fn note(&mut self, t: u32, worst: (f64, u32)) -> bool {
        self.worst[t as usize] = worst;
        let is_above = worst.0 > self.tolerance;
        if is_above {
            self.queue.push((Key(worst.0), t, worst.1));
        }
        is_above
    }

    /// The largest error of a triangle, and its cell.
    fn worst_of(&self, t: u32) -> (f64, u32) {
        let corners = self.triangles[t as usize];
        let [a, b, c] = corners.map(|v| self.points[v as usize]);
        let heights = corners.map(|v| self.vertices[v as usize].z);
        let area = (b - a).perp_dot(c - a);
        let (rise_b, rise_c) = (heights[1] - heights[0], heights[2] - heights[0]);
        let slope =
            DVec2::new(rise_b * (c.y - a.y) - rise_c * (b.y - a.y), rise_c * (b.x - a.x) - rise_b * (c.x - a.x)) / area;
        let (lowest, highest) =
            (heights.into_iter().fold(f64::MAX, f64::min), heights.into_iter().fold(f64::MIN, f64::max));
        let (lo, hi) = (a.min(b).min(c) - MARGIN, a.max(b).max(c) + MARGIN);
        let (cols, rows) = (self.dem.grid.cols, self.dem.grid.rows);
        let (first, last) = ((-hi.y).ceil().max(0.0), (-lo.y).floor().min(rows as f64 - 1.0));
        let mut worst = (0.0, 0);
        let mut row = first;
        while row <= last {
            let y = -row;
            let (mut left, mut right) = (lo.x, hi.x);
            for (u, v) in [(a, b), (b, c), (c, a)] {
                let along = v - u;
                let x = u.x + along.x * (y - u.y) / along.y;
                if along.y > 0.0 {
                    right = right.min(x + MARGIN);
                } else if along.y < 0.0 {
                    left = left.max(x - MARGIN);
                }
            }
            let (left, right) = (left.ceil().max(0.0), right.floor().min(cols as f64 - 1.0));
            if left <= right {
                let start = row as usize * cols + left as usize;
                let cells = &self.dem.values[start..=start + (right - left) as usize];
                let from = heights[0] + slope.x * (left - a.x) + slope.y * (y - a.y);
                for (k, height) in cells.iter().enumerate() {
                    // In slivers, the slope is hardly determined.
                    let own = (from + slope.x * k as f64).clamp(lowest, highest);
                    let error = (own - f64::from(*height)).abs();
                    if error > worst.0 {
                        worst = (error, (start + k) as u32);
                    }
                }
            }
            row += 1.0;
        }
        worst
    }

    /// Makes vertices of cells until no triangle is known to be above the tolerance.
    fn refine(&mut self) -> Result<()> {
        let mut changed = Vec::new();
        while let Some((Key(error), t, cell)) = self.queue.pop() {
            if self.worst[t as usize] != (error, cell) {
                continue;
            }
            changed.clear();
            self.insert(t, cell, &mut changed)?;
            changed.sort_unstable();
            changed.dedup();
            for &t in &changed {
                let worst = self.worst_of(t);
                self.note(t, worst);
            }
        }
        Ok(())
    }

    /// Makes a vertex of a cell in triangle `t`, and turns edges until the triangulation is Delaunay again.
    fn insert(&mut self, t: u32, cell: u32, changed: &mut Vec<u32>) -> Result<()> {
        let grid = &self.dem.grid;
        let (col, row) = (cell as usize % grid.cols, cell as usize / grid.cols);
        let at = DVec2::new(col as f64, -(row as f64));
        let height = f64::from(self.dem.values[cell as usize]);
        let p = self.points.len() as u32;
        let corners = self.triangles[t as usize];
        // How far the place is from each edge.
        let off = [0, 1, 2].map(|i| {
            let [u, v] = [corners[i], corners[(i + 1) % 3]].map(|v| self.points[v as usize]);
            (v - u).perp_dot(at - u) / u.distance(v)
        });
        let nearest = (0..3).fold(0, |best, i| if off[i] < off[best] { i } else { best });
        let is_vertex = corners.iter().any(|&v| (self.points[v as usize] - at).abs().max_element() < ON);
        if is_vertex || off[nearest] < -ON {
            let place = grid.center(col, row);
            return Err(Error::Data(format!(
                "the triangles do not come within {} m of the surface at {:.3} {:.3}: choose another cell",
                self.tolerance, place.x, place.y
            )));
        }
        self.points.push(at);
        self.vertices.push((grid.center(col, row) - self.origin).extend(height));
        let mut doubtful = Vec::new();
        if off[nearest] > ON {
            self.split_triangle(t, p, &mut doubtful);
        } else {
            self.split_edge(t, nearest, p, &mut doubtful);
        }
        changed.extend(&doubtful);
        while let Some(t) = doubtful.pop() {
            if let Some(n) = self.turned(t, p) {
                changed.push(n);
                doubtful.extend([t, n]);
            }
        }
        Ok(())
    }

    /// Divides a triangle at an inner point.
    fn split_triangle(&mut self, t: u32, p: u32, new: &mut Vec<u32>) {
        let ([a, b, c], [ab, bc, ca]) = (self.triangles[t as usize], self.neighbours[t as usize]);
        let (second, third) = (self.triangles.len() as u32, self.triangles.len() as u32 + 1);
        self.set(t, [p, a, b], [third, ab, second]);
        self.add([p, b, c], [t, bc, third]);
        self.add([p, c, a], [second, ca, t]);
        self.replace(bc, t, second);
        self.replace(ca, t, third);
        new.extend([t, second, third]);
    }

    /// Divides edge `i` of triangle `t`, and the triangle beyond it if there is one.
    fn split_edge(&mut self, t: u32, i: usize, p: u32, new: &mut Vec<u32>) {
        let [a, b, c] = [0, 1, 2].map(|k| self.triangles[t as usize][(i + k) % 3]);
        let [beyond, bc, ca] = [0, 1, 2].map(|k| self.neighbours[t as usize][(i + k) % 3]);
        let second = self.triangles.len() as u32;
        let (third, fourth) = if beyond == NONE { (NONE, NONE) } else { (beyond, second + 1) };
        // Triangle t keeps the half at a. Its other half, and the halves beyond, share edges with it.
        self.set(t, [p, c, a], [second, ca, fourth]);
        self.add([p, b, c], [third, bc, t]);
        self.replace(bc, t, second);
        new.extend([t, second]);
        if beyond != NONE {
            let j = self.edge_to(beyond, t);
            let d = self.triangles[beyond as usize][(j + 2) % 3];
            let [ad, db] = [1, 2].map(|k| self.neighbours[beyond as usize][(j + k) % 3]);
            self.set(beyond, [p, d, b], [fourth, db, second]);
            self.add([p, a, d], [t, ad, beyond]);
            self.replace(ad, beyond, fourth);
            new.extend([beyond, fourth]);
        }
    }

    /// Turns the edge of triangle `t` that does not end at its first corner `p`, if the triangle beyond asks for it. The triangle
    /// beyond then begins at `p`, too.
    fn turned(&mut self, t: u32, p: u32) -> Option<u32> {
        let ([_, a, b], [pa, n, bp]) = (self.triangles[t as usize], self.neighbours[t as usize]);
        if n == NONE {
            return None;
        }
        let j = self.edge_to(n, t);
        let d = self.triangles[n as usize][(j + 2) % 3];
        let [p_at, a_at, b_at, d_at] = [p, a, b, d].map(|v| {
            let DVec2 { x, y } = self.points[v as usize];
            Coord { x, y }
        });
        let is_convex = || orient2d(p_at, a_at, d_at) > 0.0 && orient2d(p_at, d_at, b_at) > 0.0;
        if incircle(p_at, a_at, b_at, d_at) <= 0.0 || !is_convex() {
            return None;
        }
        let [ad, db] = [1, 2].map(|k| self.neighbours[n as usize][(j + k) % 3]);
        self.set(t, [p, a, d], [pa, ad, n]);
        self.set(n, [p, d, b], [t, db, bp]);
        self.replace(ad, n, t);
        self.replace(bp, t, n);
        Some(n)
    }

    /// The edge of triangle `t` to a neighbour.
    fn edge_to(&self, t: u32, neighbour: u32) -> usize {
        let edges = &self.neighbours[t as usize];
        edges.iter().position(|&n| n == neighbour).expect("neighbours know each other")
    }

    fn set(&mut self, t: u32, corners: [u32; 3], neighbours: [u32; 3]) {
        self.triangles[t as usize] = corners;
        self.neighbours[t as usize] = neighbours;
    }

    fn add(&mut self, corners: [u32; 3], neighbours: [u32; 3]) {
        self.triangles.push(corners);
        self.neighbours.push(neighbours);
        self.worst.push((0.0, 0));
    }

    /// Tells triangle `t` that its neighbour `old` is `new` now.
    fn replace(&mut self, t: u32, old: u32, new: u32) {
        if t != NONE {
            let edge = self.edge_to(t, old);
            self.neighbours[t as usize][edge] = new;
        }
    }

    /// The triangles as a triangulation.
    fn tin(self, origin: DVec2) -> Tin {
        let count = self.triangles.len();
        Tin {
            origin,
            positions: self.vertices.iter().map(|v| v.truncate()).collect(),
            heights: self.vertices.iter().map(|v| v.z).collect(),
            triangles: self.triangles,
            neighbours: self.neighbours,
            edges: vec![0; count],
            inside: vec![true; count],
            ..Tin::default()
        }
    }
}

/// Which triangles lie on the left of the edges between these places.
fn inside(base: &Tin, edges: &[[DVec2; 2]]) -> Vec<bool> {
    let vertices: HashMap<[u64; 2], u32> = (0..).zip(&base.positions).map(|(v, p)| (bits(*p), v)).collect();
    let vertex = |p: DVec2| vertices.get(&bits(p)).copied().unwrap_or(NONE);
    let left: HashSet<[u32; 2]> = edges.iter().map(|ends| ends.map(vertex)).collect();
    let mut inside = vec![false; base.len()];
    let begins = |t: &u32| (0..3).any(|i| left.contains(&base.edge(*t, i)));
    let mut open: Vec<u32> = (0..base.len() as u32).filter(begins).collect();
    while let Some(t) = open.pop() {
        if !std::mem::replace(&mut inside[t as usize], true) {
            let beyond = (0..3).filter(|&i| !base.is_constraint(t, i)).map(|i| base.neighbours[t as usize][i]);
            open.extend(beyond.filter(|&n| n != NONE));
        }
    }
    inside
}

/// The rings of the border, without the vertices between two corners that the heights do not need.
fn rings(vertices: &[DVec3], border: &[[u32; 2]], place: &impl Fn(DVec3) -> DVec2, tolerance: f64) -> Vec<Vec<DVec3>> {
    let mut next = vec![NONE; vertices.len()];
    border.iter().for_each(|&[u, v]| next[u as usize] = v);
    let mut rings = Vec::new();
    for &[start, _] in border {
        let mut ring = Vec::new();
        let mut v = start;
        while v != NONE {
            ring.push(vertices[v as usize]);
            v = std::mem::replace(&mut next[v as usize], NONE);
        }
        if ring.len() > 3 {
            // The ring ends where it began.
            let at: Vec<DVec2> = ring.iter().map(|v| place(*v)).collect();
            let mut kept = vec![false; ring.len()];
            let far =
                (0..at.len()).fold(0, |far, k| if at[k].distance(at[0]) > at[far].distance(at[0]) { k } else { far });
            [0, far].into_iter().for_each(|k| kept[k] = true);
            for part in [0..far, far..ring.len() - 1] {
                keep(&ring, &at, part.start, part.end, tolerance, &mut kept);
            }
            kept[ring.len() - 1] = false;
            let mut flags = kept.into_iter();
            ring.retain(|_| flags.next().unwrap_or(false));
            rings.push(ring);
        }
    }
    rings
}

/// Marks what Douglas and Peucker (1973) keep between two vertices: corners on the map, and heights.
fn keep(ring: &[DVec3], at: &[DVec2], first: usize, last: usize, tolerance: f64, kept: &mut [bool]) {
    let mut open = vec![(first, last)];
    while let Some((first, last)) = open.pop() {
        let (from, to) = (at[first], at[last]);
        let squared = from.distance_squared(to);
        let needed = |k: usize| {
            let share = if squared > 0.0 { ((at[k] - from).dot(to - from) / squared).clamp(0.0, 1.0) } else { 0.0 };
            let aside = at[k].distance(from.lerp(to, share)) / ON;
            let height = ring[first].z + share * (ring[last].z - ring[first].z);
            aside.max((ring[k].z - height).abs() / tolerance)
        };
        let furthest = (first + 1..last).map(|k| (Key(needed(k)), k)).max();
        if let Some((Key(needed), k)) = furthest
            && needed > 1.0
        {
            kept[k] = true;
            open.extend([(first, k), (k, last)]);
        }
    }
}

#[cfg(test)]
mod tests;
