//! Reads the entities of a DXF into a table.

use std::path::Path;

use super::entity::{Entity, HAS_HEIGHTS, IS_MESH, Plane, Polyline};
use super::groups::GroupReader;
use super::layers::Layers;
use super::names::{LayerFilter, TextEncoding};
use super::unit;
use crate::base::error::{Error, Finding, FindingKind, Result};
use crate::io::table::{Feature, Purpose, Request, Spot, Table, Value};
use crate::io::text;

/// Arcs may add this many vertices to any drawing. For larger drawings the limit is one vertex per byte.
const ROOM: usize = 1 << 20;

const TILTED: &str = "polyline in a tilted plane";

/// Entities, other than closed lines, that may bound an area.
const SURFACES: &[&str] =
    &["CIRCLE", "ELLIPSE", "SPLINE", "HATCH", "MPOLYGON", "REGION", "SOLID", "TRACE", "3DFACE", TILTED];

/// Recognises drawings that are not text by their first bytes.
fn other_format(bytes: &[u8]) -> Option<&'static str> {
    if bytes.starts_with(b"AutoCAD Binary DXF") {
        Some("the file is a binary DXF; save it as text (ASCII DXF)")
    } else if bytes.starts_with(b"AC10") {
        Some("the file is a DWG, not a DXF; save it as DXF")
    } else {
        None
    }
}

/// Reads lines (`LWPOLYLINE`, `POLYLINE`, `LINE`) and points (`POINT`) of the model space. They are numbered from 0 in
/// the order of all entities. Closed lines are areas if areas are requested.
///
/// Arcs of polylines become chords that stay within a hundredth of a unit. Blocks are not expanded.
pub(in crate::io) fn read(path: &Path, request: &Request<'_>) -> Result<Table> {
    let bytes = text::read(path, request.memory, other_format)?;
    let mut groups = GroupReader::new(path, bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&bytes));
    let mut drawing = Drawing {
        path,
        table: Table::new(request),
        encoding: TextEncoding::default(),
        unit: None,
        wanted: LayerFilter::new(request.layer),
        layers: Layers::default(),
        inserts: 0,
        texts: 0,
        room: bytes.len().max(ROOM),
        number: 0,
    };
    let mut has_entities = false;
    while let Some(group) = groups.next()?.filter(|group| !group.begins("EOF")) {
        if !group.begins("SECTION") {
            continue;
        }
        match groups.must("sections")?.word() {
            b"HEADER" => drawing.read_header(&mut groups)?,
            b"ENTITIES" => {
                drawing.read_entities(&mut groups)?;
                has_entities = true;
            }
            _ => {}
        }
    }
    if !has_entities {
        return Err(Error::file(path, "the file has no section of entities; it is not a DXF, or it is not complete"));
    }
    drawing.finish(request)
}

/// The content of a drawing that was read so far.
struct Drawing<'a> {
    path: &'a Path,
    table: Table,
    encoding: TextEncoding,
    /// The code of the unit in the header.
    unit: Option<i64>,
    wanted: LayerFilter,
    layers: Layers,
    inserts: u64,
    texts: u64,
    /// Vertices that arcs may still add.
    room: usize,
    number: u64,
}

impl<'a> Drawing<'a> {
    fn read_header(&mut self, groups: &mut GroupReader<'a>) -> Result<()> {
        loop {
            let group = groups.must("header")?;
            if group.code == 0 {
                groups.put_back(group);
                return Ok(());
            }
            if group.code != 9 {
                continue;
            }
            let variable = group.word();
            let value = groups.must("header")?;
            match variable {
                b"$ACADVER" => self.encoding.note_version(value.word()),
                b"$DWGCODEPAGE" => self.encoding.note_code_page(value.word()),
                b"$INSUNITS" => self.unit = value.flags(self.path).ok(),
                _ => groups.put_back(value),
            }
        }
    }

    fn read_entities(&mut self, groups: &mut GroupReader<'a>) -> Result<()> {
        loop {
            let group = groups.must("entities")?;
            if group.begins("EOF") {
                groups.put_back(group);
                return Ok(());
            }
            if group.begins("ENDSEC") {
                return Ok(());
            }
            if group.code == 0 {
                let entity = Entity::read(groups)?;
                self.add(group.word(), &entity, groups)?;
            }
        }
    }

