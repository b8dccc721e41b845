//! Reads contours, spot heights and water from the documents of a path into one table.
//!
//! | element | what becomes of it |
//! |---|---|
//! | `Cntr` | a line with its attributes, among them `alti` (metres) and `type`, which marks depression contours |
//! | `ElevPt` | a point with the same attributes |
//! | `WA` | polygons of water; rivers are left out because they are not level, the sea lies at 0 m |
//! | `WL` | closed shores of lakes as polygons, if there is no `WA` |
//!
//! Documents give positions as latitude, longitude. The table has longitude, latitude. Lines and areas are cut at the
//! edges of the map's grid squares; their ends agree there.

use std::path::Path;

use glam::DVec2;

use super::archive::{each_document, nothing};
use super::datum::Datums;
use super::dem::check_root;
use super::tuples::number;
use crate::meter::DocumentReader;
use crate::shapefile::grouped;
use crate::table::{Feature, NO_GEOMETRY, Purpose, Request, Rings, Spot, Table, Value};
use crate::xml::{Step, Xml};
use tokosen_core::base::error::{Error, Finding, FindingKind, Result};
use tokosen_core::features::Role;

/// The attributes that are used.
const FIELDS: [&str; 6] = ["fid", "orgGILvl", "vis", "type", "name", "alti"];

/// The kinds of feature that are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Item {
    Contour,
    SpotHeight,
    WaterArea,
    WaterEdge,
}

impl Item {
    fn of(name: &str) -> Option<Self> {
        Some(match name {
            "Cntr" => Self::Contour,
            "ElevPt" => Self::SpotHeight,
            "WA" => Self::WaterArea,
            "WL" => Self::WaterEdge,
            _ => return None,
        })
    }

    fn name(self) -> &'static str {
        match self {
            Self::Contour => "Cntr",
            Self::SpotHeight => "ElevPt",
            Self::WaterArea => "WA",
            Self::WaterEdge => "WL",
        }
    }
}

/// Reads the features of a path that the request needs. They are numbered from 0 in the order of the documents.
pub(crate) fn read(path: &Path, request: &Request<'_>) -> Result<Table> {
    let (items, words): (&[Item], &str) = match request.purpose {
        Purpose::Contours => (&[Item::Contour, Item::SpotHeight], "contour (Cntr) or spot height (ElevPt)"),
        Purpose::Spots => (&[Item::SpotHeight], "spot height (ElevPt)"),
        Purpose::Features(Role::Water) => (&[Item::WaterArea, Item::WaterEdge], "water (WA, WL)"),
        Purpose::Area => {
            let message = "files of 基盤地図情報 hold no frame; name a file with a polygon, or take hull or bbox";
            return Err(Error::file(path, message));
        }
        Purpose::Places => {
            return Err(Error::file(path, "files of 基盤地図情報 hold no such points; name a file with points"));
        }
        Purpose::Features(role) => {
            let (many, shapes) = (role.many(), role.shapes().words());
            let message = format!("no {many} are read from files of 基盤地図情報; name a file with {shapes}");
            return Err(Error::file(path, message));
        }
    };
    if let Some(layer) = request.layer {
        return Err(Error::file(path, format!("there is no layer {layer:?}: files of this format have no layers")));
    }
    let mut reading = Reading {
        items,
        table: Table::new(request),
        datums: Datums::default(),
        number: 0,
        shores: Vec::new(),
        rivers: 0,
        open_edges: 0,
    };
    let wanted = |name: &str| items.iter().any(|item| item.name().eq_ignore_ascii_case(name));
    let report = each_document(path, &wanted, &mut |path, source| reading.document(path, source))?;
    if reading.number == 0 {
        return Err(nothing(path, &report, words));
    }
    report.note_repeated(&mut reading.table.findings);
    Ok(reading.finish())
}

