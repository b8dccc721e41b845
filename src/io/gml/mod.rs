//! Reads GML (OGC 03-105r1 and ISO 19136): simple features with points, lines and polygons.
//!
//! Features are the elements in `featureMember`, `featureMembers` or `member`. Their attributes are the elements with text
//! alone. The type of a feature is the layer. Positions stand in `pos`, `posList`, `coordinates` or `coord`; the system's
//! name says in which order ([`axes`]). Arcs and splines are left out.

mod axes;
mod geometry;

use std::collections::BTreeMap;
use std::io::BufReader;
use std::path::Path;

use super::meter::{LimitedReader, MAX_DOCUMENT_LENGTH};
use super::table::{Feature, NO_GEOMETRY, Purpose, Request, Table, Value};
use super::xml::{Step, Xml};
use crate::ordinary::open_to_read;
use axes::Axes;
use geometry::{Geometry, is_geometry};
use tokosen_core::base::error::{Error, Finding, FindingKind, Result};
use tokosen_core::base::memory;

const BUFFER: usize = 1 << 17;
/// Memory per byte of text: positions and attributes.
const BYTES_PER_BYTE: f64 = 2.0;
/// Elements that hold features.
const MEMBERS: [&str; 5] = ["featureMember", "featureMembers", "member", "members", "Tuple"];
/// The attribute that holds the type of a feature.
const LAYER: &str = "layer";

/// The frame of reference that an element states for what is in it.
#[derive(Debug, Clone, Default, PartialEq)]
struct Context {
    srs: Option<String>,
    dimension: Option<usize>,
}

/// A feature that is not read completely.
struct Open {
    feature: Feature,
    kind: String,
    /// The depth of its element.
    depth: usize,
    geometry: Geometry,
    /// The depth of the geometry element, or of another part that holds no attributes.
    inner: Option<usize>,
    /// Whether the element that is open has elements in it.
    has_elements: bool,
}

struct Reading<'a> {
    table: Table,
    request: &'a Request<'a>,
    number: u64,
    /// The systems that were named, each with its axes.
    systems: BTreeMap<String, Option<Axes>>,
    /// Features with lines or polygons, by their type.
    kinds: BTreeMap<String, u64>,
    /// The system that the collection states.
    common: Context,
}

/// Reads the features of a file. They are numbered from 0, in the order of the file.
pub(super) fn read(path: &Path, request: &Request<'_>) -> Result<Table> {
    let file = open_to_read(path)?;
    let length = file.metadata().map_err(|e| Error::io("read", path, e))?.len();
    let remedy = "clip the map first, or save it as a GeoPackage";
    let what = format!("reading {} as a whole", path.display());
    memory::check(BYTES_PER_BYTE * length as f64, request.memory, what, remedy)?;
    let mut file = BufReader::with_capacity(BUFFER, file);
    let mut source = LimitedReader::new(&mut file as &mut dyn std::io::BufRead, MAX_DOCUMENT_LENGTH);
    let mut xml = Xml::new(path, &mut source)?;
    let mut reading = Reading {
        table: Table::new(request),
        request,
        number: 0,
        systems: BTreeMap::new(),
        kinds: BTreeMap::new(),
        common: Context::default(),
    };
    reading.document(&mut xml)?;
    reading.finish(path)
}

