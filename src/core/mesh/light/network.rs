//! Triangles that a vertex can be added to: [`Network`].

use glam::{DVec2, DVec3};
use robust::{Coord, incircle, orient2d};

use super::ON;
use crate::tin::NONE;

/// Whether a place lies in a circle is exact in double precision for whole numbers whose squared distances are below this: products
/// of two of these, and the sum of three such products, are below 2⁵³.
const EXACT: f64 = 33_554_432.0;

/// The error of a triangle that has changed, and is not known yet.
const UNKNOWN: u32 = u32::MAX;

/// The largest error of a triangle that is above the tolerance, and the cell where it is. The error is 0 if there is none.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Worst {
    pub error: f32,
    pub cell: u32,
}

/// A Delaunay triangulation with edges that stay.
///
/// A side is three times the number of its triangle plus its number in the triangle: side i runs from corner i to corner i+1.
#[derive(Debug, Default)]
pub(super) struct Network {
    /// The vertices: places in cells, and heights.
    pub places: Vec<DVec3>,
    /// Corners of the triangles, counter-clockwise.
    pub corners: Vec<[u32; 3]>,
    /// The same edges as sides of the triangles beyond, [`NONE`] at the border.
    pub beyond: Vec<[u32; 3]>,
    /// Bit i: side i stays an edge.
    kept: Vec<u8>,
    /// What is known of the errors of the triangles.
    worst: Vec<Worst>,
    /// The triangles whose errors are unknown.
    changed: Vec<u32>,
    /// Sides that may have to be turned. It is empty between insertions, and keeps its memory.
    doubtful: Vec<u32>,
}

impl Network {
    /// Triangles with their neighbours. `is_kept` tells which sides stay edges. No error is known.
    pub fn new(
        places: Vec<DVec3>,
        corners: Vec<[u32; 3]>,
        neighbours: &[[u32; 3]],
        is_kept: impl Fn(usize, usize) -> bool,
    ) -> Self {
        let side_towards = |n: u32, t: usize| neighbours[n as usize].iter().position(|&m| m as usize == t);
        let side = |n: u32, t: usize| {
            let beyond = (n != NONE).then(|| side_towards(n, t)).flatten();
            beyond.map_or(NONE, |side| 3 * n + side as u32)
        };
        let count = corners.len();
        let beyond = neighbours.iter().enumerate().map(|(t, sides)| sides.map(|n| side(n, t))).collect();
        let bits = |t: usize| (0..3).filter(|&i| is_kept(t, i)).fold(0, |bits, i| bits | 1 << i);
        let kept = (0..count).map(bits).collect();
        let mut network = Self { places, corners, beyond, kept, ..Self::default() };
        network.worst = vec![Worst::default(); count];
        network.forget();
        network
    }

    /// Forgets all errors.
    pub fn forget(&mut self) {
        self.changed = (0..self.corners.len() as u32).collect();
        self.worst.iter_mut().for_each(|worst| worst.cell = UNKNOWN);
    }

    /// The triangles whose errors are unknown; they are known from now on.
    pub fn take_changed(&mut self) -> Vec<u32> {
        std::mem::take(&mut self.changed)
    }

    /// Keeps the error of a triangle.
    pub fn note(&mut self, t: u32, worst: Worst) {
        self.worst[t as usize] = worst;
    }

    /// The error of a triangle, if it is known.
    pub fn known(&self, t: u32) -> Option<Worst> {
        Some(self.worst[t as usize]).filter(|worst| worst.cell != UNKNOWN)
    }

    /// Makes a vertex at a place in triangle `t` or at its border, and turns edges until the triangulation is Delaunay again. Whether
    /// this was possible: a place can be that of a corner, or outside.
    pub fn insert(&mut self, t: u32, place: DVec3) -> bool {
        let (corners, at) = (self.corners[t as usize], place.truncate());
        // How far the place is from each side.
        let off = [0, 1, 2].map(|i| {
            let [u, v] = [corners[i], corners[(i + 1) % 3]].map(|v| self.at(v));
            (v - u).perp_dot(at - u) / u.distance(v)
        });
        let nearest = (0..3).fold(0, |best, i| if off[i] < off[best] { i } else { best });
        let is_vertex = corners.iter().any(|&v| (self.at(v) - at).abs().max_element() < ON);
        if is_vertex || off[nearest] < -ON {
            return false;
        }
        let p = self.places.len() as u32;
        self.places.push(place);
        match off[nearest] > ON {
            true => self.split_triangle(t, p),
            false => self.split_side(t, nearest, p),
        }
        while let Some(side) = self.doubtful.pop() {
            self.turn(side, p);
        }
        true
    }

    /// Divides a triangle at an inner point. The parts begin at the point.
    fn split_triangle(&mut self, t: u32, p: u32) {
        let ([a, b, c], [ab, bc, ca]) = (self.corners[t as usize], self.beyond[t as usize]);
        self.change(t, [p, a, b]);
        let (second, third) = (self.add([p, b, c]), self.add([p, c, a]));
        for (part, next, outer) in [(t, second, ab), (second, third, bc), (third, t, ca)] {
            self.join(3 * part + 1, outer);
            self.join_new(3 * part + 2, 3 * next, false);
            self.doubtful.push(3 * part + 1);
        }
    }

