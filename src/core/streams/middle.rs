//! The middle lines of river areas that no stream runs through.
//!
//! Where a river is wide, many maps draw its area only, and the streams end at its banks. Then nothing tells how the
//! water falls through the area. Its middle line does, and joins the streams that end there. It runs through the
//! triangles of the area, from the middle of each edge between two banks to the next (chordal axis; Prasad 1997, CNLS
//! Newsletter 139).

use geo::{Area, BoundingRect, Euclidean, Length, LineString, MultiPolygon, Polygon};
use glam::DVec2;
use rstar::primitives::Line;
use rstar::{AABB, RTree};

use super::areas::dense;
use super::chords::Chords;
use super::line::{StreamLine, Streams};
use super::network::length;
use crate::base::error::{Finding, FindingKind};
use crate::base::parallel;
use crate::geometry::{Border, OrientedBox, point_distance};
use crate::tin::{TinInput, VertexKind, triangulate};

/// Neighbouring vertices of the outline are at most this share of the mean width of the area apart, but not nearer than
/// a share of the length of the outline, which limits the time.
const STEP: f64 = 0.5;
const LEAST_STEP: f64 = 1e-4;
/// Triangles narrower than this share of the distance of the vertices come from rounding.
const SLIVER: f64 = 1e-6;
/// A tip of the area that is nearer to the end of a stream, in mean widths of the area, is no end of its own.
const OWN_END: f64 = 3.0;
/// A stream runs through an area if the length inside is at least this share of the length of the middle line.
const THROUGH: f64 = 0.5;

/// The lines of streams, and the middle lines of the areas that none of them runs through. Ends of lines that are not
/// further from an area than `snap` (map units) join its middle line.
pub(crate) fn with_middle_lines(streams: &Streams, snap: f64) -> (Vec<StreamLine>, Vec<Finding>) {
    let (mut lines, mut findings) = (streams.lines.clone(), Vec::new());
    if streams.areas.is_empty() {
        return (lines, findings);
    }
    let ends = streams.lines.iter().flat_map(|line| [line.points.first(), line.points.last()]);
    let ends = RTree::bulk_load(ends.flatten().map(|p| p.to_array()).collect());
    let pieces = streams.lines.iter().flat_map(|line| line.points.windows(2));
    let pieces = RTree::bulk_load(pieces.map(|w| Line::new(w[0].to_array(), w[1].to_array())).collect());
    let found = parallel::map_each(&streams.areas, |area| middle_lines(&area.polygon, &pieces, &ends, snap));
    for (area, courses) in streams.areas.iter().zip(found) {
        let Some(main) = courses.first() else { continue };
        let length: f64 = courses.iter().map(|course| length(course)).sum();
        let message = format!(
            "no stream runs through the river area; its middle line, {length:.1} map units long, counts as a stream"
        );
        findings.push(Finding::at(FindingKind::RiverMiddle, main[main.len() / 2], message).of_feature(area.feature));
        lines.extend(courses.into_iter().map(|points| StreamLine { points, feature: area.feature }));
    }
    (lines, findings)
}