/// What is kept from document to document.
struct Reading<'a> {
    items: &'a [Item],
    table: Table,
    datums: Datums,
    number: u64,
    /// Closed shores of lakes.
    shores: Vec<Vec<DVec2>>,
    rivers: u64,
    open_edges: u64,
}

/// A feature that is not read completely.
struct PartialFeature {
    item: Item,
    /// The feature's id in the document, for messages.
    fid: String,
    kind: String,
    feature: Feature,
    lines: Vec<Vec<DVec2>>,
    rings: Rings,
    /// The current line or ring; positions are appended to it.
    current: Vec<DVec2>,
    /// Whether a ring element is open.
    in_ring: bool,
}

impl Reading<'_> {
    fn document(&mut self, path: &Path, source: &mut DocumentReader<'_>) -> Result<()> {
        let mut xml = Xml::new(path, source)?;
        let mut partial: Option<PartialFeature> = None;
        let mut text = String::new();
        loop {
            match xml.next()? {
                Step::Start => {
                    check_root(&xml)?;
                    text.clear();
                    if xml.depth() == 2 {
                        let item = Item::of(xml.name()).filter(|item| self.items.contains(item));
                        partial = item.map(|item| PartialFeature::new(item, self.number));
                        self.number += u64::from(item.is_some());
                    }
                    let Some(partial) = &mut partial else { continue };
                    if let Some(name) = xml.attribute("srsName") {
                        self.datums.note(path, name)?;
                    }
                    if let Some(dimension) = xml.attribute("srsDimension").filter(|dimension| *dimension != "2") {
                        return Err(
                            partial.error(path, &format!("its positions have {dimension} numbers instead of two"))
                        );
                    }
                    partial.start(xml.name());
                }
                Step::Text if partial.is_some() => text.push_str(xml.text()),
                Step::Text => {}
                Step::End if xml.depth() == 1 => {
                    if let Some(partial) = partial.take() {
                        self.push(partial);
                    }
                }
                Step::End => {
                    if let Some(partial) = &mut partial {
                        if xml.depth() == 2 && FIELDS.contains(&xml.name()) {
                            self.note(partial, path, xml.name(), text.trim())?;
                        }
                        partial.end(xml.name(), &text).map_err(|what| partial.error(path, &what))?;
                    }
                    text.clear();
                }
                Step::Over => return Ok(()),
            }
        }
    }

    /// Records an attribute.
    fn note(&mut self, partial: &mut PartialFeature, path: &Path, name: &str, text: &str) -> Result<()> {
        match name {
            "fid" => text.clone_into(&mut partial.fid),
            "type" => text.clone_into(&mut partial.kind),
            _ => {}
        }
        let value = match number(text.as_bytes()) {
            _ if text.is_empty() => Value::Null,
            Some(number) => Value::Number(number),
            None if name == "alti" => {
                return Err(partial.error(path, &format!("its elevation (alti) is {text:?}, which is not a number")));
            }
            None => Value::Text(text.to_owned()),
        };
        let field = self.table.field(name);
        if self.table.wants(field) {
            self.table.note(&mut partial.feature.values, field, value);
        }
        Ok(())
    }

    /// Stores a complete feature.
    fn push(&mut self, mut partial: PartialFeature) {
        let is_empty =
            partial.lines.is_empty() && partial.feature.spots.is_empty() && partial.feature.polygons.is_empty();
        match partial.item {
            _ if is_empty => self.table.leave_out(NO_GEOMETRY),
            Item::WaterArea if partial.kind == "河川" => self.rivers += 1,
            Item::WaterEdge => {
                for line in partial.lines {
                    let is_shore = partial.kind.contains("湖池") && line.len() >= 4 && line.first() == line.last();
                    if is_shore { self.shores.push(line) } else { self.open_edges += 1 }
                }
            }
            Item::WaterArea | Item::Contour | Item::SpotHeight => {
                for line in partial.lines {
                    partial.feature.push_line(line, &[]);
                }
                if partial.item == Item::WaterArea && partial.kind == "海" {
                    let field = self.table.field("alti");
                    self.table.note(&mut partial.feature.values, field, Value::Number(0.0));
                }
                self.table.push(partial.feature);
            }
        }
    }

    fn finish(mut self) -> Table {
        self.table.height_system = self.datums.height_system(&mut self.table.findings);
        self.table.crs = self.datums.crs(&mut self.table.findings);
        self.table.in_pieces = true;
        let mut left_out = |count: u64, what: &str| {
            if count > 0 {
                let message = format!("{count} {what}");
                self.table.findings.push(Finding::general(FindingKind::SkippedFeature, message));
            }
        };
        left_out(self.rivers, "rivers among the water areas (WA) left out: they are not level");
        left_out(self.open_edges, "water edges (WL) left out: they are not closed lake shores");
        if self.table.features.iter().any(|feature| !feature.polygons.is_empty()) {
            left_out(self.shores.len() as u64, "shores of lakes (WL) left out: the water areas (WA) are taken");
        } else {
            for (number, rings) in (0..).zip(grouped(self.shores)) {
                self.table.push(Feature { number, polygons: vec![rings], ..Feature::default() });
            }
        }
        self.table
    }
}

