//! The points of ridge and canyon lines: midpoints of the triangle edges that span a spur, a gully or a top.

use std::collections::HashSet;

use glam::DVec2;

use super::attach::attach;
use super::axis_builder::{Arrival, AxisBuilder};
use super::eliminate::{Elimination, is_chord};
use super::joins::join;
use super::pieces::{Axis, End};
use crate::base::parallel;
use crate::subdomains::{Regions, Side};
use crate::tin::{NONE, Tin, TriangleKind, VertexKind};

/// Triangles no wider than this share of the map's size hold no points. For the frame and for the ends of contours too,
/// points that close count as one.
const NARROW: f64 = 1e-9;

/// Triangles no wider than this many floating-point steps, at the size of the map's coordinates, hold no points either.
/// Rounding would put points beside them, perhaps beyond a contour.
const NARROW_STEPS: f64 = 64.0;

/// Finds the axis points of all sub-domains and joins them through sleeves, tips and junctions.
///
/// In a junction with all corners on one level, the lines meet in its centroid. In a triangle that reaches from one
/// level to the next, the line ends at the corner on the next contour. Where the line beyond ends at another vertex of
/// the same bend, that end moves to this corner. So lines continue from sub-domain to sub-domain. Every piece lies
/// inside one triangle, so it crosses no contour and no other piece.
///
/// `join_reach` is [`SkeletonTuning::join_reach`](crate::tuning::SkeletonTuning::join_reach).
pub fn axis(tin: &Tin, kinds: &[TriangleKind], regions: &Regions, elimination: &Elimination, join_reach: f64) -> Axis {
    let mut builder = AxisBuilder {
        axis: Axis::default(),
        of_edge: vec![[NONE; 3]; tin.len()],
        piece_of: vec![NONE; tin.len()],
        arrivals: Vec::new(),
        crossed: HashSet::new(),
    };
    // Water is level, and so is ground between a shore and a contour of one height.
    let is_land = |t: u32| regions.region(t).is_some_and(|region| region.band.lo < region.band.hi);
    let narrow = narrow(tin);
    let has_room = |t: u32| tin.width(t) > narrow;
    let triangles = parallel::flat_map(tin.len(), |t| {
        let t = t as u32;
        (is_land(t) && has_room(t)).then_some(t)
    });
    let chords = parallel::flat_map_each(&triangles, |&t| {
        (0..3).filter(move |&i| is_chord(tin, t, i) && has_room(tin.neighbours[t as usize][i])).map(move |i| (t, i))
    });
    for (t, i) in chords {
        if builder.of_edge[t as usize][i] != NONE {
            continue;
        }
        let [u, v] = tin.edge(t, i);
        let middle = tin.positions[u as usize].midpoint(tin.positions[v as usize]);
        let id = builder.add_point(regions, t, middle, tin.heights[u as usize]);
        builder.of_edge[t as usize][i] = id;
        let n = tin.neighbours[t as usize][i];
        if let Some(j) = tin.edge_towards(n, t) {
            builder.of_edge[n as usize][j] = id;
        }
    }
    let is_flat = |t: u32| {
        let [a, b, c] = tin.corner_heights(t);
        a == b && b == c
    };
    let bearing = triangles.into_iter().filter(|&t| is_flat(t) || builder.of_edge[t as usize] != [NONE; 3]);
    for t in bearing.collect::<Vec<u32>>() {
        if is_flat(t) {
            add_flat(tin, kinds[t as usize], regions, elimination, &mut builder, t);
        } else {
            add_arrival(tin, regions, elimination, &mut builder, t);
        }
    }
    let removed = join(tin, regions, elimination, &mut builder, join_reach);
    attach(tin, kinds, regions, elimination, &mut builder, &removed);
    let mut removed = removed.into_iter().chain(std::iter::repeat(false));
    builder.axis.pieces.retain(|_| !removed.next().unwrap_or(false));
    builder.axis
}

/// Triangles no wider than this hold no points, map units.
pub(crate) fn narrow(tin: &Tin) -> f64 {
    let extent = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    let (lo, hi) = tin.positions.iter().fold(extent, |(lo, hi), &p| (lo.min(p), hi.max(p)));
    let farthest = (lo + tin.origin).abs().max((hi + tin.origin).abs()).max_element();
    (NARROW * lo.distance(hi)).max(NARROW_STEPS * f64::EPSILON * farthest)
}

