//! Makes one area from the polygons of a boundary file.
//!
//! A polygon that cannot be a frame is an error with its place. A guessed frame would cut the map wrongly, and nobody
//! would notice. Polygons are united only where necessary, because uniting rounds coordinates.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use geo::coordinate_position::{CoordPos, CoordinatePosition};
use geo::orient::{Direction, Orient};
use geo::{Area, BooleanOps, BoundingRect, Coord, LineString, MultiPolygon, Polygon, unary_union};
use glam::DVec2;
use rstar::RTree;
use rstar::primitives::{GeomWithData, Line, Rectangle};

use super::table::{NO_GEOMETRY, Table};
use crate::base::error::{Error, Result};
use crate::clean::is_place;
use crate::contour::Excluded;
use crate::geometry::{Meeting, Segment, meeting, place};

const REMEDY: &str = "repair the polygon first, for instance in QGIS with Fix Geometries";

/// A polygon and the feature it came from.
pub(super) struct Member {
    pub(super) feature: u64,
    pub(super) polygon: Polygon<f64>,
}

/// The area inside all polygons of a table.
pub(super) fn area(path: &Path, table: Table) -> Result<MultiPolygon<f64>> {
    check_polygons(path, &table, "a frame")?;
    let members = members(path, table)?;
    let pairs = common_pairs(path, &members)?;
    check_all(path, &members)?;
    Ok(MultiPolygon::new(united(members, &pairs).into_iter().map(|member| member.polygon).collect()))
}

/// The polygons of a table whose insides are left out.
pub(super) fn excluded(path: &Path, table: Table) -> Result<Vec<Excluded>> {
    check_polygons(path, &table, "a part to leave out")?;
    let members = united_polygons(path, table, |_, _| true)?;
    Ok(members.into_iter().map(|m| Excluded { polygon: m.polygon, feature: m.feature.into() }).collect())
}

/// Checks that a table has polygons and no other kind of surface. Such a surface would be missing from the result.
pub(super) fn check_polygons(path: &Path, table: &Table, whole: &str) -> Result<()> {
    if let Some((kind, count)) = table.left_out.iter().find(|(kind, _)| *kind != NO_GEOMETRY) {
        let message = format!(
            "{count} geometries of type {kind} cannot be read as {whole}; convert them to polygons or leave them out"
        );
        return Err(Error::file(path, message));
    }
    if table.features.iter().all(|feature| feature.polygons.is_empty()) {
        let found = table.found_words();
        return Err(Error::file(path, format!("there is no polygon in it{found}; {whole} needs polygons")));
    }
    Ok(())
}

/// The polygons of a table one by one, each checked.
pub(super) fn single_polygons(path: &Path, table: Table) -> Result<Vec<Member>> {
    let members = members(path, table)?;
    common_pairs(path, &members)?;
    check_all(path, &members)?;
    Ok(members)
}

/// The polygons of a table. Those that overlap or share an edge are united if `may_unite` accepts their features. A
/// united polygon gets the number of its first feature.
pub(super) fn united_polygons(path: &Path, table: Table, may_unite: impl Fn(u64, u64) -> bool) -> Result<Vec<Member>> {
    let members = members(path, table)?;
    let mut pairs = common_pairs(path, &members)?;
    check_all(path, &members)?;
    pairs.retain(|&[m, n]| may_unite(members[m].feature, members[n].feature));
    Ok(united(members, &pairs))
}

/// The polygons of a table, with closed rings.
fn members(path: &Path, table: Table) -> Result<Vec<Member>> {
    let mut members = Vec::new();
    for feature in table.features {
        let wrong = |what: String| Error::file(path, format!("feature {}: {what}; {REMEDY}", feature.number));
        for rings in feature.polygons {
            let rings = rings.into_iter().map(ring).collect::<Result<Vec<_>, String>>().map_err(wrong)?;
            let mut rings = rings.into_iter();
            if let Some(exterior) = rings.next() {
                members.push(Member { feature: feature.number, polygon: Polygon::new(exterior, rings.collect()) });
            }
        }
    }
    Ok(members)
}

fn check_all(path: &Path, members: &[Member]) -> Result<()> {
    members.iter().try_for_each(|Member { feature, polygon }| {
        check_areas(polygon).map_err(|what| Error::file(path, format!("feature {feature}: {what}; {REMEDY}")))
    })
}

/// A closed ring that can bound an area.
fn ring(points: Vec<DVec2>) -> Result<LineString<f64>, String> {
    if let Some(p) = points.iter().find(|p| !is_place(**p)) {
        return Err(format!("a vertex of its boundary is at {:?} {:?}, which is not a valid position", p.x, p.y));
    }
    let mut ring: LineString<f64> = points.iter().map(|p| Coord { x: p.x, y: p.y }).collect();
    ring.close();
    if ring.0.len() < 4 {
        let start = points.first().map_or(String::new(), |p| format!(" at {:.3} {:.3}", p.x, p.y));
        return Err(format!("a ring of its boundary{start} has {} points, it needs at least four", ring.0.len()));
    }
    Ok(ring)
}

/// Refuses rings without area, and holes outside their polygon: such a ring cannot be a hole.
fn check_areas(polygon: &Polygon<f64>) -> Result<(), String> {
    for ring in std::iter::once(polygon.exterior()).chain(polygon.interiors()) {
        if Polygon::new(ring.clone(), Vec::new()).unsigned_area() == 0.0 {
            return Err(format!("a ring of its boundary at {:.3} {:.3} has no area", ring.0[0].x, ring.0[0].y));
        }
    }
    let exterior = Polygon::new(polygon.exterior().clone(), Vec::new());
    for hole in polygon.interiors() {
        let mut positions = hole.coords().map(|c| (c, exterior.coordinate_position(c)));
        if let Some((c, CoordPos::Outside)) = positions.find(|(_, position)| *position != CoordPos::OnBoundary) {
            return Err(format!("a hole lies outside of its polygon at {:.3} {:.3}", c.x, c.y));
        }
    }
    Ok(())
}

