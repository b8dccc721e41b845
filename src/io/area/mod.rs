//! Makes one area from the polygons of a boundary file.
//!
//! A polygon that cannot be a frame is an error with its place. A guessed frame would cut the map wrongly, and nobody
//! would notice. Polygons are united only where necessary, because uniting rounds coordinates.

mod groups;

use std::collections::BTreeMap;
use std::path::Path;

use geo::orient::{Direction, Orient};
use geo::{Area, BoundingRect, Coord, Intersects, Line, LineString, MultiPolygon, Polygon, Rect, unary_union};
use glam::DVec2;

use self::groups::groups;
use super::table::{NO_GEOMETRY, Table};
use tokosen_core::base::error::{Error, Result};
use tokosen_core::clean::is_place;
use tokosen_core::contour::Excluded;
use tokosen_core::geometry::{Border, Segment};

const REMEDY: &str = "repair the polygon first, for instance in QGIS with Fix Geometries";
/// Polygons that lie on each other more times than this, on average, are united in halves.
const LAYERS: f64 = 16.0;

/// A polygon and the feature it came from.
pub(super) struct Member {
    pub(super) feature: u64,
    pub(super) polygon: Polygon<f64>,
}

/// The area inside all polygons of a table.
pub(super) fn area(path: &Path, table: Table) -> Result<MultiPolygon<f64>> {
    check_polygons(path, &table, "the border of an area")?;
    let members = members(path, table)?;
    let groups = groups(path, &members, &|_, _| true)?;
    check_all(path, &members)?;
    Ok(MultiPolygon::new(united(members, &groups).into_iter().map(|member| member.polygon).collect()))
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
    groups(path, &members, &|_, _| false)?;
    check_all(path, &members)?;
    Ok(members)
}

/// The polygons of a table. Those that overlap or share an edge are united if `may_unite` accepts their features. A
/// united polygon gets the number of its first feature.
pub(super) fn united_polygons(path: &Path, table: Table, may_unite: impl Fn(u64, u64) -> bool) -> Result<Vec<Member>> {
    let members = members(path, table)?;
    let groups = groups(path, &members, &may_unite)?;
    check_all(path, &members)?;
    Ok(united(members, &groups))
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
    if polygon.interiors().is_empty() {
        return Ok(());
    }
    let border = Border::new(&Polygon::new(polygon.exterior().clone(), Vec::new()).into());
    let is_on_border = |c: Coord, p: DVec2| {
        let line = |edge: Segment| Line::new((edge.a.x, edge.a.y), (edge.b.x, edge.b.y));
        border.near(p, p).any(|(_, edge)| line(edge).intersects(&c))
    };
    for hole in polygon.interiors() {
        let positions = hole.coords().map(|&c| (c, DVec2::new(c.x, c.y)));
        let mut beside = positions.filter(|&(c, p)| !is_on_border(c, p));
        if let Some((c, _)) = beside.next().filter(|&(_, p)| !border.contains(p)) {
            return Err(format!("a hole lies outside of its polygon at {:.3} {:.3}", c.x, c.y));
        }
    }
    Ok(())
}

/// All polygons, with each group united into one. `group` is the number of each polygon's group.
fn united(members: Vec<Member>, group: &[usize]) -> Vec<Member> {
    let mut groups: BTreeMap<usize, (u64, Vec<Polygon<f64>>)> = BTreeMap::new();
    for (&group, Member { feature, polygon }) in group.iter().zip(members) {
        groups.entry(group).or_insert((feature, Vec::new())).1.push(polygon);
    }
    let mut area = Vec::new();
    for (feature, mut polygons) in groups.into_values() {
        if polygons.len() > 1 {
            // The union recognises holes by the direction of their ring.
            let oriented: Vec<Polygon<f64>> = polygons.iter().map(|p| p.orient(Direction::Default)).collect();
            polygons = union_of(&oriented).0;
        }
        area.extend(polygons.into_iter().map(|polygon| Member { feature, polygon }));
    }
    area
}

/// The union of polygons. Where many lie on each other, all their edges would cross; so they are united in halves.
fn union_of(polygons: &[Polygon<f64>]) -> MultiPolygon<f64> {
    let boxes = polygons.iter().filter_map(|polygon| polygon.bounding_rect());
    let area = |rect: Rect<f64>| rect.width() * rect.height();
    let around = |a: Rect<f64>, b: Rect<f64>| {
        let of = |pick: fn(f64, f64) -> f64, p: Coord, q: Coord| Coord { x: pick(p.x, q.x), y: pick(p.y, q.y) };
        Rect::new(of(f64::min, a.min(), b.min()), of(f64::max, a.max(), b.max()))
    };
    let whole = boxes.clone().reduce(around).map_or(0.0, area);
    if polygons.len() <= 2 || boxes.map(area).sum::<f64>() <= LAYERS * whole {
        return unary_union(polygons);
    }
    let (first, last) = polygons.split_at(polygons.len() / 2);
    let both: Vec<Polygon<f64>> = union_of(first).into_iter().chain(union_of(last)).collect();
    unary_union(&both)
}

#[cfg(test)]
mod tests;
