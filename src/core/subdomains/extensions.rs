//! Open ends of contours, and their extensions to the frame.
//!
//! A contour that runs off the map ends near the frame, seldom on it. Where the frame is nearer than any other end, and
//! nothing lies between, a straight *frame extension* continues the contour to the frame. Without it the ground on the
//! two sides of the contour would be one sub-domain. Where the frame lies outside the convex hull of the contours, the border of the
//! hull is what must be nearer than any other end: these contours run off the map too. Ways to the nearest points of the frame do
//! not cross. The other ends (at a ragged outline, a cliff or a gap, or of an
//! auxiliary contour) are closed later, in the triangulation: see [`close_gaps`](super::close_gaps).

use std::collections::{HashMap, HashSet};

use glam::{DVec2, DVec3};
use rstar::primitives::{GeomWithData, Line};
use rstar::{PointDistance, RTree};

use super::FrameRing;
use crate::base::bits::bits;
use crate::base::parallel;
use crate::contour::{Contour, ContourMap};
use crate::geometry::{BoxTree, LineTree, OrientedBox, Segment, point_distance};

/// An end of an open contour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OpenEnd {
    /// Its position, map coordinates.
    pub position: DVec2,
    /// Unit vector in the direction in which the line would go on.
    pub outwards: DVec2,
    /// The contour's elevation.
    pub elevation: f64,
    /// The contour's number in the map.
    pub contour: u32,
    /// Length of the contour, map units.
    pub length: f64,
    /// Whether the contour was cut here because a part of the map was left out ([`ContourMap::cut_ends`]).
    pub is_cut: bool,
    /// Whether it lies on the frame, or a frame extension leads from it to the frame.
    pub at_frame: bool,
}

/// A straight continuation of a contour from its end to the frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameExtension {
    /// The contour's end.
    pub end: DVec2,
    /// The nearest point of the frame.
    pub frame: DVec2,
    /// The contour's elevation.
    pub elevation: f64,
}

/// Number of segments per box of the index.
const RUN: usize = 16;

/// Finds all ends of open contours, and extends those that are nearest to the frame.
///
/// Ends within `tolerance` (map units) of the frame lie on it and need no extension. `hull` is the convex hull of the contours, if the
/// frame may lie outside it.
pub fn extend_open_ends(
    map: &ContourMap,
    ring: &FrameRing,
    hull: Option<&FrameRing>,
    tolerance: f64,
) -> (Vec<OpenEnd>, Vec<FrameExtension>) {
    let mut ends: Vec<OpenEnd> = map
        .contours
        .iter()
        .enumerate()
        .filter(|(_, c)| !c.is_closed() && c.points.len() >= 2)
        .flat_map(|(i, c)| ends_of(i as u32, c))
        .collect();
    if ends.is_empty() {
        return (ends, Vec::new());
    }
    let cut: HashSet<[u64; 2]> = map.cut_ends.iter().map(|p| bits(*p)).collect();
    ends.iter_mut().for_each(|end| end.is_cut = cut.contains(&bits(end.position)));
    let edges = |ring: &FrameRing| LineTree::new(ring.edges());
    let (frame, hull) = (edges(ring), hull.map(edges));
    let corners: RTree<[f64; 2]> = RTree::bulk_load(ring.rings().flatten().map(|p| p.to_array()).collect());
    let others: RTree<[f64; 2]> = RTree::bulk_load(ends.iter().map(|e| e.position.to_array()).collect());
    let index = Sight::new(map);
    let mut extensions: Vec<(bool, Option<FrameExtension>)> = parallel::map_each(&ends, |end| {
        let at = end.position.to_array();
        let Some((_, edge)) = frame.nearest(end.position) else { return (false, None) };
        // Two vertices of the frame at one position would leave a gap for lines between them.
        let on_frame = DVec2::from(edge.nearest_point(&at));
        let corner = corners.nearest_neighbor(&on_frame.to_array()).map(|&corner| DVec2::from(corner));
        let on_frame = corner.filter(|corner| corner.distance(on_frame) <= tolerance).unwrap_or(on_frame);
        let distance = end.position.distance(on_frame);
        if distance <= tolerance {
            return (true, None);
        }
        let nearest_end = others.nearest_neighbor_iter_with_distance_2(&at).map(|(_, d2)| d2).find(|&d2| d2 > 0.0);
        // The line of sight goes a little further, to find a contour along the frame in spite of rounding.
        let beyond = on_frame + (on_frame - end.position) * (10.0 * tolerance / distance);
        let is_free =
            || index.sees(map, end.position, beyond) && !index.touches(map, end.position, on_frame, tolerance);
        let of_hull = hull.as_ref().and_then(|hull| Some(hull.nearest(end.position)?.0));
        let to_border = of_hull.unwrap_or(f64::INFINITY).min(distance * distance);
        if nearest_end.is_some_and(|d2| d2 < to_border) || !is_free() {
            return (false, None);
        }
        (true, Some(FrameExtension { end: end.position, frame: on_frame, elevation: end.elevation }))
    });
    keep_shortest(&mut extensions);
    for (end, (at_frame, _)) in ends.iter_mut().zip(&extensions) {
        end.at_frame = *at_frame;
    }
    (ends, extensions.into_iter().filter_map(|(_, extension)| extension).collect())
}

