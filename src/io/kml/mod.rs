//! Reads KML (OGC 12-007r2) and KMZ: placemarks with points, lines and polygons. All documents of a KMZ are read: its main
//! document often only links to the others.
//!
//! Coordinates are always longitude and latitude in WGS 84. A third number is an elevation only if the altitude mode is
//! `absolute`; otherwise it counts from the ground, or viewers do not use it. Attributes are the name, the description,
//! the extended data, and the rows of a table in the description, as ArcGIS writes them.

mod description;
mod looks;
mod shapes;
mod write;

use std::io::BufReader;
use std::path::Path;

use super::gsi::archive::has_extension;
use super::meter::{DocumentReader, LimitedReader, MAX_DOCUMENT_LENGTH};
use super::table::{Feature, NO_GEOMETRY, Request, Table};
use super::xml::{Step, Xml};
use super::zipped;
use crate::ordinary::open_to_read;
use shapes::Shapes;
use tokosen_core::base::error::{Error, Finding, FindingKind, Result};
use tokosen_core::base::memory;
use tokosen_core::crs::Crs;

pub(super) use write::write;

const BUFFER: usize = 1 << 17;
/// Memory per byte of text: positions and attributes.
const BYTES_PER_BYTE: f64 = 2.0;

/// What is kept from document to document.
struct Reading {
    table: Table,
    /// Whether z is taken in every altitude mode.
    takes_any_z: bool,
    number: u64,
    /// Placemarks with a z that is not taken.
    not_taken: u64,
    /// Links to other files.
    links: u64,
}

/// Reads the placemarks of a file. They are numbered from 0, in the order of the file.
pub(super) fn read(path: &Path, request: &Request<'_>) -> Result<Table> {
    let takes_any_z = request.elevation_field.is_some_and(|named| named.eq_ignore_ascii_case("z"));
    let mut reading = Reading { table: Table::new(request), takes_any_z, number: 0, not_taken: 0, links: 0 };
    if has_extension(path, "kmz") {
        let mut documents = 0;
        zipped::each_document(path, "kml", &mut |inner, source| {
            documents += 1;
            reading.document(inner, source)
        })?;
        // The links of a main document lead to the other documents.
        reading.links = if documents > 1 { 0 } else { reading.links };
        return Ok(reading.finish());
    }
    let file = open_to_read(path)?;
    let length = file.metadata().map_err(|e| Error::io("read", path, e))?.len();
    let remedy = "clip the map first, or save it as a GeoPackage";
    memory::check(
        BYTES_PER_BYTE * length as f64,
        request.memory,
        format!("reading {} as a whole", path.display()),
        remedy,
    )?;
    let mut file = BufReader::with_capacity(BUFFER, file);
    reading.document(path, &mut LimitedReader::new(&mut file, MAX_DOCUMENT_LENGTH))?;
    Ok(reading.finish())
}

/// A placemark that is not read completely.
struct Placemark {
    feature: Feature,
    shapes: Shapes,
    /// The depth of its element.
    depth: usize,
    /// The name of the extended datum that is open.
    datum: Option<String>,
}

impl Reading {
    fn document(&mut self, path: &Path, source: &mut DocumentReader<'_>) -> Result<()> {
        let mut xml = Xml::new(path, source)?;
        let table = &mut self.table;
        let mut open: Option<Placemark> = None;
        let mut text = String::new();
        loop {
            match xml.next()? {
                Step::Start => {
                    if xml.depth() == 1 && !matches!(xml.name(), "kml" | "Document" | "Folder" | "Placemark") {
                        return Err(xml.error(format!("its first element is {}, not kml: it is not KML", xml.name())));
                    }
                    text.clear();
                    match (&mut open, xml.name()) {
                        (None, "Placemark") => {
                            let feature = Feature { number: self.number, ..Feature::default() };
                            self.number += 1;
                            let shapes = Shapes::new(self.takes_any_z);
                            open = Some(Placemark { feature, shapes, depth: xml.depth(), datum: None });
                        }
                        (None, "NetworkLink") => self.links += 1,
                        (None, _) => {}
                        (Some(placemark), "Data" | "SimpleData") => {
                            placemark.datum = xml.attribute("name").map(str::to_owned);
                        }
                        (Some(placemark), name) => placemark.shapes.start(name, table),
                    }
                }
                Step::Text if open.is_some() => text.push_str(xml.text()),
                Step::Text => {}
                Step::End => {
                    let Some(placemark) = &mut open else { continue };
                    // The depth is that of the element around the one that ended.
                    let is_direct = xml.depth() == placemark.depth;
                    match xml.name() {
                        "Placemark" if xml.depth() < placemark.depth => {
                            let Some(Placemark { feature, shapes, .. }) = open.take() else { continue };
                            self.not_taken += u64::from(shapes.has_other_z());
                            let is_empty =
                                feature.lines.is_empty() && feature.spots.is_empty() && feature.polygons.is_empty();
                            if is_empty && !shapes.is_told() {
                                table.leave_out(NO_GEOMETRY);
                            }
                            table.push(feature);
                            continue;
                        }
                        "SimpleData" | "value" => {
                            if let Some(name) = placemark.datum.take() {
                                table.note_text(&mut placemark.feature, &name, &text);
                            }
                        }
                        "Data" => placemark.datum = None,
                        "name" if is_direct => table.note_text(&mut placemark.feature, "name", &text),
                        "description" if is_direct => {
                            let rows = description::rows(&text);
                            if rows.is_empty() {
                                table.note_text(&mut placemark.feature, "description", &text);
                            }
                            rows.iter().for_each(|(name, value)| table.note_text(&mut placemark.feature, name, value));
                        }
                        name => {
                            let Placemark { feature, shapes, .. } = placemark;
                            shapes
                                .end(name, &text, feature, table)
                                .map_err(|what| xml.error(format!("placemark {}: {what}", feature.number)))?;
                        }
                    }
                    text.clear();
                }
                Step::Over => return Ok(()),
            }
        }
    }

    fn finish(self) -> Table {
        let Self { mut table, not_taken, links, .. } = self;
        table.crs = Some(Crs::wgs84());
        (0..links).for_each(|_| table.leave_out("NetworkLink"));
        if not_taken > 0 {
            let message = format!(
                "the z of {not_taken} placemarks is not taken as their elevation: their altitude mode is not absolute, so it \
             counts from the ground or is not used; the field z takes it all the same"
            );
            table.findings.push(Finding::general(FindingKind::SkippedFeature, message));
            table.fields_note = Some(
            "; its z counts from the ground or is not used, by its altitude mode: the field z takes it all the same"
                .into(),
        );
        }
        table
    }
}

#[cfg(test)]
mod tests;
