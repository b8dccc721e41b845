//! Entities, and the geometry of those that can be contours or spot heights.

use std::path::Path;

use glam::{DVec2, DVec3};

use super::arc::Arc;
use super::groups::{Group, GroupReader};
use super::placement::{Placement, VERTICAL};
use tokosen_core::base::error::{Error, Result};

/// Groups with this code or a larger one belong to other programs.
const FIRST_FOREIGN: i32 = 1000;
/// Begins an embedded object, which repeats the codes of the entity.
const EMBEDDED: i32 = 101;

/// The groups between two groups of code 0.
pub(super) struct Entity<'a> {
    path: &'a Path,
    groups: Vec<Group<'a>>,
}

impl<'a> Entity<'a> {
    /// Reads up to the next entity.
    pub fn read(groups: &mut GroupReader<'a>) -> Result<Self> {
        let mut own = Vec::new();
        let mut embedded = false;
        loop {
            let group = groups.must("entities")?;
            if group.code == 0 {
                groups.put_back(group);
                return Ok(Self { path: groups.path, groups: own });
            }
            embedded |= group.code == EMBEDDED;
            if !embedded && group.code < FIRST_FOREIGN {
                own.push(group);
            }
        }
    }

    /// The first group of a code.
    pub fn find(&self, code: i32) -> Option<&Group<'a>> {
        self.groups.iter().find(|group| group.code == code)
    }

    /// A number, or 0 if it is missing.
    pub fn number(&self, code: i32) -> Result<f64> {
        self.find(code).map_or(Ok(0.0), |group| group.number(self.path))
    }

    /// Flags, or 0 if they are missing.
    pub fn flags(&self, code: i32) -> Result<i64> {
        self.find(code).map_or(Ok(0), |group| group.flags(self.path))
    }

    /// A point, by the group code of its x. In old versions of the format, an entity without z has its elevation in
    /// group 38.
    pub fn point(&self, x: i32) -> Result<DVec3> {
        let z = if self.find(x + 20).is_some() { x + 20 } else { ELEVATION };
        Ok(DVec3::new(self.number(x)?, self.number(x + 10)?, self.number(z)?))
    }

    /// The file, for messages.
    pub fn path(&self) -> &'a Path {
        self.path
    }

    /// The number of groups.
    pub fn len(&self) -> usize {
        self.groups.len()
    }

    /// The normal of a planar entity's plane.
    pub fn normal(&self) -> Result<DVec3> {
        if self.find(210).or(self.find(220)).or(self.find(230)).is_none() {
            return Ok(DVec3::Z);
        }
        Ok(DVec3::new(self.number(210)?, self.number(220)?, self.number(230)?))
    }

    /// The orientation of a planar entity's plane.
    pub fn plane(&self) -> Result<Plane> {
        let normal = self.normal()?;
        let side = normal.truncate().abs().max_element();
        Ok(match normal.z {
            z if z == 0.0 || z.is_nan() || side.is_nan() || side > VERTICAL * z.abs() => Plane::Tilted,
            z if z < 0.0 => Plane::Mirrored,
            _ => Plane::Level,
        })
    }

    /// The line of an `LWPOLYLINE`.
    pub fn light_polyline(&self) -> Result<Polyline> {
        let mut line = Polyline::new(self.flags(70)?);
        for group in &self.groups {
            match group.code {
                10 => line.push(DVec3::new(group.number(self.path)?, f64::NAN, 0.0), 0.0),
                20 => {
                    if let Some(last) = line.points.last_mut() {
                        last.y = group.number(self.path)?;
                    }
                }
                42 => {
                    if let Some(last) = line.bulges.last_mut() {
                        *last = group.number(self.path)?;
                    }
                }
                _ => {}
            }
        }
        line.z.fill(self.number(ELEVATION)?);
        Ok(line)
    }

    /// The elevation of a flat `POLYLINE`: the z of its point, otherwise group 38 as old versions and some programs write
    /// it.
    fn elevation(&self) -> Result<f64> {
        let z = self.number(30)?;
        if z == 0.0 { self.number(ELEVATION) } else { Ok(z) }
    }

    /// Adds a `VERTEX` to the line of a `POLYLINE`, unless it is only a control point of a curve.
    pub fn add_vertex(&self, line: &mut Polyline) -> Result<()> {
        if self.flags(70)? & GUIDES_CURVE == 0 {
            line.push(self.point(10)?, self.number(42)?);
        }
        Ok(())
    }
}

