//! The outlines of sub-domains: rings of triangle edges, and what each piece of them is.
//!
//! The walk follows edges between a triangle of the sub-domain and one outside it, with the sub-domain on the left. At
//! the end of an edge it turns through the triangles of the sub-domain around that vertex. So it never changes sides at
//! a point where the outline touches itself. Where a walk visits a vertex twice, it is split there. The rings are
//! therefore simple, and touch each other in single points only.

use glam::DVec2;

use crate::tin::{NONE, Tin};

/// What a piece of an outline is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BorderKind {
    /// A contour of this level, metres, or its frame extension or gap closure.
    Contour(f64),
    /// A barrier edge: it closes the opening between two ends of contours.
    Barrier,
    /// The shore of a lake of this height, metres, where no contour runs along it.
    Shore(f64),
    /// The frame, where no contour runs along it.
    Frame,
}

/// A piece of an outline, all of one kind.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Border {
    /// The kind.
    pub kind: BorderKind,
    /// Number of its first edge in the ring; edge `k` starts at the ring's vertex `k`.
    pub first: u32,
    /// How many edges it has.
    pub edges: u32,
}

/// A closed line around a sub-domain, or around a hole in it; it visits no vertex twice.
#[derive(Debug, Clone, PartialEq)]
pub struct Ring {
    /// Vertices of the triangulation in order, the first one not repeated; the sub-domain lies on the left.
    pub vertices: Vec<u32>,
    /// Its pieces in order; two pieces that follow each other differ in kind.
    pub borders: Vec<Border>,
}

impl Ring {
    /// The vertices in map coordinates, the first one repeated at the end.
    pub fn points(&self, tin: &Tin) -> Vec<DVec2> {
        self.vertices.iter().chain(self.vertices.first()).map(|&v| tin.point(v).truncate()).collect()
    }

    /// Area inside, square map units; negative for a ring around a hole.
    pub fn signed_area(&self, tin: &Tin) -> f64 {
        let Some(&first) = self.vertices.first() else { return 0.0 };
        let at = |v: u32| tin.positions[v as usize] - tin.positions[first as usize];
        0.5 * self.vertices.windows(2).map(|w| at(w[0]).perp_dot(at(w[1]))).sum::<f64>()
    }

    /// The level, if one contour runs along the whole ring.
    pub fn closed_level(&self) -> Option<f64> {
        match self.borders[..] {
            [Border { kind: BorderKind::Contour(level), .. }] => Some(level),
            _ => None,
        }
    }

    /// Whether the whole ring is one contour, or consists of shores and perhaps contours.
    pub fn is_closed(&self) -> bool {
        let is_shore = |border: &Border| matches!(border.kind, BorderKind::Shore(_));
        let is_open = |border: &Border| matches!(border.kind, BorderKind::Barrier | BorderKind::Frame);
        self.closed_level().is_some() || (self.borders.iter().any(is_shore) && !self.borders.iter().any(is_open))
    }

    /// The level of each piece of contour along the ring, in the order of the pieces.
    pub fn levels(&self) -> impl Iterator<Item = f64> {
        self.borders.iter().filter_map(|border| match border.kind {
            BorderKind::Contour(level) => Some(level),
            BorderKind::Barrier | BorderKind::Shore(_) | BorderKind::Frame => None,
        })
    }
}

/// The rings of all sub-domains.
pub(super) struct Outlines {
    /// The rings, each with its sub-domain; sub-domains are in the order of their first triangle.
    pub rings: Vec<(u32, Ring)>,
    /// The ring on which each edge of each triangle lies; [`NONE`] inside of sub-domains.
    pub of_edge: Vec<[u32; 3]>,
}

/// Follows the outlines of all sub-domains.
pub(super) fn outlines(tin: &Tin, of_triangle: &[u32]) -> Outlines {
    let mut found = Outlines { rings: Vec::new(), of_edge: vec![[NONE; 3]; tin.len()] };
    let is_border =
        |t: u32, i: usize| tin.inner_neighbour(t, i).is_none_or(|n| of_triangle[n as usize] != of_triangle[t as usize]);
    // The walk so far, without the rings that were split off, and the index of each vertex in it.
    let mut way: Vec<(u32, usize)> = Vec::new();
    let mut at = vec![NONE; tin.positions.len()];
    for first in (0..tin.len() as u32).filter(|&t| of_triangle[t as usize] != NONE) {
        for i in 0..3 {
            if !is_border(first, i) || found.of_edge[first as usize][i] != NONE {
                continue;
            }
            let (mut t, mut i) = (first, i);
            loop {
                let [start, end] = tin.edge(t, i);
                at[start as usize] = way.len() as u32;
                way.push((t, i));
                if at[end as usize] != NONE {
                    let ring = way.split_off(at[end as usize] as usize);
                    ring.iter().for_each(|&(t, i)| at[tin.edge(t, i)[0] as usize] = NONE);
                    found.push(tin, of_triangle[first as usize], ring);
                    if way.is_empty() {
                        break;
                    }
                }
                (t, i) = next(tin, t, i, is_border);
            }
        }
    }
    found
}

/// The edge of the outline that follows edge `i` of triangle `t`.
fn next(tin: &Tin, t: u32, i: usize, is_border: impl Fn(u32, usize) -> bool) -> (u32, usize) {
    let (mut t, mut i) = (t, (i + 1) % 3);
    while !is_border(t, i) {
        let neighbour = tin.neighbours[t as usize][i];
        let back = tin.edge_towards(neighbour, t).expect("neighbours know each other");
        (t, i) = (neighbour, (back + 1) % 3);
    }
    (t, i)
}

impl Outlines {
    fn push(&mut self, tin: &Tin, region: u32, mut edges: Vec<(u32, usize)>) {
        let id = self.rings.len() as u32;
        edges.iter().for_each(|&(t, i)| self.of_edge[t as usize][i] = id);
        let kind = |&(t, i): &(u32, usize)| match tin.contour_level(t, i) {
            Some(level) => BorderKind::Contour(level),
            None if tin.is_barrier(t, i) => BorderKind::Barrier,
            None if tin.is_shore(t, i) => BorderKind::Shore(tin.heights[tin.edge(t, i)[0] as usize]),
            None => BorderKind::Frame,
        };
        let last = edges.len() - 1;
        let starts = |k: usize| kind(&edges[k]) != kind(&edges[if k == 0 { last } else { k - 1 }]);
        if let Some(start) = (0..edges.len()).find(|&k| starts(k)) {
            edges.rotate_left(start);
        }
        let mut borders: Vec<Border> = Vec::new();
        for (k, edge) in edges.iter().enumerate() {
            match borders.last_mut() {
                Some(border) if border.kind == kind(edge) => border.edges += 1,
                _ => borders.push(Border { kind: kind(edge), first: k as u32, edges: 1 }),
            }
        }
        let vertices = edges.iter().map(|&(t, i)| tin.edge(t, i)[0]).collect();
        self.rings.push((region, Ring { vertices, borders }));
    }
}
