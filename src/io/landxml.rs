//! Reads surfaces in LandXML 1.0 to 1.2: their source data, which are contours, break lines, points and boundaries, and in
//! [`surface`] their triangles.
//!
//! Coordinates are northing, easting and elevation. What is read depends on the purpose: contours and points of the data as a map of
//! contours, the break lines as break lines, points alone as spot heights (those of the triangles if there are no others), and
//! outer boundaries as areas.

mod surface;

use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use glam::DVec2;

use super::meter::{LimitedReader, MAX_DOCUMENT_LENGTH};
use super::table::{Feature, Purpose, Request, Spot, Table};
use super::xml::{Step, Xml};
use crate::ordinary::open_to_read;
use surface::is_surface;
pub(crate) use surface::read_surface;
use tokosen_core::base::error::{Error, Result};
use tokosen_core::base::{ElevationUnit, memory};
use tokosen_core::contour::UnitHint;
use tokosen_core::crs::{Crs, LengthUnit};
use tokosen_core::features::Role;

const BUFFER: usize = 1 << 17;
/// Bytes at the beginning in which the first element is.
const HEAD: u64 = 4096;
/// Memory per byte of text.
const BYTES_PER_BYTE: f64 = 2.0;

/// Whether an XML document is LandXML. What cannot be read is not.
pub(super) fn is_landxml(path: &Path) -> bool {
    let mut head = Vec::new();
    let read = open_to_read(path).map(|file| file.take(HEAD).read_to_end(&mut head));
    read.is_ok_and(|read| read.is_ok()) && head.windows(8).any(|bytes| bytes == b"<LandXML")
}

/// Whether a file is LandXML with triangles and without contours, so that it is read as a height map.
pub(super) fn is_landxml_surface(path: &Path) -> Result<bool> {
    let is_xml = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("xml"));
    Ok(is_xml && is_landxml(path) && is_surface(path)?)
}

/// What the positions of a list belong to.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Part {
    /// A contour with this elevation.
    Contour(f64),
    BreakLine,
    /// Points of the data.
    Points,
    /// The border of a surface.
    Boundary,
}

/// Reads the features of a file. They are numbered from 1, in the order of the file.
pub(super) fn read(path: &Path, request: &Request<'_>) -> Result<Table> {
    let length = open_to_read(path)?.metadata().map_err(|e| Error::io("read", path, e))?.len();
    let what = format!("reading {} as a whole", path.display());
    memory::check(BYTES_PER_BYTE * length as f64, request.memory, what, "export a part of the surface")?;
    with_document(path, |xml| source_data(xml, request))
}

/// Lets a reader go through a document.
fn with_document<T>(path: &Path, read: impl FnOnce(&mut Xml<'_, '_>) -> Result<T>) -> Result<T> {
    let mut file = BufReader::with_capacity(BUFFER, open_to_read(path)?);
    let mut source = LimitedReader::new(&mut file as &mut dyn BufRead, MAX_DOCUMENT_LENGTH);
    read(&mut Xml::new(path, &mut source)?)
}

