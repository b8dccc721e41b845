//! Reads the entities of a DXF into a table.

use std::path::Path;

use super::arc::TOLERANCE;
use super::blocks::{Blocks, Item, Missing, Placed, layer_of};
use super::entity::{Entity, HAS_HEIGHTS, Plane, Polyline};
use super::groups::GroupReader;
use super::layers::Layers;
use super::names::{LayerFilter, TextEncoding};
use super::placement::Placement;
use super::unit;
use crate::table::{Feature, Purpose, Request, Spot, Table, Value};
use crate::text;
use tokosen_core::base::error::{Error, Finding, FindingKind, Result};

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
/// the order of all entities; those of blocks follow. Closed lines are areas if areas are requested.
///
/// Arcs of polylines become chords that stay within a hundredth of a unit. References to blocks are followed.
pub(crate) fn read(path: &Path, request: &Request<'_>) -> Result<Table> {
    let bytes = text::read(path, request.memory, other_format)?;
    let mut groups = GroupReader::new(path, bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&bytes));
    let mut drawing = Drawing {
        path,
        table: Table::new(request),
        encoding: TextEncoding::default(),
        unit: None,
        wanted: LayerFilter::new(request.layer),
        layers: Layers::default(),
        blocks: Blocks::default(),
        inserts: Vec::new(),
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
            b"BLOCKS" => drawing.blocks.read(&mut groups)?,
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
    blocks: Blocks<'a>,
    /// The references to blocks.
    inserts: Vec<Entity<'a>>,
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
            if group.code == 0
                && let Some(item) = Item::read(group.word(), groups)?
            {
                self.add(item)?;
            }
        }
    }

    /// Adds an entity of the drawing itself. References to blocks are followed when the whole file is read.
    fn add(&mut self, item: Item<'a>) -> Result<()> {
        let number = self.number;
        self.number += 1;
        let layer = self.layer_name(layer_of(&item.entity));
        let is_line = matches!(item.kind, b"LWPOLYLINE" | b"LINE") || item.line.is_some();
        self.layers.note(&layer, u64::from(is_line));
        if item.kind == b"INSERT" {
            self.inserts.push(item.entity);
            return Ok(());
        }
        if !self.wanted.has(&layer) {
            return Ok(());
        }
        if item.entity.flags(67)? == 1 {
            self.leave_out("entity of a layout");
            return Ok(());
        }
        let Some(mut feature) = self.feature_of(&item, &Placement::IDENTITY)? else { return Ok(()) };
        feature.number = number;
        if let Some(z) = heights_of_line(&feature) {
            self.layers.note_heights(&layer, &z);
        }
        feature.spots.iter().filter_map(|spot| spot.z).for_each(|z| self.layers.note_spot(&layer, z));
        self.push(feature, layer);
        Ok(())
    }

    /// The feature of an entity, without its number. Its geometry is empty if the entity is left out. `None` if that is told.
    fn feature_of(&mut self, item: &Item<'a>, placement: &Placement) -> Result<Option<Feature>> {
        let mut feature = Feature::default();
        match item.kind {
            b"LWPOLYLINE" => self.add_polyline(item.entity.light_polyline()?, item, placement, &mut feature)?,
            b"POLYLINE" => match &item.line {
                Some(line) => self.add_polyline(line.clone(), item, placement, &mut feature)?,
                None => self.leave_out("POLYLINE mesh"),
            },
            b"LINE" => {
                let ends = [item.entity.point(10)?, item.entity.point(11)?].map(|p| placement.apply(p));
                feature.push_line(ends.map(|p| p.truncate()).to_vec(), &ends.map(|p| p.z));
            }
            b"POINT" => {
                let p = placement.apply(item.entity.point(10)?);
                feature.spots.push(Spot { place: p.truncate(), z: Some(p.z) });
            }
            // What a block asks to fill in, not what is drawn.
            b"ATTDEF" => return Ok(None),
            kind => {
                self.texts += u64::from(matches!(kind, b"TEXT" | b"MTEXT"));
                self.leave_out(&String::from_utf8_lossy(kind));
            }
        }
        Ok(Some(feature))
    }

    /// Adds what the references to blocks place in the drawing, numbered after its own entities.
    fn add_blocks(&mut self, request: &Request<'_>) -> Result<()> {
        let (blocks, inserts) = (std::mem::take(&mut self.blocks), std::mem::take(&mut self.inserts));
        let mut room = Blocks::room(self.room);
        let mut missing = Missing::new();
        let mut found = Vec::new();
        for insert in &inserts {
            if insert.flags(67)? == 1 {
                self.leave_out("entity of a layout");
                continue;
            }
            blocks.follow(insert, &mut room, &mut missing, &mut |placed: Placed<'_, 'a>| {
                let layer = self.layer_name(placed.layer);
                self.layers.note(&layer, 0);
                if !self.wanted.has(&layer) {
                    return Ok(());
                }
                if let Some(feature) = self.feature_of(placed.item, &placed.placement)? {
                    let z: Vec<f64> = heights_of_line(&feature)
                        .unwrap_or_else(|| feature.spots.iter().filter_map(|spot| spot.z).collect());
                    if !z.is_empty() {
                        self.layers.note_in_block(&layer, &z);
                        found.push((feature, layer, z));
                    }
                }
                Ok(())
            })?;
        }
        let needs_heights =
            matches!(request.purpose, Purpose::Contours | Purpose::Spots) && request.elevation_field.is_none();
        let mut at_zero = 0_u64;
        for (mut feature, layer, z) in found {
            if needs_heights && self.layers.is_symbol_layer(&layer) {
                at_zero += 1;
                continue;
            }
            if !feature.lines.is_empty() || !feature.polygons.is_empty() {
                self.layers.keep_block_line(&layer, &z);
            }
            feature.number = self.number;
            self.number += 1;
            self.push(feature, layer);
        }
        let mut tell = |message: String| {
            self.table.findings.push(Finding::general(FindingKind::SkippedFeature, message));
        };
        for (why, count) in missing {
            tell(format!("{count} references to blocks (INSERT) left out: the block {why}"));
        }
        if at_zero > 0 {
            tell(format!(
                "{at_zero} lines and points of blocks left out: on their layers, all that blocks have lies at 0, as symbols and \
                 borders do"
            ));
        }
        Ok(())
    }

    fn layer_name(&self, bytes: &[u8]) -> String {
        self.encoding.text(bytes)
    }

    fn push(&mut self, mut feature: Feature, layer: String) {
        let field = self.table.field("layer");
        if self.table.wants(field) {
            self.table.note(&mut feature.values, field, Value::Text(layer));
        }
        self.table.push(feature);
    }

    /// Counts an entity that is left out. If areas are requested, only entities that may bound an area are counted.
    fn leave_out(&mut self, kind: &str) {
        if !self.table.wants_polygons || SURFACES.contains(&kind) {
            self.table.leave_out(kind);
        }
    }

    fn add_polyline(
        &mut self,
        line: Polyline,
        item: &Item<'a>,
        placement: &Placement,
        feature: &mut Feature,
    ) -> Result<()> {
        let is_flat = item.kind == b"LWPOLYLINE" || item.entity.flags(70)? & HAS_HEIGHTS == 0;
        let plane = if is_flat { item.entity.plane()? } else { Plane::Level };
        if plane == Plane::Tilted {
            self.leave_out(TILTED);
            return Ok(());
        }
        let mut line = line.finish(self.path, TOLERANCE / placement.growth(), &mut self.room)?;
        if plane == Plane::Mirrored {
            line.mirror();
        }
        line.place(placement);
        if self.table.wants_polygons && line.is_closed {
            feature.note_polygon_z(&line.z);
            feature.polygons.push(vec![line.points]);
        } else {
            feature.push_line(line.points, &line.z);
        }
        Ok(())
    }

    fn finish(mut self, request: &Request<'_>) -> Result<Table> {
        self.add_blocks(request)?;
        self.layers.check_named(self.path, &self.wanted)?;
        if request.purpose == Purpose::Contours && request.elevation_field.is_none() {
            self.layers.check_elevations(self.path, &self.wanted, self.texts)?;
        }
        unit::note(&mut self.table, self.unit);
        Ok(self.table)
    }
}

/// The heights of a feature's line or area; `None` if it is neither. A line at one height has that height alone.
fn heights_of_line(feature: &Feature) -> Option<Vec<f64>> {
    let line = feature.lines.first().and_then(|line| line.z);
    line.or(feature.polygon_z).map(|range| range.to_vec())
}