/// A segment of a ring, with the number of its polygon and its own number.
type Edge = GeomWithData<Line<[f64; 2]>, (usize, usize)>;

/// Pairs of polygons that overlap or share an edge, not only single points.
///
/// # Errors
/// The rings of one polygon cross.
fn common_pairs(path: &Path, members: &[Member]) -> Result<BTreeSet<[usize; 2]>> {
    let mut segments: Vec<Edge> = Vec::new();
    for (m, member) in members.iter().enumerate() {
        let rings = std::iter::once(member.polygon.exterior()).chain(member.polygon.interiors());
        for line in rings.flat_map(|ring| ring.lines()).filter(|line| line.start != line.end) {
            let geometry = Line::new([line.start.x, line.start.y], [line.end.x, line.end.y]);
            segments.push(GeomWithData::new(geometry, (m, segments.len())));
        }
    }
    let segments = RTree::bulk_load(segments);
    let (mut common, mut touching) = (BTreeSet::new(), BTreeSet::new());
    let mut crossing: Option<(usize, DVec2)> = None;
    for (s, t) in segments.intersection_candidates_with_other_tree(&segments) {
        let ((m, i), (n, j)) = (s.data, t.data);
        if i >= j {
            continue;
        }
        let [s, t] = [s, t].map(|s| Segment { a: s.geom().from.into(), b: s.geom().to.into() });
        match (m == n, meeting(&s, &t)) {
            (true, Meeting::Cross) => {
                let found = (m, place(&s, &t));
                let order = |(m, p): &(usize, DVec2)| (*m, p.x, p.y);
                if crossing.as_ref().is_none_or(|first| order(&found) < order(first)) {
                    crossing = Some(found);
                }
            }
            (true, _) | (false, Meeting::Apart) => {}
            (false, Meeting::Touch) => {
                touching.insert([m.min(n), m.max(n)]);
            }
            (false, Meeting::Cross | Meeting::Overlap) => {
                common.insert([m.min(n), m.max(n)]);
            }
        }
    }
    if let Some((m, p)) = crossing {
        let feature = members[m].feature;
        let message = format!("feature {feature}: its boundary crosses itself at {:.3} {:.3}; {REMEDY}", p.x, p.y);
        return Err(Error::file(path, message));
    }
    let polygon = |m: usize| &members[m].polygon;
    let overlap = |&[m, n]: &[usize; 2]| polygon(m).intersection(polygon(n)).unsigned_area() > 0.0;
    let touching: Vec<[usize; 2]> = touching.difference(&common).copied().filter(overlap).collect();
    common.extend(touching);
    common.extend(nested_pairs(members).filter(|pair| !common.contains(pair)).collect::<Vec<_>>());
    Ok(common)
}

/// Pairs of polygons of which one contains a vertex of the other.
fn nested_pairs(members: &[Member]) -> impl Iterator<Item = [usize; 2]> {
    let boxes = members.iter().enumerate().filter_map(|(m, member)| {
        let bounds = member.polygon.bounding_rect()?;
        let corners = [bounds.min(), bounds.max()].map(|c| [c.x, c.y]);
        Some(GeomWithData::new(Rectangle::from_corners(corners[0], corners[1]), m))
    });
    let boxes = RTree::bulk_load(boxes.collect());
    let mut pairs = Vec::new();
    for (a, b) in boxes.intersection_candidates_with_other_tree(&boxes) {
        let (outer, inner) = (&members[a.data].polygon, &members[b.data].polygon);
        let mut positions = inner.exterior().coords().map(|c| outer.coordinate_position(c));
        if a.data != b.data && positions.find(|p| *p != CoordPos::OnBoundary) == Some(CoordPos::Inside) {
            pairs.push([a.data.min(b.data), a.data.max(b.data)]);
        }
    }
    pairs.into_iter()
}

/// All polygons, with each connected group of `pairs` united into one.
fn united(members: Vec<Member>, pairs: &BTreeSet<[usize; 2]>) -> Vec<Member> {
    let mut group: Vec<usize> = (0..members.len()).collect();
    let root = |group: &[usize], mut m: usize| {
        while group[m] != m {
            m = group[m];
        }
        m
    };
    for &[m, n] in pairs {
        let (a, b) = (root(&group, m), root(&group, n));
        group[a.max(b)] = a.min(b);
    }
    let mut groups: BTreeMap<usize, (u64, Vec<Polygon<f64>>)> = BTreeMap::new();
    for (m, Member { feature, polygon }) in members.into_iter().enumerate() {
        groups.entry(root(&group, m)).or_insert((feature, Vec::new())).1.push(polygon);
    }
    let mut area = Vec::new();
    for (feature, mut polygons) in groups.into_values() {
        if polygons.len() > 1 {
            // The union recognises holes by the direction of their ring.
            let oriented: Vec<Polygon<f64>> = polygons.iter().map(|p| p.orient(Direction::Default)).collect();
            polygons = unary_union(&oriented).0;
        }
        area.extend(polygons.into_iter().map(|polygon| Member { feature, polygon }));
    }
    area
}

#[cfg(test)]
mod tests;
