//! River areas: water as wide as the map shows it, level across and falling along.
//!
//! The streams that run through an area know how it falls. Each place on its banks has the height of the nearest place on
//! them. So both banks have one height at each place along the river, and the water between is level. The banks become
//! break lines with these heights.
//!
//! Far from contours the height of a stream is a guess, and its banks have no heights. There, the cells of an area are made
//! level on the grid of a height map ([`AreaLevels`](super::AreaLevels)).
//!
//! Tried instead on a large river: banks with the guess of their stream. Then 13 % of the cells of the stream lay more
//! than 2 m above or below the water beside them, with contours every 200 m; 26 % without, and 1 % with level cells.

use geo::{BoundingRect, LineString, MultiPolygon};
use glam::{DVec2, DVec3};
use rstar::primitives::{GeomWithData, Line};
use rstar::{AABB, RTree};

use super::line::{RiverArea, Stream};
use crate::base::error::{Finding, FindingKind};
use crate::base::{Sure, parallel};
use crate::break_lines::{Bend, BreakLine};
use crate::geometry::Border;

/// A piece of a stream between two vertices, with its ends and whether both heights are known.
type Piece = GeomWithData<Line<[f64; 2]>, ([DVec3; 2], bool)>;

/// The banks of river areas, as break lines with vertices at most `step` apart (map units). Areas that no stream runs
/// through are findings.
pub(crate) fn banks(areas: &[RiverArea], streams: &[Stream], step: f64) -> (Vec<BreakLine>, Vec<Finding>) {
    if areas.is_empty() {
        return Default::default();
    }
    let pieces = streams.iter().flat_map(|stream| {
        let known = stream.sure.windows(2).map(|w| w[0].min(w[1]) > Sure::Guessed);
        stream.points.windows(2).zip(known).map(|(w, known)| {
            let ends = [w[0], w[1]];
            Piece::new(Line::new(w[0].truncate().to_array(), w[1].truncate().to_array()), (ends, known))
        })
    });
    let pieces: RTree<Piece> = RTree::bulk_load(pieces.collect());
    let found: Vec<(Vec<BreakLine>, Option<Finding>)> = parallel::map_each(areas, |area| of_area(area, &pieces, step));
    let (lines, findings): (Vec<_>, Vec<_>) = found.into_iter().unzip();
    (lines.into_iter().flatten().collect(), findings.into_iter().flatten().collect())
}

fn of_area(area: &RiverArea, pieces: &RTree<Piece>, step: f64) -> (Vec<BreakLine>, Option<Finding>) {
    let Some(rect) = area.polygon.bounding_rect() else { return (Vec::new(), None) };
    let border = Border::new(&MultiPolygon::from(area.polygon.clone()));
    let near = pieces.locate_in_envelope_intersecting(&AABB::from_corners(
        [rect.min().x, rect.min().y],
        [rect.max().x, rect.max().y],
    ));
    let is_in = |piece: &&Piece| {
        let [a, b] = piece.data.0.map(|p| p.truncate());
        border.contains(a.midpoint(b))
    };
    let inside: Vec<Piece> = near.filter(is_in).copied().collect();
    if inside.is_empty() {
        let middle = rect.center();
        let message = "no stream runs through the river area, so its fall is not known; it is left out";
        let finding = Finding::at(FindingKind::StreamLeftOut, DVec2::new(middle.x, middle.y), message);
        return (Vec::new(), Some(finding.of_feature(area.feature)));
    }
    let inside = RTree::bulk_load(inside);
    let height = |p: DVec2| {
        let Some(piece) = inside.nearest_neighbor(&p.to_array()) else { return f64::NAN };
        let ([a, b], known) = piece.data;
        let (from, way) = (a.truncate(), b.truncate() - a.truncate());
        let share = ((p - from).dot(way) / way.length_squared()).clamp(0.0, 1.0);
        if known { a.z + share * (b.z - a.z) } else { f64::NAN }
    };
    let bank = |ring: &LineString<f64>| {
        let points = dense(ring, step);
        let heights = points.iter().map(|p| height(*p)).collect();
        BreakLine { points, heights, bend: Bend::Either, feature: area.feature }
    };
    let rings = std::iter::once(area.polygon.exterior()).chain(area.polygon.interiors());
    (rings.map(bank).collect(), None)
}

/// The vertices of a ring, and more where they are further apart than `step`.
pub(super) fn dense(ring: &LineString<f64>, step: f64) -> Vec<DVec2> {
    let vertices: Vec<DVec2> = ring.coords().map(|c| DVec2::new(c.x, c.y)).collect();
    let mut out: Vec<DVec2> = vertices.first().copied().into_iter().collect();
    for w in vertices.windows(2) {
        let parts = (w[0].distance(w[1]) / step).ceil().max(1.0) as usize;
        out.extend((1..=parts).map(|k| w[0].lerp(w[1], k as f64 / parts as f64)));
    }
    out
}