/// For each spot height, the frame extension within `tolerance` (map units) of it, if there is one.
pub fn extensions_at<'a>(
    spots: &[DVec3],
    extensions: &'a [FrameExtension],
    tolerance: f64,
) -> Vec<Option<&'a FrameExtension>> {
    let lines = extensions.iter().map(|l| GeomWithData::new(Line::new(l.end.to_array(), l.frame.to_array()), l));
    let lines = RTree::bulk_load(lines.collect());
    let at = |spot: &DVec3| {
        let place = [spot.x, spot.y];
        lines.nearest_neighbor(&place).filter(|line| line.distance_2(&place) <= tolerance * tolerance).map(|l| l.data)
    };
    parallel::map_each(spots, at)
}

/// Leaves a single extension at each point of the frame. A corner that points into the area is the nearest point of
/// many ends, and extensions of different levels must not meet.
fn keep_shortest(extensions: &mut [(bool, Option<FrameExtension>)]) {
    let length = |extension: &FrameExtension| extension.end.distance(extension.frame);
    let mut shortest: HashMap<[u64; 2], (f64, usize)> = HashMap::new();
    for (i, extension) in extensions.iter().enumerate().filter_map(|(i, (_, extension))| Some((i, extension.as_ref()?)))
    {
        let best = shortest.entry(bits(extension.frame)).or_insert((length(extension), i));
        if length(extension) < best.0 {
            *best = (length(extension), i);
        }
    }
    for (i, (at_frame, extension)) in extensions.iter_mut().enumerate() {
        if extension.as_ref().is_some_and(|extension| shortest[&bits(extension.frame)].1 != i) {
            (*at_frame, *extension) = (false, None);
        }
    }
}

fn ends_of(contour: u32, line: &Contour) -> [OpenEnd; 2] {
    let points = &line.points;
    let length = line.length();
    // A few vertices back, so that one crooked segment does not set the direction.
    let back = 4.min(points.len() - 1);
    let end = |position: DVec2, behind: DVec2| OpenEnd {
        position,
        outwards: (position - behind).normalize_or_zero(),
        elevation: line.elevation,
        contour,
        length,
        is_cut: false,
        at_frame: false,
    };
    let last = points.len() - 1;
    [end(points[0], points[back]), end(points[last], points[last - back])]
}

/// An index of the contours for lines of sight: boxes around runs of segments that may block the view.
pub(crate) struct Sight {
    tree: BoxTree,
    /// By box: the number of the line, and that of the first segment of the run.
    runs: Vec<(u32, u32)>,
}

impl Sight {
    /// Builds the index over all contours.
    pub fn new(map: &ContourMap) -> Self {
        let starts = |(line, c): (usize, &Contour)| {
            let firsts = (0..c.points.len().saturating_sub(1)).step_by(RUN);
            firsts.map(move |first| (line as u32, first as u32))
        };
        let runs: Vec<(u32, u32)> = map.contours.iter().enumerate().flat_map(starts).collect();
        let boxes: Vec<OrientedBox> = parallel::map_each(&runs, |&run| OrientedBox::around(points_of(map, run)));
        Self { tree: BoxTree::new(&boxes), runs }
    }

    /// Whether no contour lies between `a`, where contours may end, and `b`.
    pub fn sees(&self, map: &ContourMap, a: DVec2, b: DVec2) -> bool {
        !self.tree.near(OrientedBox::around(&[a, b])).any(|run| {
            points_of(map, self.runs[run as usize])
                .windows(2)
                .any(|s| s[0] != a && s[1] != a && segments_meet(a, b, s[0], s[1]))
        })
    }