    fn add(&mut self, kind: &[u8], entity: &Entity<'a>, groups: &mut GroupReader<'a>) -> Result<()> {
        // These entities are read together with the entity before them.
        let polyline = match kind {
            b"POLYLINE" => Some(self.read_polyline(entity, groups)?),
            b"VERTEX" | b"SEQEND" | b"ATTRIB" => return Ok(()),
            _ => None,
        };
        let number = self.number;
        self.number += 1;
        let layer = entity.find(8).map_or_else(|| "0".to_owned(), |group| self.encoding.text(group.word()));
        let is_line = matches!(kind, b"LWPOLYLINE" | b"LINE") || matches!(polyline, Some(Some(_)));
        self.layers.note(&layer, u64::from(is_line));
        if !self.wanted.has(&layer) {
            return Ok(());
        }
        if entity.flags(67)? == 1 {
            self.leave_out("entity of a layout");
            return Ok(());
        }
        let mut feature = Feature { number, ..Feature::default() };
        let line = match kind {
            b"LWPOLYLINE" => Some(entity.light_polyline()?),
            b"POLYLINE" => polyline.flatten(),
            b"LINE" => {
                let ends = [entity.point(10)?, entity.point(11)?];
                self.layers.note_heights(&layer, &ends.map(|p| p.z));
                feature.push_line(ends.map(|p| p.truncate()).to_vec(), &ends.map(|p| p.z));
                None
            }
            b"POINT" => {
                let p = entity.point(10)?;
                feature.spots.push(Spot { place: p.truncate(), z: Some(p.z) });
                None
            }
            _ => None,
        };
        match (line, kind) {
            (Some(line), _) => self.add_polyline(line, entity, kind, &layer, &mut feature)?,
            (None, b"LINE" | b"POINT") => {}
            (None, b"INSERT") => self.inserts += 1,
            (None, b"POLYLINE") => self.leave_out("POLYLINE mesh"),
            (None, _) => {
                self.texts += u64::from(matches!(kind, b"TEXT" | b"MTEXT"));
                self.leave_out(&String::from_utf8_lossy(kind));
            }
        }
        let field = self.table.field("layer");
        if self.table.wants(field) {
            self.table.note(&mut feature.values, field, Value::Text(layer));
        }
        self.table.push(feature);
        Ok(())
    }

    /// Counts an entity that is left out. If areas are requested, only entities that may bound an area are counted.
    fn leave_out(&mut self, kind: &str) {
        if !self.table.wants_polygons || SURFACES.contains(&kind) {
            self.table.leave_out(kind);
        }
    }

    /// The line of a `POLYLINE` with the vertices that follow it; `None` if it is a mesh.
    fn read_polyline(&mut self, entity: &Entity<'a>, groups: &mut GroupReader<'a>) -> Result<Option<Polyline>> {
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
            line.flatten(entity.number(30)?);
        }
        Ok((flags & IS_MESH == 0).then_some(line))
    }

    fn add_polyline(
        &mut self,
        line: Polyline,
        entity: &Entity<'a>,
        kind: &[u8],
        layer: &str,
        feature: &mut Feature,
    ) -> Result<()> {
        let is_flat = kind == b"LWPOLYLINE" || entity.flags(70)? & HAS_HEIGHTS == 0;
        let plane = if is_flat { entity.plane()? } else { Plane::Level };
        if plane == Plane::Tilted {
            self.leave_out(TILTED);
            return Ok(());
        }
        let mut line = line.finish(self.path, &mut self.room)?;
        if plane == Plane::Mirrored {
            line.mirror();
        }
        self.layers.note_heights(layer, &line.z);
        if self.table.wants_polygons && line.is_closed {
            feature.note_polygon_z(&line.z);
            feature.polygons.push(vec![line.points]);
        } else {
            feature.push_line(line.points, &line.z);
        }
        Ok(())
    }

    fn finish(mut self, request: &Request<'_>) -> Result<Table> {
        self.layers.check_named(self.path, &self.wanted)?;
        if request.purpose == Purpose::Contours && request.elevation_field.is_none() {
            self.layers.check_elevations(self.path, &self.wanted, self.texts)?;
        }
        if self.inserts > 0 {
            let message = format!(
                "{} references to blocks (INSERT) left out; if there are contours in blocks, explode them in the program that \
                 drew them",
                self.inserts
            );
            self.table.findings.push(Finding::general(FindingKind::SkippedFeature, message));
        }
        unit::note(&mut self.table, self.unit);
        Ok(self.table)
    }
}
