//! Sub-domains that touch in a single point of the frame.
//!
//! Where two parts of the frame touch at a corner, the ground passes through it from one sub-domain to another. No
//! contour lies between them. The corner has one height, which must lie in the bands of both. But bands come from the
//! contours on the border of each sub-domain. Where contours are missing, two bands may have no height in common.

use super::{Band, Regions};
use crate::tin::{Tin, VertexKind};

/// Widens bands until they agree at every point of the frame. Bands without a common height at a corner get the range
/// from the lowest to the highest level of all of them, as at a broken contour. A contour may end where another part of
/// the frame touches: then the band there is widened to include its level.
///
/// Water keeps its height.
pub fn agreeing_at_corners(mut regions: Regions, tin: &Tin) -> Regions {
    for at_vertex in at_frame(tin, &regions).chunk_by(|a, b| a.0 == b.0) {
        let vertex = at_vertex[0].0 as usize;
        let bands = at_vertex.iter().map(|&(_, region)| regions.regions[region as usize].band);
        let all = match tin.kinds[vertex] {
            VertexKind::Frame => {
                let common = bands.clone().reduce(|a, b| Band { lo: a.lo.max(b.lo), hi: a.hi.min(b.hi) });
                if common.is_none_or(|common| common.lo <= common.hi) {
                    continue;
                }
                bands.reduce(Band::union)
            }
            VertexKind::Contour | VertexKind::Shore => {
                let height = tin.heights[vertex];
                Some(Band { lo: height, hi: height })
            }
            // A spot height that contradicts its band is left out anyway, and axis points do not exist yet.
            VertexKind::Spot | VertexKind::Axis => None,
        };
        let Some(all) = all else { continue };
        for &(_, region) in at_vertex {
            let region = &mut regions.regions[region as usize];
            if region.water.is_none() {
                region.band = region.band.union(all);
            }
        }
    }
    regions
}

/// Vertices on the outline of the frame, with the sub-domains there; ascending.
fn at_frame(tin: &Tin, regions: &Regions) -> Vec<(u32, u32)> {
    let inside = (0..tin.len() as u32).filter(|&t| tin.is_inside(t));
    let edges = inside.flat_map(|t| (0..3).map(move |i| (t, i)));
    let ends = edges.filter(|&(t, i)| tin.inner_neighbour(t, i).is_none());
    let mut found: Vec<(u32, u32)> =
        ends.flat_map(|(t, i)| tin.edge(t, i).map(|v| (v, regions.of_triangle[t as usize]))).collect();
    found.sort_unstable();
    found.dedup();
    found
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::contour::Interval;
    use crate::subdomains::regions;
    use crate::tin::{TinInput, triangulate};

    /// Squares of side 10 that touch at the origin, each with a ring of its own level; `point` lies there.
    fn bands_of_touching_squares(point: (f64, VertexKind)) -> Vec<(f64, f64)> {
        let square =
            |from: f64, to: f64| [(from, from), (to, from), (to, to), (from, to), (from, from)].map(DVec2::from);
        let mut input = TinInput::new([DVec2::splat(-10.0), DVec2::splat(10.0)], 1e-9);
        let middle = input.push(DVec2::ZERO, point.0, point.1);
        for (from, to, level) in [(-7.0, -3.0, 10.0), (3.0, 7.0, 40.0)] {
            input.push_line(&square(from, to), level, VertexKind::Contour);
        }
        for side in [-10.0, 10.0] {
            let corners = [(side, 0.0), (side, side), (0.0, side)];
            let corners = corners.map(|p| input.push(p.into(), f64::NAN, VertexKind::Frame));
            for [a, b] in
                [[middle, corners[0]], [corners[0], corners[1]], [corners[1], corners[2]], [corners[2], middle]]
            {
                input.push_edge(a, b);
            }
        }
        let tin = triangulate(input).unwrap().restricted(|p| p.x * p.y > 0.0);
        let found = agreeing_at_corners(regions(&tin, &Interval { step: 10.0, base: 0.0, rounding: 0.0 }), &tin);
        let around = |side: f64| tin.locate(0, DVec2::splat(side) - tin.origin).unwrap();
        let bands = [-9.0, 9.0].map(|side| found.region(around(side)).unwrap().band);
        bands.map(|band| (band.lo, band.hi)).to_vec()
    }

    #[test]
    fn where_parts_of_the_frame_touch_their_bands_have_a_height_in_common() {
        assert_eq!(bands_of_touching_squares((f64::NAN, VertexKind::Frame)), [(10.0, 50.0), (10.0, 50.0)]);
        assert_eq!(bands_of_touching_squares((30.0, VertexKind::Contour)), [(10.0, 30.0), (30.0, 50.0)]);
    }
}