/// The group of the elevation of flat entities.
const ELEVATION: i32 = 38;
/// Flag of polylines: the last vertex is joined to the first.
const CLOSED: i64 = 1;
/// Flag of a `POLYLINE`: every vertex has a height of its own.
pub(super) const HAS_HEIGHTS: i64 = 8;
/// Flags of a `POLYLINE` that is a mesh, not a line.
const IS_MESH: i64 = 16 | 64;
/// Flag of a `VERTEX` that is a control point: the line does not pass through it.
const GUIDES_CURVE: i64 = 16;

/// The line of a `POLYLINE` with the vertices that follow it; `None` if it is a mesh.
pub(super) fn read_polyline<'a>(entity: &Entity<'a>, groups: &mut GroupReader<'a>) -> Result<Option<Polyline>> {
    let flags = entity.flags(70)?;
    let mut line = Polyline::new(flags);
    loop {
        let group = groups.must("entities")?;
        if !group.begins("VERTEX") {
            if !group.begins("SEQEND") {
                groups.put_back(group);
            }
            break;
        }
        Entity::read(groups)?.add_vertex(&mut line)?;
    }
    if flags & HAS_HEIGHTS == 0 {
        line.flatten(entity.elevation()?);
    }
    Ok((flags & IS_MESH == 0).then_some(line))
}

/// The orientation of a planar entity's plane.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Plane {
    Level,
    /// Seen from below: x and z change their sign.
    Mirrored,
    /// Not a horizontal plane; the entity cannot be a contour.
    Tilted,
}

/// A line of vertices with bulges.
#[derive(Clone, Default)]
pub(super) struct Polyline {
    pub points: Vec<DVec2>,
    /// One bulge per vertex.
    pub z: Vec<f64>,
    bulges: Vec<f64>,
    pub is_closed: bool,
}

impl Polyline {
    /// A line without vertices, with these flags.
    pub fn new(flags: i64) -> Self {
        Self { is_closed: flags & CLOSED != 0, ..Self::default() }
    }

    fn push(&mut self, point: DVec3, bulge: f64) {
        self.points.push(point.truncate());
        self.z.push(point.z);
        self.bulges.push(bulge);
    }

    /// Gives all vertices of a flat line its elevation. Some programs leave that at 0 and write the elevation into
    /// every vertex.
    pub fn flatten(&mut self, elevation: f64) {
        if elevation != 0.0 {
            self.z.fill(elevation);
        }
    }

    /// Repeats the first vertex of a closed line at its end, and replaces arcs by chords that stay within `tolerance`.
    /// `room` is the number of vertices that may still be added to all lines.
    pub fn finish(mut self, path: &Path, tolerance: f64, room: &mut usize) -> Result<Self> {
        let (Some(&first), Some(&last)) = (self.points.first(), self.points.last()) else { return Ok(self) };
        if self.is_closed && (first != last || self.points.len() < 3) {
            self.push(first.extend(self.z[0]), 0.0);
        }
        if self.bulges.iter().all(|&bulge| bulge == 0.0) {
            return Ok(self);
        }
        let mut line = Self { is_closed: self.is_closed, ..Self::default() };
        for i in 0..self.points.len() {
            line.push(self.points[i].extend(self.z[i]), 0.0);
            let Some(&next) = self.points.get(i + 1).filter(|_| self.bulges[i] != 0.0) else { continue };
            let before = line.points.len();
            let arc = Arc { from: self.points[i], to: next, bulge: self.bulges[i] };
            if !arc.push_points(tolerance, *room, &mut line.points) {
                let message = "its polylines have arcs that are too large to be replaced by chords; check their bulges";
                return Err(Error::file(path, message));
            }
            *room -= line.points.len() - before;
            line.z.resize(line.points.len(), self.z[i]);
            line.bulges.resize(line.points.len(), 0.0);
        }
        Ok(line)
    }

    /// The line as seen from above.
    pub fn mirror(&mut self) {
        self.points.iter_mut().for_each(|p| p.x = -p.x);
        self.z.iter_mut().for_each(|z| *z = -*z);
    }

    /// The line where a placement puts it.
    pub fn place(&mut self, placement: &Placement) {
        for (point, z) in self.points.iter_mut().zip(&mut self.z) {
            let placed = placement.apply(point.extend(*z));
            (*point, *z) = (placed.truncate(), placed.z);
        }
    }
}
