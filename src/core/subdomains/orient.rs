//! The direction of contours: higher ground on the right.

use glam::DVec2;

use super::{Regions, Side};
use crate::contour::ContourMap;
use crate::tin::{Tin, VertexKind};

/// Signed area of a closed line, positive when it runs counter-clockwise.
pub fn signed_area(ring: &[DVec2]) -> f64 {
    let origin = ring.first().copied().unwrap_or_default();
    0.5 * ring.windows(2).map(|w| (w[0] - origin).perp_dot(w[1] - origin)).sum::<f64>()
}

/// For each contour of the map: whether higher ground lies on its right, as it is digitised.
///
/// Each piece of contour in the triangulation (which must hold the map's contours before all other points) has a vote,
/// weighted by its length, for the side on which its triangle rises. Without votes the line counts as correct.
pub fn ascends_right(map: &ContourMap, tin: &Tin, regions: &Regions) -> Vec<bool> {
    let start = line_starts(map);
    let votes: Vec<(u32, f64)> = tin.flat_map_inside(|t| {
        let start = &start;
        (0..3).filter_map(move |i| {
            let level = tin.contour_level(t, i)?;
            let [u, v] = tin.edge(t, i);
            let (contour, forward) = piece_of(map, tin, start, u, v)?;
            let apex = tin.triangles[t as usize][(i + 2) % 3] as usize;
            let rises = match tin.heights[apex] - level {
                d if d != 0.0 && tin.kinds[apex] != VertexKind::Frame => d > 0.0,
                _ => regions.region(t)?.side(level)? == Side::Above,
            };
            // The triangle lies on the left of the piece from u to v.
            let right = rises != forward;
            Some((contour, if right { tin.edge_length(t, i) } else { -tin.edge_length(t, i) }))
        })
    });
    let mut balance = vec![0.0; map.contours.len()];
    for (contour, vote) in votes {
        balance[contour as usize] += vote;
    }
    balance.into_iter().map(|b| b >= 0.0).collect()
}

/// The number of each contour's first point, and the number after the last point of all. The map's contours must be the
/// first points triangulated.
pub(crate) fn line_starts(map: &ContourMap) -> Vec<u32> {
    let mut start = Vec::with_capacity(map.contours.len() + 1);
    start.push(0u32);
    for contour in &map.contours {
        start.push(start[start.len() - 1] + contour.points.len() as u32);
    }
    start
}

/// The contour of vertex `v`; none for frame extensions, shores, spot heights and the frame.
pub(crate) fn line_at(tin: &Tin, start: &[u32], v: u32) -> Option<u32> {
    let after = start.partition_point(|&s| s <= tin.source[v as usize]);
    (after < start.len()).then(|| after.checked_sub(1).map(|line| line as u32)).flatten()
}

/// The contour that the edge from `u` to `v` is a piece of, and whether it runs in the contour's direction.
pub(crate) fn piece_of(map: &ContourMap, tin: &Tin, start: &[u32], u: u32, v: u32) -> Option<(u32, bool)> {
    let (a, b) = (tin.source[u as usize], tin.source[v as usize]);
    let contour = start.partition_point(|&s| s <= a).checked_sub(1)?;
    let (first, end) = (start[contour], *start.get(contour + 1)?);
    if !(first..end).contains(&b) {
        return None;
    }
    // The last point of a closed line is its first one again and has no number of its own.
    let ring = if map.contours[contour].is_closed() { end - first - 1 } else { u32::MAX };
    let (a, b) = (a - first, b - first);
    if b == a + 1 || (a + 1 == ring && b == 0) {
        Some((contour as u32, true))
    } else if a == b + 1 || (b + 1 == ring && a == 0) {
        Some((contour as u32, false))
    } else {
        None
    }
}