fn source_data(xml: &mut Xml<'_, '_>, request: &Request<'_>) -> Result<Table> {
    let mut table = Table::new(request);
    let mut part: Option<Part> = None;
    let (mut text, mut number, mut triangles) = (String::new(), 0, 0);
    // Points of triangles, in case there are no others.
    let mut corners: Vec<Spot> = Vec::new();
    loop {
        match xml.next()? {
            Step::Start => {
                if xml.depth() == 1 && xml.name() != "LandXML" {
                    return Err(xml.error(format!("its first element is {}, not LandXML", xml.name())));
                }
                text.clear();
                match xml.name() {
                    "Metric" | "Imperial" => units(xml, &mut table)?,
                    "CoordinateSystem" => table.crs = system(xml).or(table.crs.take()),
                    "Contour" => {
                        let elevation = xml.attribute("elev").and_then(|elevation| elevation.parse().ok());
                        let missing = || xml.error(format!("contour {} has no elevation", number + 1));
                        part = Some(Part::Contour(elevation.ok_or_else(missing)?));
                    }
                    "Breakline" => part = Some(Part::BreakLine),
                    "DataPoint" | "DataPoints" => part = Some(Part::Points),
                    "Boundary" => part = Some(Part::Boundary),
                    _ => {}
                }
            }
            Step::Text => text.push_str(xml.text()),
            Step::End => {
                match (xml.name(), part) {
                    ("PntList2D" | "PntList3D", Some(part)) => {
                        number += 1;
                        let size = if xml.name() == "PntList3D" { 3 } else { 2 };
                        let positions =
                            positions(&text, size).map_err(|what| xml.error(format!("list {number}: {what}")))?;
                        push(&mut table, request.purpose, part, number, positions);
                    }
                    ("P", _) if wants_points(request.purpose) => {
                        let (places, z) = positions(&text, 3).map_err(|what| xml.error(format!("a point: {what}")))?;
                        corners.extend(places.iter().zip(z).map(|(place, z)| Spot { place: *place, z: Some(z) }));
                    }
                    ("F", _) => triangles += 1,
                    ("Contour" | "Breakline" | "DataPoints" | "DataPoint" | "Boundary", _) => part = None,
                    _ => {}
                }
                text.clear();
            }
            Step::Over => break,
        }
    }
    if table.features.is_empty() && !corners.is_empty() {
        table.push(Feature { number: 1, spots: corners, ..Feature::default() });
    }
    if triangles > 0 && request.purpose == Purpose::Contours {
        table.left_out.insert("triangle".to_owned(), triangles);
    }
    Ok(table)
}

/// Whether points alone are asked for.
fn wants_points(purpose: Purpose) -> bool {
    matches!(purpose, Purpose::Spots | Purpose::Places)
}

/// Adds the positions of a list, if the purpose wants them.
fn push(table: &mut Table, purpose: Purpose, part: Part, number: u64, (points, z): (Vec<DVec2>, Vec<f64>)) {
    let mut feature = Feature { number, ..Feature::default() };
    let z = |k: usize| z.get(k).copied();
    match (part, purpose) {
        (Part::Contour(elevation), Purpose::Contours) => {
            feature.push_line(points.clone(), &vec![elevation; points.len()]);
        }
        (Part::Points, Purpose::Contours | Purpose::Spots | Purpose::Places) => {
            feature.spots = points.iter().enumerate().map(|(k, place)| Spot { place: *place, z: z(k) }).collect();
        }
        (Part::BreakLine, Purpose::Features(Role::BreakLines | Role::Cliffs)) => {
            let heights: Vec<f64> = (0..points.len()).filter_map(z).collect();
            feature.push_line(points, &heights);
        }
        (Part::Boundary, Purpose::Area) => feature.polygons = vec![vec![points]],
        _ => return,
    }
    table.push(feature);
}

/// Northings, eastings and heights of a text, as places and heights. Lists of two numbers have no heights.
fn positions(text: &str, size: usize) -> Result<(Vec<DVec2>, Vec<f64>), String> {
    let number = |word: &str| word.parse::<f64>().map_err(|_| format!("{word:.40} is no number"));
    let numbers = text.split_whitespace().map(number).collect::<Result<Vec<f64>, String>>()?;
    if numbers.len() % size != 0 {
        return Err(format!("{} numbers are no positions of {size} numbers each", numbers.len()));
    }
    let places = numbers.chunks_exact(size).map(|p| DVec2::new(p[1], p[0])).collect();
    let heights = if size == 3 { numbers.chunks_exact(size).map(|p| p[2]).collect() } else { Vec::new() };
    Ok((places, heights))
}

/// The coordinate reference system that an element names, if its code is known.
fn system(xml: &Xml<'_, '_>) -> Option<Crs> {
    let code = xml.attribute("epsgCode").and_then(|code| code.parse::<u32>().ok());
    code.map(Crs::from_epsg).filter(|crs| crs.kind().is_some())
}

/// Notes the unit of lengths. Elevations should be in it too.
fn units(xml: &Xml<'_, '_>, table: &mut Table) -> Result<()> {
    let Some(unit) = length_unit(xml)? else { return Ok(()) };
    if ElevationUnit::of_size(unit.metres).is_some() {
        let says = format!("the file states lengths in the unit {}, so elevations seem to be in feet", unit.name);
        table.unit_hint = Some(UnitHint { says, is_feet: true });
    }
    table.plane_unit = Some(unit);
    Ok(())
}