/// The pieces in a triangle with all corners on one level.
fn add_flat(
    tin: &Tin,
    kind: TriangleKind,
    regions: &Regions,
    elimination: &Elimination,
    builder: &mut AxisBuilder,
    t: u32,
) {
    let of_edge = builder.of_edge[t as usize];
    let chords: Vec<u32> = of_edge.iter().copied().filter(|&p| p != NONE).collect();
    let level = tin.heights[tin.triangles[t as usize][0] as usize];
    let [a, b, c] = tin.corners(t);
    let kept = !elimination.dropped[t as usize];
    match kind {
        TriangleKind::Isolated => {
            builder.add_point(regions, t, (a + b + c) / 3.0, level);
        }
        TriangleKind::Terminal if kept && chords.len() == 1 => {
            let i = (0..3).find(|&i| of_edge[i] != NONE).unwrap_or(0);
            if (1..3).all(|k| tin.border_level(t, (i + k) % 3).is_some()) {
                let tip = tin.triangles[t as usize][(i + 2) % 3];
                builder.add_piece(t, chords[0], End::Vertex(tip));
            }
        }
        TriangleKind::Sleeve if kept && chords.len() == 2 => builder.add_piece(t, chords[0], End::Axis(chords[1])),
        TriangleKind::Junction if kept && chords.len() == 3 => {
            let live: Vec<u32> = (0..3)
                .filter(|&i| tin.across(t, i).is_some_and(|n| !elimination.dropped[n as usize]))
                .map(|i| of_edge[i])
                .collect();
            if let [p, q] = live[..] {
                builder.add_piece(t, p, End::Axis(q));
            } else {
                let centre = builder.add_point(regions, t, (a + b + c) / 3.0, level);
                builder.axis.pieces.extend(live.iter().map(|&p| [End::Axis(p), End::Axis(centre)]));
            }
        }
        _ => {}
    }
}

/// The piece from a chord to the next contour. The triangle has two corners on one level, and the third on the contour
/// to which the ground rises or falls.
fn add_arrival(tin: &Tin, regions: &Regions, elimination: &Elimination, builder: &mut AxisBuilder, t: u32) {
    let Some(i) = (0..3).find(|&i| builder.of_edge[t as usize][i] != NONE) else { return };
    let kept = |t: u32| !elimination.dropped[t as usize];
    if !kept(t) || !tin.across(t, i).is_some_and(kept) {
        return;
    }
    let level = tin.heights[tin.edge(t, i)[0] as usize];
    let apex = tin.triangles[t as usize][(i + 2) % 3];
    let reached = tin.heights[apex as usize];
    let onwards = match regions.region(t).and_then(|r| r.side(level)) {
        Some(Side::Above) => reached > level,
        Some(Side::Below) => reached < level,
        None => false,
    };
    if onwards && tin.kinds[apex as usize] == VertexKind::Contour {
        builder.arrivals.push(Arrival { vertex: apex, region: regions.of_triangle[t as usize], triangle: t });
        builder.add_piece(t, builder.of_edge[t as usize][i], End::Vertex(apex));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contour::Interval;
    use crate::skeleton::eliminate;
    use crate::subdomains::regions;
    use crate::tin::{TinInput, triangle_kinds, triangulate};

    /// Axis points in a slit of this width, between two higher lines.
    fn points_in_slit(width: f64) -> usize {
        let mut input = TinInput::new([DVec2::new(0.0, -5.0), DVec2::new(10.0, 5.0)], 0.0);
        let slit = [(10.0, 0.0), (3.0, 0.0), (1.0, 0.5 * width), (3.0, width), (10.0, width)].map(DVec2::from);
        input.push_line(&slit, 10.0, VertexKind::Contour);
        for y in [-5.0, 5.0] {
            input.push_line(&[DVec2::new(0.0, y), DVec2::new(10.0, y)], 20.0, VertexKind::Contour);
        }
        let tin = triangulate(input).unwrap();
        let regions = regions(&tin, &Interval { step: 10.0, base: 0.0, rounding: 0.0 });
        let kinds = triangle_kinds(&tin);
        let axis = axis(&tin, &kinds, &regions, &eliminate(&tin, &kinds, &regions, 1.0), 2.0);
        axis.points.iter().filter(|p| (0.0..=width).contains(&p.position.y)).count()
    }

    #[test]
    fn a_slit_too_narrow_for_points_between_its_sides_holds_none() {
        assert_eq!(points_in_slit(1e-9), 0);
        assert!(points_in_slit(1e-6) > 0);
    }
}