    /// Divides side `i` of triangle `t`, and the triangle beyond it if there is one. The parts begin at the point.
    fn split_side(&mut self, t: u32, i: usize, p: u32) {
        let [a, b, c] = [0, 1, 2].map(|k| self.corners[t as usize][(i + k) % 3]);
        let [beyond, bc, ca] = [0, 1, 2].map(|k| self.beyond[t as usize][(i + k) % 3]);
        let is_kept = self.is_kept(3 * t + i as u32);
        // Triangle t keeps the half at a.
        self.change(t, [p, c, a]);
        let second = self.add([p, b, c]);
        self.join(3 * t + 1, ca);
        self.join(3 * second + 1, bc);
        self.join_new(3 * second + 2, 3 * t, false);
        self.doubtful.extend([3 * t + 1, 3 * second + 1]);
        if beyond == NONE {
            self.join(3 * second, NONE);
            self.join(3 * t + 2, NONE);
            return;
        }
        let (n, j) = (beyond / 3, beyond as usize % 3);
        let d = self.corners[n as usize][(j + 2) % 3];
        let [ad, db] = [1, 2].map(|k| self.beyond[n as usize][(j + k) % 3]);
        self.change(n, [p, d, b]);
        let fourth = self.add([p, a, d]);
        self.join(3 * n + 1, db);
        self.join(3 * fourth + 1, ad);
        self.join_new(3 * n, 3 * fourth + 2, false);
        self.join_new(3 * n + 2, 3 * second, is_kept);
        self.join_new(3 * fourth, 3 * t + 2, is_kept);
        self.doubtful.extend([3 * n + 1, 3 * fourth + 1]);
    }

    /// Turns an edge if the triangle beyond asks for it. Its triangle begins at the new point `p`; that beyond then does so too.
    fn turn(&mut self, side: u32, p: u32) {
        let beyond = self.beyond[side as usize / 3][side as usize % 3];
        if beyond == NONE || self.is_kept(side) {
            return;
        }
        let (t, n, j) = (side / 3, beyond / 3, beyond as usize % 3);
        let [_, a, b] = self.corners[t as usize];
        let d = self.corners[n as usize][(j + 2) % 3];
        if !is_turned([p, a, b, d].map(|v| self.at(v))) {
            return;
        }
        let [ad, db] = [1, 2].map(|k| self.beyond[n as usize][(j + k) % 3]);
        let bp = self.beyond[t as usize][2];
        self.change(t, [p, a, d]);
        self.change(n, [p, d, b]);
        self.join(3 * t + 1, ad);
        self.join(3 * n + 1, db);
        self.join(3 * n + 2, bp);
        self.join_new(3 * t + 2, 3 * n, false);
        self.doubtful.extend([3 * t + 1, 3 * n + 1]);
    }

    fn at(&self, v: u32) -> DVec2 {
        self.places[v as usize].truncate()
    }

    fn is_kept(&self, side: u32) -> bool {
        self.kept[side as usize / 3] & (1 << (side % 3)) != 0
    }

    fn keep(&mut self, side: u32, is_kept: bool) {
        let (bits, bit) = (&mut self.kept[side as usize / 3], 1 << (side % 3));
        *bits = if is_kept { *bits | bit } else { *bits & !bit };
    }

    /// Gives a triangle other corners. Its sides are still those of before.
    fn change(&mut self, t: u32, corners: [u32; 3]) {
        self.corners[t as usize] = corners;
        let worst = &mut self.worst[t as usize];
        if worst.cell != UNKNOWN {
            worst.cell = UNKNOWN;
            self.changed.push(t);
        }
    }

    /// Adds a triangle. Its sides are still to be joined.
    fn add(&mut self, corners: [u32; 3]) -> u32 {
        let t = self.corners.len() as u32;
        self.corners.push(corners);
        self.beyond.push([NONE; 3]);
        self.kept.push(0);
        self.worst.push(Worst { error: 0.0, cell: UNKNOWN });
        self.changed.push(t);
        t
    }

    /// Joins a side to that of a triangle that does not change. It stays an edge if it was to.
    fn join(&mut self, side: u32, outer: u32) {
        self.beyond[side as usize / 3][side as usize % 3] = outer;
        let is_kept = outer != NONE && self.is_kept(outer);
        self.keep(side, is_kept);
        if outer != NONE {
            self.beyond[outer as usize / 3][outer as usize % 3] = side;
        }
    }

    /// Joins two sides of triangles that change.
    fn join_new(&mut self, side: u32, other: u32, is_kept: bool) {
        self.beyond[side as usize / 3][side as usize % 3] = other;
        self.beyond[other as usize / 3][other as usize % 3] = side;
        self.keep(side, is_kept);
        self.keep(other, is_kept);
    }
}

/// Whether the edge from `a` to `b` is to be turned: `d` beyond it lies in the circle through `p`, `a` and `b`, and the four are the
/// corners of a convex polygon.
fn is_turned([p, a, b, d]: [DVec2; 4]) -> bool {
    let sides = [p - d, a - d, b - d];
    let squares = sides.map(DVec2::length_squared);
    let is_whole = |v: &DVec2| *v == v.trunc();
    if squares[0].max(squares[1]).max(squares[2]) < EXACT && sides.iter().all(is_whole) {
        let [p, a, b] = sides;
        return p.perp_dot(a) * squares[2] + a.perp_dot(b) * squares[0] + b.perp_dot(p) * squares[1] > 0.0;
    }
    let [p, a, b, d] = [p, a, b, d].map(|v| Coord { x: v.x, y: v.y });
    incircle(p, a, b, d) > 0.0 && orient2d(p, a, d) > 0.0 && orient2d(p, d, b) > 0.0
}