/// The unit of lengths that an element states, unless it is the metre.
fn length_unit(xml: &Xml<'_, '_>) -> Result<Option<LengthUnit>> {
    let (name, metres) = match xml.attribute("linearUnit") {
        None | Some("meter") => return Ok(None),
        Some("foot") => ("foot", 0.3048),
        Some("USSurveyFoot") => ("US survey foot", 1200.0 / 3937.0),
        Some("millimeter") => ("millimetre", 1e-3),
        Some("centimeter") => ("centimetre", 1e-2),
        Some("kilometer") => ("kilometre", 1e3),
        Some(other) => return Err(xml.error(format!("its linear unit {other} is not known here"))),
    };
    Ok(Some(LengthUnit { name: name.to_owned(), metres }))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = r#"<?xml version="1.0"?>
<LandXML xmlns="http://www.landxml.org/schema/LandXML-1.2" version="1.2"><Units><Metric linearUnit="meter"/></Units>
<CoordinateSystem epsgCode="6677"/><Surfaces><Surface name="s"><SourceData>
<Contours><Contour elev="20"><PntList2D>10 1 11 2 12 3</PntList2D></Contour></Contours>
<Breaklines><Breakline brkType="standard" name="a"><PntList3D>0 5 100.5 1 6 101</PntList3D></Breakline></Breaklines>
<DataPoints><PntList3D>7 8 9</PntList3D></DataPoints>
<Boundaries><Boundary bndType="outer"><PntList2D>0 0 0 9 9 9 0 0</PntList2D></Boundary></Boundaries></SourceData>
<Definition surfType="TIN"><Pnts><P id="1">1 2 3</P><P id="2">4 5 6</P><P id="3">7 8 9</P></Pnts><Faces><F>1 2 3</F></Faces></Definition>
</Surface></Surfaces></LandXML>"#;

    fn table(text: &str, purpose: Purpose) -> Result<Table> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("s.xml");
        std::fs::write(&path, text).unwrap();
        assert_eq!(is_landxml(&path), text.contains("<LandXML"));
        read(&path, &Request { elevation_field: None, layer: None, purpose, memory: None, within: None })
    }

    #[test]
    fn each_purpose_gets_its_part_with_east_before_north() {
        let of = |purpose: Purpose| table(TEXT, purpose).unwrap();
        let map = of(Purpose::Contours);
        assert_eq!(map.crs.as_ref().and_then(|crs| crs.epsg), Some(6677));
        let line = &map.features[0].lines[0];
        assert_eq!((line.points[0], line.z), (DVec2::new(1.0, 10.0), Some([20.0; 2])));
        assert_eq!((map.features.len(), map.features[1].spots[0].z), (2, Some(9.0)));
        let lines = of(Purpose::Features(Role::BreakLines));
        assert_eq!(lines.features.len(), 1);
        assert_eq!(lines.features[0].lines[0].heights, [100.5, 101.0]);
        assert_eq!(of(Purpose::Area).features[0].polygons[0][0].len(), 4);
        assert_eq!(of(Purpose::Spots).features[0].spots.len(), 1);
        // Without points of the data, the corners of the triangles are the points.
        let bare = TEXT.replace("DataPoints", "Other");
        assert_eq!(table(&bare, Purpose::Spots).unwrap().features[0].spots.len(), 3);
    }

    #[test]
    fn what_is_wrong_is_said() {
        let wrong = |from: &str, to: &str| {
            let text = TEXT.replace(from, to);
            table(&text, Purpose::Contours).map(|_| ()).unwrap_err().to_string()
        };
        assert!(wrong("10 1 11 2 12 3", "10 1 11").contains("3 numbers are no positions of 2 numbers each"));
        assert!(wrong("10 1 11", "10 x 11").contains("x is no number"));
        assert!(wrong("elev=\"20\"", "").contains("has no elevation"));
        assert!(wrong("linearUnit=\"meter\"", "linearUnit=\"mile\"").contains("mile"));
        assert!(wrong("</LandXML>", "").contains("cut off"));
        let feet = table(&TEXT.replace("\"meter\"", "\"foot\""), Purpose::Contours).unwrap();
        assert_eq!(feet.plane_unit.map(|unit| unit.metres), Some(0.3048));
        assert!(feet.unit_hint.is_some_and(|hint| hint.is_feet));
    }
}