/// The middle line of an area, and then the lines that join the ends of streams to it. None if a stream runs through the
/// area, or if the area has no inside.
fn middle_lines(
    area: &Polygon<f64>,
    pieces: &RTree<Line<[f64; 2]>>,
    ends: &RTree<[f64; 2]>,
    snap: f64,
) -> Vec<Vec<DVec2>> {
    let Some(rect) = area.bounding_rect() else { return Vec::new() };
    let rings = || std::iter::once(area.exterior()).chain(area.interiors());
    let outline: f64 = rings().map(|ring| Euclidean.length(ring)).sum();
    let width = 2.0 * area.unsigned_area() / outline;
    let step = (STEP * width).max(LEAST_STEP * outline);
    let (lo, hi) = (DVec2::new(rect.min().x, rect.min().y), DVec2::new(rect.max().x, rect.max().y));
    if !(width > 0.0 && step.is_finite()) {
        return Vec::new();
    }
    let mut input = TinInput::new([lo, hi], -1.0);
    rings().for_each(|ring| input.push_line(&dense(ring, step), 0.0, VertexKind::Axis));
    let Ok(tin) = triangulate(input) else { return Vec::new() };
    let border = Border::new(&MultiPolygon::from(area.clone()));
    // Between the vertices of one straight bank, rounding leaves slivers on either side of it.
    let is_wide: Vec<bool> = (0..tin.len()).map(|t| tin.width(t as u32) > SLIVER * step).collect();
    let tin = tin.restricted(|place| border.contains(place)).only(&is_wide);
    let chords = Chords::new(&tin);

    let is_at = |p: &DVec2| {
        border.contains(*p)
            || border
                .near_box(OrientedBox::upright(*p - snap, *p + snap))
                .any(|(_, edge)| point_distance(*p, &edge) <= snap)
    };
    let near = ends.locate_in_envelope(&AABB::from_corners((lo - snap).to_array(), (hi + snap).to_array()));
    let mut entries: Vec<DVec2> = near.map(|p| DVec2::from(*p)).filter(is_at).collect();
    entries.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    entries.dedup();
    let courses = chords.courses(&entries, OWN_END * width);
    let Some(main) = courses.first() else { return courses };
    let inside: f64 = pieces
        .locate_in_envelope_intersecting(&AABB::from_corners(lo.to_array(), hi.to_array()))
        .map(|piece| inside_length(piece, &border, step))
        .sum();
    if inside < THROUGH * length(main) { courses } else { Vec::new() }
}

/// The length of a piece of a stream inside an area, from points about `step` apart.
fn inside_length(piece: &Line<[f64; 2]>, border: &Border, step: f64) -> f64 {
    let step = step.max(LEAST_STEP * piece.length_2().sqrt());
    let points = dense(&LineString::from(vec![piece.from, piece.to]), step);
    let inside = points.windows(2).filter(|w| border.contains(w[0].midpoint(w[1])));
    inside.map(|w| w[0].distance(w[1])).sum()
}

#[cfg(test)]
mod tests {
    use super::super::line::RiverArea;
    use super::*;
    use crate::geometry::Segment;

    fn line(points: &[(f64, f64)]) -> StreamLine {
        StreamLine { points: points.iter().map(|&p| p.into()).collect(), feature: 0.into() }
    }

    /// A river 10 wide: 100 to the east, then 80 to the north. With an island or without.
    fn bent_river(island: bool) -> RiverArea {
        let outline = [(0.0, 0.0), (100.0, 0.0), (100.0, 80.0), (90.0, 80.0), (90.0, 10.0), (0.0, 10.0), (0.0, 0.0)];
        let hole = [(40.0, 4.0), (60.0, 4.0), (60.0, 7.0), (40.0, 7.0), (40.0, 4.0)];
        let holes = if island { vec![LineString::from(hole.to_vec())] } else { Vec::new() };
        RiverArea { polygon: Polygon::new(LineString::from(outline.to_vec()), holes), feature: 7.into() }
    }

    fn found(lines: Vec<StreamLine>, island: bool) -> (Vec<Vec<DVec2>>, usize) {
        let streams = Streams { lines, areas: vec![bent_river(island)] };
        let (all, findings) = with_middle_lines(&streams, 0.01);
        (all[streams.lines.len()..].iter().map(|line| line.points.clone()).collect(), findings.len())
    }