impl PartialFeature {
    fn new(item: Item, number: u64) -> Self {
        Self {
            item,
            fid: String::new(),
            kind: String::new(),
            feature: Feature { number, ..Feature::default() },
            lines: Vec::new(),
            rings: Vec::new(),
            current: Vec::new(),
            in_ring: false,
        }
    }

    fn error(&self, path: &Path, what: &str) -> Error {
        let (item, number) = (self.item.name(), self.feature.number);
        let fid = if self.fid.is_empty() { format!("feature {number}") } else { self.fid.clone() };
        Error::file(path, format!("{item} {fid}: {what}"))
    }

    fn start(&mut self, name: &str) {
        match name {
            "Ring" | "LinearRing" => {
                self.in_ring = true;
                self.current.clear();
            }
            "Curve" | "LineString" | "Point" if !self.in_ring => self.current.clear(),
            _ => {}
        }
    }

    fn end(&mut self, name: &str, text: &str) -> Result<(), String> {
        match name {
            "posList" | "pos" => self.append(text)?,
            "Point" => {
                let spots = self.current.drain(..).map(|place| Spot { place, z: None });
                self.feature.spots.extend(spots);
            }
            "Curve" | "LineString" if !self.in_ring && !self.current.is_empty() => {
                self.lines.push(std::mem::take(&mut self.current));
            }
            "Ring" | "LinearRing" => {
                self.in_ring = false;
                self.rings.push(std::mem::take(&mut self.current));
            }
            "PolygonPatch" | "Polygon" if !self.rings.is_empty() => {
                self.feature.polygons.push(std::mem::take(&mut self.rings));
            }
            _ => {}
        }
        Ok(())
    }

    /// Appends positions. Consecutive segments of a line, and lines of a ring, repeat their common point.
    fn append(&mut self, text: &str) -> Result<(), String> {
        let mut numbers = text.split_ascii_whitespace();
        let parsed = |word: &str| number(word.as_bytes()).ok_or_else(|| format!("its positions hold {word:?}"));
        let mut is_first = true;
        while let Some(lat) = numbers.next() {
            let Some(lon) = numbers.next() else {
                return Err("its positions have an odd number of coordinates".to_owned());
            };
            let (lat, lon) = (parsed(lat)?, parsed(lon)?);
            if lat.abs() > 90.0 || lon.abs() > 180.0 {
                return Err(format!("its position {lat} {lon} is not a latitude and longitude"));
            }
            let place = DVec2::new(lon, lat);
            if !(is_first && self.current.last() == Some(&place)) {
                self.current.push(place);
            }
            is_first = false;
        }
        Ok(())
    }
}
