//! Links from the open ends of contours to the frame.
//!
//! A contour that runs off the map ends near the frame, seldom on it. Where nothing lies between its end and the nearest
//! point of the frame, the contour is taken to go on to there, so that it divides the ground on its two sides. Ends that
//! do not see the frame (auxiliary contours, cliffs, gaps) stay open.

use glam::DVec2;
use rstar::primitives::{GeomWithData, Line, Rectangle};
use rstar::{AABB, RTree};

use super::FrameRing;
use crate::contour::ContourMap;

/// A straight continuation of a contour from its end to the frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Link {
    /// The contour's end.
    pub end: DVec2,
    /// The nearest point of the frame.
    pub frame: DVec2,
    /// The contour's elevation.
    pub elevation: f64,
}

/// Segments a box of the index holds.
const RUN: usize = 16;

/// Finds the links of all open contours.
///
/// Ends within `tolerance` (map units) of the frame lie on it and need none. An end stays open where a contour lies
/// between it and the frame, or where another end of its level is nearer than the frame: there a piece is missing.
pub fn link_open_ends(map: &ContourMap, ring: &FrameRing, tolerance: f64) -> Vec<Link> {
    let ends: Vec<(DVec2, f64)> = map
        .contours
        .iter()
        .filter(|c| !c.is_closed())
        .flat_map(|c| [c.points.first(), c.points.last()].into_iter().flatten().map(|&p| (p, c.elevation)))
        .collect();
    if ends.is_empty() {
        return Vec::new();
    }
    let frame = RTree::bulk_load(ring.edges().map(|[a, b]| Line::new(a.to_array(), b.to_array())).collect());
    let others = RTree::bulk_load(ends.iter().map(|&(p, z)| GeomWithData::new(p.to_array(), z)).collect());
    let runs = RTree::bulk_load(
        map.contours
            .iter()
            .enumerate()
            .flat_map(|(line, c)| {
                (0..c.points.len().saturating_sub(1)).step_by(RUN).map(move |first| {
                    let run = &c.points[first..(first + RUN + 1).min(c.points.len())];
                    let lo = run.iter().fold(DVec2::INFINITY, |m, &p| m.min(p)).to_array();
                    let hi = run.iter().fold(DVec2::NEG_INFINITY, |m, &p| m.max(p)).to_array();
                    GeomWithData::new(Rectangle::from_corners(lo, hi), (line, first))
                })
            })
            .collect(),
    );
    let clear = |a: DVec2, b: DVec2| {
        let query = AABB::from_corners(a.to_array(), b.to_array());
        !runs.locate_in_envelope_intersecting(&query).any(|run| {
            let (line, first) = run.data;
            let points = &map.contours[line].points;
            points[first..(first + RUN + 1).min(points.len())]
                .windows(2)
                .any(|s| s[0] != a && s[1] != a && segments_meet(a, b, s[0], s[1]))
        })
    };
    ends.iter()
        .filter_map(|&(end, elevation)| {
            let edge = frame.nearest_neighbor(&end.to_array())?;
            let on_frame = DVec2::from(edge.nearest_point(&end.to_array()));
            let distance = end.distance(on_frame);
            if distance <= tolerance {
                return None;
            }
            let facing = others
                .nearest_neighbor_iter_with_distance_2(&end.to_array())
                .take_while(|(_, d2)| *d2 < distance * distance)
                .any(|(other, d2)| d2 > 0.0 && other.data == elevation);
            (!facing && clear(end, on_frame)).then_some(Link { end, frame: on_frame, elevation })
        })
        .collect()
}

/// Whether two segments share a point, with exact predicates.
fn segments_meet(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> bool {
    use geo::Intersects;
    let line = |p: DVec2, q: DVec2| geo::Line::new((p.x, p.y), (q.x, q.y));
    line(a, b).intersects(&line(c, d))
}


#[cfg(test)]
mod tests {
    use super::*;
    use crate::contour::Contour;
    use crate::tin::{Frame, frame_ring};

    fn map(lines: &[(f64, &[(f64, f64)])]) -> ContourMap {
        let contours = lines.iter().map(|&(elevation, points)| {
            Contour { elevation, points: points.iter().map(|&p| p.into()).collect(), feature: 0 }
        });
        ContourMap { contours: contours.collect(), ..ContourMap::default() }
    }

    #[test]
    fn ends_that_see_the_frame_are_linked_and_others_stay_open() {
        // The middle line stops short of the frame on the left; on the right a wall of another level blocks the view.
        let map = map(&[
            (0.0, &[(0.0, 0.0), (100.0, 0.0)]),
            (10.0, &[(2.0, 50.0), (70.0, 50.0)]),
            (20.0, &[(80.0, 20.0), (80.0, 80.0)]),
            (30.0, &[(0.0, 100.0), (100.0, 100.0)]),
        ]);
        let ring = frame_ring(&map, &Frame::Hull);
        let links = link_open_ends(&map, &ring, 1e-7);
        let of = |z: f64| links.iter().filter(|l| l.elevation == z).map(|l| (l.end, l.frame)).collect::<Vec<_>>();
        assert_eq!(of(10.0), [(DVec2::new(2.0, 50.0), DVec2::new(0.0, 50.0))]);
        assert!(of(0.0).is_empty() && of(30.0).is_empty(), "those ends lie on the frame");
        assert_eq!(of(20.0).len(), 2);
    }

    #[test]
    fn the_two_ends_at_a_gap_are_not_sent_to_the_frame() {
        let map = map(&[
            (0.0, &[(0.0, 0.0), (100.0, 0.0)]),
            (10.0, &[(0.0, 50.0), (48.0, 50.0)]),
            (10.0, &[(52.0, 50.0), (100.0, 50.0)]),
            (20.0, &[(0.0, 100.0), (100.0, 100.0)]),
        ]);
        let ring = frame_ring(&map, &Frame::Hull);
        assert!(link_open_ends(&map, &ring, 1e-7).is_empty());
    }
}