    /// Whether a contour comes within `tolerance` of the way from `a`, where contours may end, to `b`. Two contours
    /// would come that near and not cross: one that ends on the frame where the extension ends, and one with a vertex
    /// on it.
    fn touches(&self, map: &ContourMap, a: DVec2, b: DVec2, tolerance: f64) -> bool {
        let way = Segment { a, b };
        self.tree.near(OrientedBox::around(&[a, b]).grown(tolerance)).any(|run| {
            let others = points_of(map, self.runs[run as usize]).windows(2).filter(|s| s[0] != a && s[1] != a);
            others.map(|s| Segment { a: s[0], b: s[1] }).any(|s| {
                let beside = point_distance(s.a, &way).min(point_distance(s.b, &way));
                beside.min(point_distance(b, &s)) <= tolerance
            })
        })
    }
}

/// The vertices of the run that begins with a line's segment.
fn points_of(map: &ContourMap, (line, first): (u32, u32)) -> &[DVec2] {
    let points = &map.contours[line as usize].points;
    &points[first as usize..(first as usize + RUN + 1).min(points.len())]
}

/// Whether two segments share a point, with exact predicates.
fn segments_meet(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> bool {
    use geo::Intersects;
    let line = |p: DVec2, q: DVec2| geo::Line::new((p.x, p.y), (q.x, q.y));
    line(a, b).intersects(&line(c, d))
}

#[cfg(test)]
mod tests {
    use geo::polygon;

    use super::*;
    use crate::subdomains::{Frame, frame_ring};

    fn map(lines: &[(f64, &[(f64, f64)])]) -> ContourMap {
        let contours = lines.iter().map(|&(elevation, points)| Contour {
            elevation,
            points: points.iter().map(|&p| p.into()).collect(),
            feature: 0.into(),
        });
        ContourMap { contours: contours.collect(), ..ContourMap::default() }
    }

    #[test]
    fn ends_that_see_the_frame_are_extended_and_others_stay_open() {
        // The middle line stops short of the frame on the left; on the right a wall of another level blocks the view.
        let map = map(&[
            (0.0, &[(0.0, 0.0), (100.0, 0.0)]),
            (10.0, &[(2.0, 50.0), (70.0, 50.0)]),
            (20.0, &[(80.0, 20.0), (80.0, 80.0)]),
            (30.0, &[(0.0, 100.0), (100.0, 100.0)]),
        ]);
        let ring = frame_ring(&map, &Frame::Hull);
        let (ends, extensions) = extend_open_ends(&map, &ring, None, 1e-7);
        let of = |z: f64| extensions.iter().filter(|l| l.elevation == z).map(|l| (l.end, l.frame)).collect::<Vec<_>>();
        assert_eq!(of(10.0), [(DVec2::new(2.0, 50.0), DVec2::new(0.0, 50.0))]);
        assert!(of(0.0).is_empty() && of(30.0).is_empty(), "those ends lie on the frame");
        assert_eq!(of(20.0).len(), 2);
        let open: Vec<DVec2> = ends.iter().filter(|e| !e.at_frame).map(|e| e.position).collect();
        assert_eq!(open, [DVec2::new(70.0, 50.0)]);
    }

    #[test]
    fn ends_at_the_border_of_the_map_are_extended_to_a_wider_frame() {
        // Contours 10 apart that run off a square map on both sides, and a gap in one of them.
        let lines: Vec<(f64, Vec<(f64, f64)>)> = (0..=10)
            .map(|k| 10.0 * f64::from(k))
            .flat_map(|y| match y {
                50.0 => vec![(y, vec![(0.0, y), (48.0, y)]), (y, vec![(52.0, y), (100.0, y)])],
                _ => vec![(y, vec![(0.0, y), (100.0, y)])],
            })
            .collect();
        let map = map(&lines.iter().map(|(z, points)| (*z, points.as_slice())).collect::<Vec<_>>());
        let wide = polygon![(x: -40.0, y: -40.0), (x: 140.0, y: -40.0), (x: 140.0, y: 140.0), (x: -40.0, y: 140.0)];
        let ring = frame_ring(&map, &Frame::Polygon(wide.into()));
        let hull = frame_ring(&map, &Frame::Hull);
        assert!(extend_open_ends(&map, &ring, None, 1e-7).1.is_empty());
        let (ends, extensions) = extend_open_ends(&map, &ring, Some(&hull), 1e-7);
        assert_eq!(extensions.len(), 22);
        assert!(extensions.iter().all(|extension| extension.end.distance(extension.frame) == 40.0));
        assert_eq!(ends.iter().filter(|end| !end.at_frame).count(), 2, "the gap stays");
    }

    #[test]
    fn no_extension_ends_on_a_contour_along_the_frame() {
        // Up to rounding, the nearest point of the frame lies on the slanting line of level 0, a part of the hull.
        for k in 0..20 {
            let end = (40.0 + 0.37 * f64::from(k), 25.0 + 0.11 * f64::from(k));
            let map = map(&[(0.0, &[(0.0, 0.1), (100.0, 33.3)]), (10.0, &[end, (55.0, 90.0), (0.0, 91.0)])]);
            let ring = frame_ring(&map, &Frame::Hull);
            let (_, extensions) = extend_open_ends(&map, &ring, None, ring.tolerance());
            assert!(extensions.iter().all(|l| l.end != DVec2::from(end)), "{end:?}");
        }
    }

    #[test]
    fn no_extension_ends_where_a_contour_does() {
        // The nearest point of the frame is the end of another level, but for a rounding error to either side.
        for off in [0.0, 3e-14, -3e-14] {
            let map = map(&[
                (0.0, &[(20.0, 150.0), (190.0, 50.0), (200.0, 300.0), (20.0, 300.0)]),
                (10.0, &[(60.0, 150.0 + off), (90.0, 200.0), (190.0, 250.0)]),
                (20.0, &[(20.0, 0.0), (200.0, 0.0)]),
            ]);
            let ring = frame_ring(&map, &Frame::Box);
            let (_, extensions) = extend_open_ends(&map, &ring, None, ring.tolerance());
            assert!(extensions.iter().all(|l| l.end.x != 60.0), "{off}: {extensions:?}");
        }
    }

    #[test]
    fn no_extension_runs_close_by_a_vertex() {
        // The way down to the frame passes a vertex of level 20, but for a rounding error to one side or the other.
        for off in [0.0, 3e-14, -3e-14] {
            let map = map(&[
                (10.0, &[(60.0, 240.0), (240.0 + off, 60.0)]),
                (20.0, &[(270.0, 90.0), (240.0, 30.0), (300.0, 60.0)]),
                (30.0, &[(50.0, 10.0), (400.0, 10.0), (400.0, 300.0), (50.0, 300.0)]),
            ]);
            let ring = frame_ring(&map, &Frame::Box);
            let (_, extensions) = extend_open_ends(&map, &ring, None, ring.tolerance());
            assert!(extensions.iter().all(|l| l.end.y != 60.0), "{off}: {extensions:?}");
        }
    }

    #[test]
    fn an_extension_ends_at_the_corner_beside_it_and_spot_heights_on_it_are_known() {
        let map = map(&[(0.0, &[(0.0, 0.0), (100.0, 0.0)]), (10.0, &[(2.0, 50.0), (100.0, 50.0)])]);
        let ring = FrameRing {
            area: polygon![(x: 0.0, y: 0.0), (x: 100.0, y: 0.0), (x: 100.0, y: 90.0), (x: 0.0, y: 90.0), (x: 1e-13, y: 50.0)].into(),
        };
        let tolerance = ring.tolerance();
        let (_, extensions) = extend_open_ends(&map, &ring, None, tolerance);
        let of_10: Vec<&FrameExtension> = extensions.iter().filter(|l| l.elevation == 10.0).collect();
        assert_eq!(of_10.len(), 1);
        assert_eq!(of_10[0].frame, DVec2::new(1e-13, 50.0));
        let spots = [DVec3::new(0.0, 50.0, 3.0), DVec3::new(1.0, 50.0 + 1e-9, 3.0), DVec3::new(1.0, 51.0, 3.0)];
        let on_extension: Vec<bool> =
            extensions_at(&spots, &extensions, tolerance).iter().map(Option::is_some).collect();
        assert_eq!(on_extension, [true, true, false]);
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
        let (ends, extensions) = extend_open_ends(&map, &ring, None, 1e-7);
        assert!(extensions.is_empty());
        assert_eq!(ends.iter().filter(|e| !e.at_frame).count(), 2);
    }
}
