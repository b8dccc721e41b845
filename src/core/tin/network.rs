//! The triangulation as flat arrays: corners, neighbours and flags of triangles, positions and heights of vertices.

use std::collections::HashSet;

use glam::{DVec2, DVec3};
use robust::{Coord, orient2d};

use crate::base::parallel;

/// Marks "no triangle" or "no region" in arrays of indices.
pub const NONE: u32 = u32::MAX;

/// Flag of a triangle's first edge. Those of the other edges are one and two bits further on.
pub(crate) const CONSTRAINT: u16 = 1;
pub(crate) const BARRIER: u16 = 1 << 3;
pub(crate) const CONTOUR: u16 = 1 << 6;
/// All flags of the first edge.
pub(crate) const EDGE_FLAGS: u16 = CONSTRAINT | BARRIER | CONTOUR;

/// What a vertex stands for. It determines where the height comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum VertexKind {
    /// On a contour, or on a frame extension (from the end of an open contour to the frame): its height is the level.
    Contour,
    /// A spot height.
    Spot,
    /// A corner of the frame: its height is computed from the contours around it.
    Frame,
    /// On a ridge or canyon line or otherwise computed.
    Axis,
    /// On the shore of a lake: its height is that of the water.
    Shore,
}

/// A triangulated irregular network.
///
/// Positions are relative to [`Tin::origin`], so that products of coordinates keep their digits.
#[derive(Debug, Clone, Default)]
pub struct Tin {
    /// Added to a position it gives map coordinates.
    pub origin: DVec2,
    /// Vertex positions relative to the origin, map units.
    pub positions: Vec<DVec2>,
    /// Vertex heights, metres. NaN only for vertices of kind [`VertexKind::Frame`] that have no height yet.
    pub heights: Vec<f64>,
    /// Vertex kinds.
    pub kinds: Vec<VertexKind>,
    /// The index in the input of the first point at the vertex.
    pub source: Vec<u32>,
    /// Corners of the triangles, counter-clockwise.
    pub triangles: Vec<[u32; 3]>,
    /// Neighbour across the edge from corner i to corner i+1, [`NONE`] on the outer border.
    pub neighbours: Vec<[u32; 3]>,
    /// Bit i: the edge from corner i to corner i+1 is a constraint. Bit i+3: it is a barrier edge. Bit i+6: it is a
    /// piece of a contour.
    pub(crate) edges: Vec<u16>,
    /// Whether the triangle lies inside the frame.
    pub(crate) inside: Vec<bool>,
    /// Number of the lake that the triangle lies in, [`NONE`] on land; empty without lakes.
    pub(crate) lakes: Vec<u32>,
}

impl Tin {
    /// Number of triangles, those outside the frame included.
    pub fn len(&self) -> usize {
        self.triangles.len()
    }

    /// Whether there is no triangle.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// Whether triangle `t` lies inside the frame.
    pub fn is_inside(&self, t: u32) -> bool {
        self.inside[t as usize]
    }

    /// What `f` gives for each triangle inside the frame, in the order of the triangles.
    pub(crate) fn flat_map_inside<I>(&self, f: impl Fn(u32) -> I + Sync) -> Vec<I::Item>
    where
        I: IntoIterator<Item: Send>,
    {
        let inside = |t: usize| Some(t as u32).filter(|&t| self.is_inside(t));
        parallel::flat_map(self.len(), |t| inside(t).into_iter().flat_map(&f))
    }

    /// The two ends of edge `i` of triangle `t`, counter-clockwise.
    pub fn edge(&self, t: u32, i: usize) -> [u32; 2] {
        let c = self.triangles[t as usize];
        [c[i], c[(i + 1) % 3]]
    }

    /// Length of edge `i` of triangle `t`.
    pub fn edge_length(&self, t: u32, i: usize) -> f64 {
        let [u, v] = self.edge(t, i);
        self.positions[u as usize].distance(self.positions[v as usize])
    }

    /// Weights of the corners of triangle `t` at a place relative to the origin. Their sum is 1; all are positive inside the
    /// triangle.
    pub fn weights(&self, t: u32, place: DVec2) -> [f64; 3] {
        let [a, b, c] = self.corners(t);
        let area = (b - a).perp_dot(c - a);
        let of_b = (place - a).perp_dot(c - a) / area;
        let of_c = (b - a).perp_dot(place - a) / area;
        [1.0 - of_b - of_c, of_b, of_c]
    }

    /// The smallest altitude of triangle `t`, map units.
    pub fn width(&self, t: u32) -> f64 {
        let [a, b, c] = self.corners(t);
        let longest = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
        (b - a).perp_dot(c - a).abs() / longest.sqrt()
    }

