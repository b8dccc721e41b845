//! Results cut at the border of a part of the map.

use std::collections::HashMap;

use geo::MultiPolygon;
#[cfg(feature = "io")]
use geo::{BooleanOps, Polygon};
use glam::{DVec2, DVec3};

use tokosen_core::base::bits::bits;
use tokosen_core::contour::{Contour, ContourMap, clip};
use tokosen_core::geometry::{Border, Segment, point_distance};
use tokosen_core::skeleton::{JunctionEdge, LineEnd, Skeleton, SkeletonLine};
use tokosen_core::streams::Stream;
use tokosen_core::subdivision::Subdivision;
#[cfg(feature = "io")]
use tokosen_io::layer::{Layer, Row, Shape};

/// Cuts the ridge and canyon lines of a skeleton at the border of an area.
pub fn clip_skeleton(skeleton: &mut Skeleton, area: &MultiPolygon<f64>) {
    let lines = std::mem::take(&mut skeleton.lines);
    let pieces = pieces(lines.iter().map(|line| line.points.as_slice()), area);
    skeleton.lines = pieces
        .into_iter()
        .map(|(line, points)| {
            let line = &lines[line];
            let end = |p: Option<&DVec3>, at: Option<&DVec3>, end| if p == at { end } else { LineEnd::Frame };
            let ends = [
                end(points.first(), line.points.first(), line.ends[0]),
                end(points.last(), line.points.last(), line.ends[1]),
            ];
            SkeletonLine { points, ends, ..*line }
        })
        .collect();
}

/// Cuts lines with heights at the border of an area.
pub fn clip_courses(lines: &mut Vec<Vec<DVec3>>, area: &MultiPolygon<f64>) {
    let pieces = pieces(lines.iter().map(Vec::as_slice), area);
    *lines = pieces.into_iter().map(|(_, points)| points).collect();
}

/// Cuts streams at the border of an area.
pub fn clip_streams(streams: &mut Vec<Stream>, area: &MultiPolygon<f64>) {
    let pieces = pieces(streams.iter().map(|stream| stream.points.as_slice()), area);
    *streams = pieces.into_iter().map(|(stream, points)| streams[stream].piece(points)).collect();
}

/// Keeps the edges whose middle lies in an area.
pub fn clip_edges(edges: &mut Vec<JunctionEdge>, area: &MultiPolygon<f64>) {
    let border = Border::new(area);
    edges.retain(|edge| border.contains(edge.ends[0].midpoint(edge.ends[1]).truncate()));
}

/// Cuts the contours of a subdivision at the border of an area, and takes the triangles outside of it out of the frame. A
/// triangle is inside if its middle is.
pub fn clip_subdivision(mut subdivision: Subdivision, area: &MultiPolygon<f64>) -> Subdivision {
    let (border, tin) = (Border::new(area), &subdivision.tin);
    let middle = |t: u32| tin.corners(t).iter().sum::<DVec2>() / 3.0 + tin.origin;
    let keep: Vec<bool> = (0..tin.len() as u32).map(|t| border.contains(middle(t))).collect();
    subdivision.tin = subdivision.tin.only(&keep);
    subdivision.map = clip(subdivision.map, area).map;
    subdivision.frame.area = area.clone();
    subdivision
}

/// Cuts the areas of a layer at the border of an area. An area in several pieces becomes several rows with the same
/// attributes, which are those of the whole.
#[cfg(feature = "io")]
pub fn clip_areas<'a>(layer: Layer<'a>, area: &MultiPolygon<f64>) -> Layer<'a> {
    let cut = |row: &Row<'a>| -> Vec<Row<'a>> {
        let Shape::Area(rings) = &row.shape else { return vec![row.clone()] };
        let mut rings = rings.iter().map(|ring| ring.iter().map(|p| (p.x, p.y)).collect());
        let Some(outer) = rings.next() else { return Vec::new() };
        let whole = Polygon::new(outer, rings.collect());
        let closed = |ring: &geo::LineString<f64>| ring.coords().map(|c| DVec2::new(c.x, c.y)).collect();
        let row = |polygon: &Polygon<f64>| {
            let rings = std::iter::once(polygon.exterior()).chain(polygon.interiors()).map(closed).collect();
            Row { shape: Shape::Area(rings), cells: row.cells.clone() }
        };
        area.intersection(&whole).iter().map(row).collect()
    };
    Layer { rows: layer.rows.iter().flat_map(cut).collect(), ..layer }
}

/// The pieces of lines inside an area, each with the number of its line. Vertices on the border get heights along the line.
fn pieces<'a>(lines: impl Iterator<Item = &'a [DVec3]>, area: &MultiPolygon<f64>) -> Vec<(usize, Vec<DVec3>)> {
    let lines: Vec<&[DVec3]> = lines.collect();
    let flat = |(k, line): (u64, &&[DVec3])| Contour {
        elevation: 0.0,
        points: line.iter().map(|p| p.truncate()).collect(),
        feature: k.into(),
    };
    let map = ContourMap { contours: (0u64..).zip(&lines).map(flat).collect(), ..ContourMap::default() };
    let piece = |piece: Contour| {
        let number = piece.feature.number() as usize;
        let line = lines[number];
        let own: HashMap<[u64; 2], f64> = line.iter().map(|p| (bits(p.truncate()), p.z)).collect();
        let height = |p: DVec2| own.get(&bits(p)).copied().unwrap_or_else(|| height_at(line, p));
        (number, piece.points.into_iter().map(|p| p.extend(height(p))).collect())
    };
    clip(map, area).map.contours.into_iter().map(piece).collect()
}

/// The height of a line at a place beside it.
fn height_at(line: &[DVec3], p: DVec2) -> f64 {
    let distance = |ends: &&[DVec3]| point_distance(p, &Segment { a: ends[0].truncate(), b: ends[1].truncate() });
    let nearest = line.windows(2).min_by(|a, b| distance(a).total_cmp(&distance(b)));
    nearest.map_or(f64::NAN, |ends| {
        let [a, b] = [ends[0], ends[1]];
        let along = b.truncate() - a.truncate();
        let share = ((p - a.truncate()).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        if share.is_nan() { a.z } else { a.z + share * (b.z - a.z) }
    })
}

#[cfg(test)]
mod tests {
    use geo::polygon;

    use super::*;

    #[test]
    fn lines_get_heights_where_they_are_cut() {
        let area = polygon![(x: 1.0, y: -1.0), (x: 3.0, y: -1.0), (x: 3.0, y: 1.0), (x: 1.0, y: 1.0)].into();
        let line = [DVec3::new(0.0, 0.0, 10.0), DVec3::new(2.0, 0.0, 6.0), DVec3::new(6.0, 0.0, 4.0)];
        let found = pieces([&line[..]].into_iter(), &area);
        let cut = vec![DVec3::new(1.0, 0.0, 8.0), DVec3::new(2.0, 0.0, 6.0), DVec3::new(3.0, 0.0, 5.5)];
        assert_eq!(found, [(0, cut)]);
    }
}