    #[test]
    fn the_middle_line_follows_the_bends_of_a_river() {
        for island in [false, true] {
            let (lines, notes) = found(Vec::new(), island);
            assert_eq!((lines.len(), notes), (1, 1));
            let along = length(&lines[0]);
            assert!((155.0..185.0).contains(&along), "{along}");
            let river = bent_river(island).polygon;
            let border = Border::new(&MultiPolygon::from(river.clone()));
            let inner = &lines[0][1..lines[0].len() - 1];
            assert!(inner.len() > 20 && inner.iter().all(|p| border.contains(*p)), "{:?}", lines[0]);
            // Both ends lie at the ends of the river.
            let mut ends = [lines[0][0], lines[0][lines[0].len() - 1]];
            ends.sort_by(|a, b| a.y.total_cmp(&b.y));
            assert!(ends[0].x == 0.0 && ends[1].y == 80.0, "{ends:?}");
            // Away from the ends it keeps to the middle.
            let middle = [
                Segment { a: DVec2::new(0.0, 5.0), b: DVec2::new(95.0, 5.0) },
                Segment { a: DVec2::new(95.0, 5.0), b: DVec2::new(95.0, 80.0) },
            ];
            let off = |p: &DVec2| middle.iter().map(|s| point_distance(*p, s)).fold(f64::INFINITY, f64::min);
            let widest = inner.iter().filter(|p| p.x > 8.0 && p.y < 72.0).map(off).fold(0.0, f64::max);
            assert!(widest < 5.0, "{widest}");
        }
    }

    #[test]
    fn the_middle_line_of_a_winding_river_reaches_from_end_to_end() {
        for count in [50, 80, 200, 500] {
            let bank = |k: i32, off: f64| {
                let t = f64::from(k) / f64::from(count);
                (744_000.0 + 8000.0 * t, 4_020_000.0 + 300.0 * (25.0 * t).sin() + off)
            };
            let outline: Vec<_> =
                (0..=count).map(|k| bank(k, 60.0)).chain((0..=count).rev().map(|k| bank(k, 0.0))).collect();
            let polygon = Polygon::new(LineString::from(outline), Vec::new());
            let streams = Streams { areas: vec![RiverArea { polygon, feature: 0.into() }], ..Streams::default() };
            let (lines, _) = with_middle_lines(&streams, 1.0);
            let along = length(&lines[0].points);
            assert!((8500.0..10500.0).contains(&along), "{count}: {along}");
        }
    }

    #[test]
    fn streams_that_end_at_a_river_join_its_middle_line() {
        let upper = line(&[(95.0, 200.0), (95.0, 80.0)]);
        let lower = line(&[(0.0, 3.0), (-50.0, 3.0)]);
        let side = line(&[(50.0, -40.0), (50.0, 0.0)]);
        let beside = line(&[(20.0, -40.0), (20.0, -1.0)]);
        let (lines, _) = found(vec![upper, lower, side, beside], false);
        assert_eq!(lines.len(), 2, "{lines:?}");
        let ends: Vec<DVec2> = vec![lines[0][0], lines[0][lines[0].len() - 1]];
        assert!(ends.contains(&DVec2::new(95.0, 80.0)) && ends.contains(&DVec2::new(0.0, 3.0)), "{ends:?}");
        let (first, last) = (lines[1][0], lines[1][lines[1].len() - 1]);
        let joint = if first == DVec2::new(50.0, 0.0) { last } else { first };
        assert!(lines[0].contains(&joint) && joint.distance(DVec2::new(50.0, 5.0)) < 6.0, "{lines:?}");
    }

    #[test]
    fn a_river_with_a_stream_or_without_an_inside_has_no_middle_line() {
        let through = line(&[(-10.0, 5.0), (95.0, 5.0), (95.0, 90.0)]);
        assert_eq!(found(vec![through], false), (Vec::new(), 0));
        // A short piece inside does not tell how the whole river falls.
        let into = line(&[(-10.0, 5.0), (20.0, 5.0)]);
        assert_eq!(found(vec![into], false).1, 1);
        let flat = RiverArea {
            polygon: Polygon::new(LineString::from(vec![(0.0, 0.0), (9.0, 0.0), (4.0, 0.0), (0.0, 0.0)]), Vec::new()),
            feature: 0.into(),
        };
        let streams = Streams { areas: vec![flat], ..Streams::default() };
        assert_eq!(with_middle_lines(&streams, 0.01).0, []);
    }
}