    /// Whether edge `i` of triangle `t` is a constraint: contour, frame extension, gap closure, barrier edge, frame or
    /// break line.
    pub fn is_constraint(&self, t: u32, i: usize) -> bool {
        self.edges[t as usize] & (CONSTRAINT << i) != 0
    }

    /// The flags of edge `i` of triangle `t`, as those of a first edge.
    pub(crate) fn edge_flags(&self, t: u32, i: usize) -> u16 {
        (self.edges[t as usize] >> i) & EDGE_FLAGS
    }

    /// Whether edge `i` of triangle `t` is a barrier edge, which closes the opening between two ends of contours.
    pub fn is_barrier(&self, t: u32, i: usize) -> bool {
        self.edges[t as usize] & (BARRIER << i) != 0
    }

    /// The level of edge `i` of triangle `t` if the edge is a piece of a contour, of a frame extension or of a gap
    /// closure.
    pub fn contour_level(&self, t: u32, i: usize) -> Option<f64> {
        let is_contour = self.edges[t as usize] & (CONTOUR << i) != 0;
        is_contour.then(|| self.heights[self.triangles[t as usize][i] as usize])
    }

    /// The lake that triangle `t` lies in, by its number.
    pub fn lake(&self, t: u32) -> Option<u32> {
        self.lakes.get(t as usize).copied().filter(|&lake| lake != NONE)
    }

    /// Whether edge `i` of triangle `t` is a piece of shore: water on one side, land or other water on the other.
    pub fn is_shore(&self, t: u32, i: usize) -> bool {
        !self.lakes.is_empty() && self.inner_neighbour(t, i).is_some_and(|n| self.lake(n) != self.lake(t))
    }

    /// The level of edge `i` of triangle `t` if the edge is a piece of a contour, of a frame extension, of a gap
    /// closure or of a shore.
    pub fn border_level(&self, t: u32, i: usize) -> Option<f64> {
        let shore = || self.is_shore(t, i).then(|| self.heights[self.edge(t, i)[0] as usize]);
        self.contour_level(t, i).or_else(shore)
    }

    /// The triangle inside the frame across edge `i` of triangle `t`, whatever the edge is.
    pub fn inner_neighbour(&self, t: u32, i: usize) -> Option<u32> {
        let n = self.neighbours[t as usize][i];
        (n != NONE && self.inside[n as usize]).then_some(n)
    }

    /// The triangle across edge `i` of `t` that belongs to the same sub-domain. `None` across a contour, a barrier
    /// edge, a shore or the frame.
    pub fn across(&self, t: u32, i: usize) -> Option<u32> {
        let is_border = self.is_barrier(t, i) || self.contour_level(t, i).is_some() || self.is_shore(t, i);
        if is_border { None } else { self.inner_neighbour(t, i) }
    }

    /// Which edge of `t` leads to its neighbour `n`.
    pub fn edge_towards(&self, t: u32, n: u32) -> Option<usize> {
        self.neighbours[t as usize].iter().position(|&m| m == n)
    }

    /// The same triangulation with gap closures and barrier edges marked. Those that are not edges of it are ignored.
    pub fn with_gap_edges(mut self, closures: &[[u32; 2]], barriers: &[[u32; 2]]) -> Self {
        let sorted = |[u, v]: [u32; 2]| [u.min(v), u.max(v)];
        let closures: HashSet<[u32; 2]> = closures.iter().copied().map(sorted).collect();
        let barriers: HashSet<[u32; 2]> = barriers.iter().copied().map(sorted).collect();
        let ends: HashSet<u32> = closures.iter().chain(&barriers).flatten().copied().collect();
        for t in 0..self.len() as u32 {
            for i in 0..3 {
                let edge = sorted(self.edge(t, i));
                if ends.is_empty() || !ends.contains(&edge[0]) {
                    continue;
                }
                if closures.contains(&edge) {
                    self.edges[t as usize] |= CONSTRAINT << i;
                } else if barriers.contains(&edge) {
                    self.edges[t as usize] |= (CONSTRAINT | BARRIER) << i;
                }
                self.edges[t as usize] = self.with_contours(t);
            }
        }
        self
    }

    /// The flags of triangle `t` with its pieces of contour marked: constraints between contour vertices of one level,
    /// except barrier edges.
    pub(super) fn with_contours(&self, t: u32) -> u16 {
        let flags = self.edges[t as usize];
        let is_contour = |i: usize| {
            let [u, v] = self.edge(t, i).map(|v| v as usize);
            let on_contour = |v: usize| self.kinds[v] == VertexKind::Contour;
            on_contour(u) && on_contour(v) && self.heights[u] == self.heights[v]
        };
        (0..3).fold(flags & !(7 * CONTOUR), |flags, i| {
            let may = flags & ((CONSTRAINT | BARRIER) << i) == CONSTRAINT << i;
            if may && is_contour(i) { flags | (CONTOUR << i) } else { flags }
        })
    }

