//! The points of ridge and canyon lines: centres of the triangle edges that span a spur, a gully or a top.

use glam::DVec2;

use super::eliminate::{Elimination, is_chord};
use crate::tin::{NONE, Regions, Tin, TriangleKind};

/// A point between two places of one contour level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisPoint {
    /// Position relative to the triangulation's origin.
    pub position: DVec2,
    /// The level on both sides; none for a point anywhere in its sub-domain.
    pub level: Option<f64>,
    /// A triangle that the point lies in or on.
    pub triangle: u32,
    /// The sub-domain.
    pub region: u32,
}

/// Where a piece of a line leads to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum End {
    /// To an axis point.
    Axis(u32),
    /// To a vertex of the triangulation: the tip of a contour's bend.
    Vertex(u32),
}

/// Axis points and the pieces of line between them.
#[derive(Debug, Clone, Default)]
pub struct Axis {
    /// The points, those in dropped branches included: they carry height, not lines.
    pub points: Vec<AxisPoint>,
    /// Pieces of ridge and canyon lines.
    pub pieces: Vec<[End; 2]>,
}

/// Collects the axis points of all sub-domains and joins them through sleeves, tips and junctions.
///
/// In a junction with all corners on one level the three lines meet in its centroid.
pub fn axis(tin: &Tin, kinds: &[TriangleKind], regions: &Regions, elimination: &Elimination) -> Axis {
    let mut axis = Axis::default();
    let mut of_edge: Vec<[u32; 3]> = vec![[NONE; 3]; tin.len()];
    let add = |axis: &mut Axis, t: u32, position: DVec2, level: f64| {
        axis.points.push(AxisPoint {
            position,
            level: Some(level),
            triangle: t,
            region: regions.of_triangle[t as usize],
        });
        (axis.points.len() - 1) as u32
    };
    for t in 0..tin.len() as u32 {
        for i in 0..3 {
            if of_edge[t as usize][i] != NONE || !tin.is_inside(t) || !is_chord(tin, t, i) {
                continue;
            }
            let [u, v] = tin.edge(t, i);
            let middle = tin.positions[u as usize].midpoint(tin.positions[v as usize]);
            let id = add(&mut axis, t, middle, tin.heights[u as usize]);
            of_edge[t as usize][i] = id;
            let n = tin.neighbours[t as usize][i];
            if let Some(j) = tin.edge_towards(n, t) {
                of_edge[n as usize][j] = id;
            }
        }
    }
    for t in (0..tin.len() as u32).filter(|&t| tin.is_inside(t)) {
        let chords: Vec<u32> = of_edge[t as usize].iter().copied().filter(|&p| p != NONE).collect();
        let level = tin.heights[tin.triangles[t as usize][0] as usize];
        let flat = tin.corner_heights(t).iter().all(|&h| h == level);
        let [a, b, c] = tin.corners(t);
        let kept = !elimination.dropped[t as usize];
        match kinds[t as usize] {
            TriangleKind::Isolated if flat => {
                add(&mut axis, t, (a + b + c) / 3.0, level);
            }
            TriangleKind::Terminal if flat && kept && chords.len() == 1 => {
                let i = (0..3).find(|&i| of_edge[t as usize][i] != NONE).unwrap_or(0);
                if (1..3).all(|k| tin.contour_level(t, (i + k) % 3).is_some()) {
                    let tip = tin.triangles[t as usize][(i + 2) % 3];
                    axis.pieces.push([End::Axis(chords[0]), End::Vertex(tip)]);
                }
            }
            TriangleKind::Sleeve if kept && chords.len() == 2 => {
                axis.pieces.push([End::Axis(chords[0]), End::Axis(chords[1])]);
            }
            TriangleKind::Junction if kept && chords.len() == 3 => {
                let live: Vec<u32> = (0..3)
                    .filter(|&i| tin.across(t, i).is_some_and(|n| !elimination.dropped[n as usize]))
                    .map(|i| of_edge[t as usize][i])
                    .collect();
                if let [p, q] = live[..] {
                    axis.pieces.push([End::Axis(p), End::Axis(q)]);
                } else {
                    let centre = add(&mut axis, t, (a + b + c) / 3.0, level);
                    axis.pieces.extend(live.iter().map(|&p| [End::Axis(p), End::Axis(centre)]));
                }
            }
            _ => {}
        }
    }
    axis
}