impl Reading<'_> {
    fn document(&mut self, xml: &mut Xml<'_, '_>) -> Result<()> {
        // The names and contexts of the elements that are open.
        let mut around: Vec<(String, Context)> = Vec::new();
        let mut open: Option<Open> = None;
        let mut text = String::new();
        loop {
            match xml.next()? {
                Step::Start => {
                    text.clear();
                    let name = xml.name().to_owned();
                    let (parent, mut context) = around.last().cloned().unwrap_or_default();
                    if let Some(srs) = xml.attribute("srsName") {
                        context.srs = Some(srs.to_owned());
                        if open.is_none() {
                            self.common.srs = context.srs.clone();
                        }
                    }
                    if let Some(dimension) = xml.attribute("srsDimension") {
                        context.dimension = dimension.parse().ok();
                        if open.is_none() {
                            self.common.dimension = context.dimension;
                        }
                    }
                    match &mut open {
                        None if MEMBERS.contains(&parent.as_str()) => {
                            open = Some(Open::new(self.number, &name, xml.depth()));
                            self.number += 1;
                        }
                        None => {}
                        Some(part) => {
                            part.has_elements = false;
                            if part.inner.is_none() && (is_geometry(&name) || name == "boundedBy") {
                                part.inner = Some(xml.depth());
                            }
                            if part.inner.is_some() {
                                let reversed = xml.attribute("orientation") == Some("-");
                                let direction =
                                    if reversed { geometry::Direction::Reversed } else { geometry::Direction::Kept };
                                part.geometry.start(&name, direction, &mut self.table);
                            }
                        }
                    }
                    around.push((name, context));
                }
                Step::Text if open.is_some() => text.push_str(xml.text()),
                Step::Text => {}
                Step::End => {
                    let (name, context) = around.pop().unwrap_or_default();
                    let Some(part) = &mut open else { continue };
                    // The depth of the element that ended.
                    let depth = xml.depth() + 1;
                    if depth == part.depth {
                        if let Some(part) = open.take() {
                            self.push(part);
                        }
                    } else if part.inner.is_some() {
                        let positions = if geometry::holds_positions(&name) {
                            self.positions(xml, &context, &name, &text, part.feature.number)?
                        } else {
                            Vec::new()
                        };
                        part.geometry.end(&name, positions, &mut part.feature, &self.table);
                        part.inner = part.inner.filter(|&inner| inner != depth);
                    } else if !part.has_elements {
                        self.table.note_text(&mut part.feature, &name, &text);
                    }
                    if let Some(part) = &mut open {
                        part.has_elements = true;
                    }
                    text.clear();
                }
                Step::Over => return Ok(()),
            }
        }
    }

    /// The positions of a text, with x to the east. z is NaN where there is none.
    fn positions(
        &mut self,
        xml: &Xml<'_, '_>,
        context: &Context,
        element: &str,
        text: &str,
        feature: u64,
    ) -> Result<Vec<[f64; 3]>> {
        let refuse = |what: String| xml.error(format!("feature {feature}: {what}"));
        let dimension = context.dimension.or(self.common.dimension);
        let mut positions = geometry::positions(element, text, dimension).map_err(&refuse)?;
        let Some(name) = context.srs.as_ref().or(self.common.srs.as_ref()) else { return Ok(positions) };
        let axes = self.systems.entry(name.clone()).or_insert_with(|| axes::of_name(name));
        let Some(axes) = axes else { return Ok(positions) };
        if matches!(element, "X" | "Y" | "Z") {
            // The element itself says which coordinate it is.
            return Ok(positions);
        }
        if axes.north_first {
            positions.iter_mut().for_each(|p| p.swap(0, 1));
        }
        if axes.crs.is_geographic()
            && let Some([x, y, _]) = positions.iter().find(|p| p[1].abs() > 90.0 || p[0].abs() > 360.0)
        {
            let order = if axes.north_first { "latitude" } else { "longitude" };
            let message = format!(
                "by the name {name:?} of its coordinate reference system the {order} comes first, but then a place is at \
                 longitude {x}, latitude {y}; rewrite the file with the right order or the right name"
            );
            return Err(refuse(message));
        }
        Ok(positions)
    }

    fn push(&mut self, part: Open) {
        let Open { mut feature, kind, geometry, .. } = part;
        let is_empty = feature.lines.is_empty() && feature.spots.is_empty() && feature.polygons.is_empty();
        if !feature.lines.is_empty() || !feature.polygons.is_empty() {
            *self.kinds.entry(kind.clone()).or_default() += 1;
        }
        if self.request.layer.is_some_and(|layer| layer != kind) {
            return;
        }
        if is_empty && !geometry.is_told() {
            self.table.leave_out(NO_GEOMETRY);
        }
        let field = self.table.field(LAYER);
        if self.table.wants(field) {
            self.table.note(&mut feature.values, field, Value::Text(kind));
        }
        self.table.push(feature);
    }

    fn finish(mut self, path: &Path) -> Result<Table> {
        if self.number == 0 {
            let message = "has no features that are read (in featureMember, featureMembers or member); convert it with \
                           'ogr2ogr out.gpkg FILE'";
            return Err(Error::file(path, message));
        }
        match self.request.layer {
            Some(layer) if self.table.features.is_empty() && !self.kinds.contains_key(layer) => {
                let kinds: Vec<String> = self.kinds.keys().map(|kind| format!("{kind:?}")).collect();
                let message = format!(
                    "there are no features of type {layer:?}; those with lines or areas are {}",
                    kinds.join(", ")
                );
                return Err(Error::file(path, message));
            }
            None if self.request.purpose == Purpose::Contours && self.kinds.len() > 1 => {
                let layers = self.kinds.into_keys().collect();
                return Err(Error::LayerAmbiguous { what: "lines", layers }.in_file(path));
            }
            _ => {}
        }
        let named: Vec<(&String, &Option<Axes>)> = self.systems.iter().collect();
        match named[..] {
            [] => {
                let problem = "the file does not name its coordinate reference system (srsName)";
                self.table.crs_problem = Some(problem.to_owned());
            }
            [(name, None)] => {
                let problem =
                    format!("the coordinate reference system {name:?} is not known; coordinates are taken as x, y");
                self.table.crs_problem = Some(problem);
            }
            [(_, Some(axes)), ref others @ ..]
                if others.iter().all(|(_, other)| other.as_ref().is_some_and(|other| other.crs.matches(&axes.crs))) =>
            {
                self.table.crs = Some(axes.crs.clone());
            }
            _ => {
                let names: Vec<String> = named.iter().map(|(name, _)| format!("{name:?}")).collect();
                let message = format!(
                    "has features in several coordinate reference systems ({}); write them in one, for instance with \
                     'ogr2ogr -t_srs EPSG:4326 out.gpkg FILE'",
                    names.join(", ")
                );
                return Err(Error::file(path, message));
            }
        }
        for doubt in self.systems.into_values().flatten().filter_map(|axes| axes.doubt) {
            self.table.findings.push(Finding::general(FindingKind::AxisOrder, doubt));
        }
        Ok(self.table)
    }
}

impl Open {
    fn new(number: u64, kind: &str, depth: usize) -> Self {
        Self {
            feature: Feature { number, ..Feature::default() },
            kind: kind.to_owned(),
            depth,
            geometry: Geometry::default(),
            inner: None,
            has_elements: false,
        }
    }
}

#[cfg(test)]
mod tests;