    /// The same triangulation with other heights, one per vertex. Heights of contours do not change.
    pub fn with_heights(self, heights: Vec<f64>) -> Self {
        assert_eq!(heights.len(), self.positions.len(), "one height per vertex");
        Self { heights, ..self }
    }

    /// Takes all triangles out of the frame except those marked in `keep`, one flag per triangle.
    pub fn only(mut self, keep: &[bool]) -> Self {
        self.inside.iter_mut().zip(keep).for_each(|(inside, keep)| *inside &= keep);
        self
    }

    /// Takes the parts that `keep` refuses out of the frame. Parts are bounded by constraints. `keep` is called once
    /// per part, with the middle of its largest triangle in map coordinates.
    pub fn restricted(mut self, keep: impl Fn(DVec2) -> bool) -> Self {
        let mut outside = Vec::new();
        self.for_each_part(|part, place| {
            if !keep(place) {
                outside.extend_from_slice(part);
            }
        });
        outside.into_iter().for_each(|t| self.inside[t as usize] = false);
        self
    }

    /// The same triangulation with the lakes in which its parts lie, by their numbers. Parts are those of
    /// [`restricted`](Self::restricted), so shores must be constraints.
    pub fn with_lakes(mut self, mut lake_at: impl FnMut(DVec2) -> Option<u32>) -> Self {
        let mut lakes = vec![NONE; self.len()];
        self.for_each_part(|part, place| {
            if let Some(lake) = lake_at(place) {
                part.iter().for_each(|&t| lakes[t as usize] = lake);
            }
        });
        self.lakes = lakes;
        self
    }

    /// Calls `visit` for each part bounded by constraints and the frame, with its triangles and the middle of the
    /// largest of them.
    fn for_each_part(&self, mut visit: impl FnMut(&[u32], DVec2)) {
        let mut seen = vec![false; self.len()];
        for first in 0..self.len() {
            if seen[first] {
                continue;
            }
            seen[first] = true;
            let mut part = vec![first as u32];
            let mut next = 0;
            while next < part.len() {
                let t = part[next];
                next += 1;
                for i in 0..3 {
                    let n = self.neighbours[t as usize][i];
                    if n == NONE || self.is_constraint(t, i) || self.is_inside(n) != self.is_inside(t) {
                        continue;
                    }
                    if !std::mem::replace(&mut seen[n as usize], true) {
                        part.push(n);
                    }
                }
            }
            let area = |t: u32| {
                let [a, b, c] = self.corners(t);
                (b - a).perp_dot(c - a)
            };
            let largest = part.iter().copied().fold(first as u32, |m, t| if area(t) > area(m) { t } else { m });
            let [a, b, c] = self.corners(largest);
            visit(&part, (a + b + c) / 3.0 + self.origin);
        }
    }

    /// Map coordinates and height of a vertex.
    pub fn point(&self, v: u32) -> DVec3 {
        (self.positions[v as usize] + self.origin).extend(self.heights[v as usize])
    }

    /// Positions of the corners of triangle `t`.
    pub fn corners(&self, t: u32) -> [DVec2; 3] {
        self.triangles[t as usize].map(|v| self.positions[v as usize])
    }

    /// Heights of the corners of triangle `t`.
    pub fn corner_heights(&self, t: u32) -> [f64; 3] {
        self.triangles[t as usize].map(|v| self.heights[v as usize])
    }

    /// Checks that corners, neighbours and flags agree with each other; used by tests.
    ///
    /// # Errors
    /// The first disagreement, in words.
    pub fn validate(&self) -> Result<(), String> {
        for t in 0..self.len() as u32 {
            // Exact, as in the triangulation: the difference of two products is meaningless for slivers.
            let [a, b, c] = self.corners(t).map(|p| Coord { x: p.x, y: p.y });
            if orient2d(a, b, c) < 0.0 {
                return Err(format!("triangle {t} is clockwise"));
            }
            for i in 0..3 {
                let n = self.neighbours[t as usize][i];
                if n == NONE {
                    continue;
                }
                let [u, v] = self.edge(t, i);
                let back = (0..3).find(|&j| self.edge(n, j) == [v, u]);
                match back {
                    Some(j)
                        if self.neighbours[n as usize][j] == t
                            && self.is_constraint(n, j) == self.is_constraint(t, i) => {}
                    _ => return Err(format!("triangles {t} and {n} disagree about their common edge")),
                }
            }
        }
        Ok(())
    }
}
