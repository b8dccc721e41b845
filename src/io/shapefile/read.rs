//! Reads a shapefile into a table.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use glam::DVec2;
use shapefile::{PolygonRing, Shape, ShapeReader};

use super::companion::companion;
use super::{dbf, polygon};
use crate::ordinary::open_to_read;
use crate::table::{Feature, NO_GEOMETRY, Request, Spot, Table};
use tokosen_core::base::error::{Error, Result};
use tokosen_core::crs::Crs;

/// Reads a shapefile. Records are numbered from 0, as GIS programs show them.
///
/// Without the attribute table only the z coordinate can give the elevation. The index is used if it is present and
/// valid. Otherwise the shapes are read in file order.
pub(crate) fn read(path: &Path, request: &Request<'_>) -> Result<Table> {
    let mut shapes = open(path)?;
    let mut table = Table::new(request);
    let dbf_path = companion(path, "dbf");
    let label = read_text(&companion(path, "cpg"))?;
    let mut attributes = match dbf_path.exists() {
        true => Some(dbf::Reader::open(&dbf_path, label.as_deref(), request.elevation_field)?),
        false => None,
    };
    if attributes.as_ref().is_some_and(|reader| !reader.is_sure) {
        table.fields_note = Some(encoding_note(path));
    }
    let fields: Vec<usize> = match &attributes {
        Some(reader) => reader.names.clone().iter().map(|name| table.field(name)).collect(),
        None => Vec::new(),
    };
    let mut number = 0;
    for shape in shapes.iter_shapes() {
        let shape = shape.map_err(|e| {
            Error::file_cause(path, format!("the shape {number} cannot be read; the file is broken or not complete"), e)
        })?;
        let mut feature = Feature { number, ..Feature::default() };
        number += 1;
        let mut is_deleted = false;
        if let Some(reader) = &mut attributes {
            if number > u64::from(reader.record_count) {
                return Err(mismatch(path, &format!("more than {}", reader.record_count), reader.record_count));
            }
            let record = number - 1;
            is_deleted = !reader.advance().map_err(|e| {
                Error::file_cause(&dbf_path, format!("the record {record} cannot be read; the file is not complete"), e)
            })?;
            for (column, &field) in fields.iter().enumerate() {
                if !is_deleted && table.wants(field) {
                    table.note(&mut feature.values, field, reader.value(column));
                }
            }
        }
        if !is_deleted {
            add_shape(shape, &mut feature, &mut table);
            table.push(feature);
        }
    }
    if let Some(reader) = attributes.filter(|reader| u64::from(reader.record_count) != number) {
        return Err(mismatch(path, &number.to_string(), reader.record_count));
    }
    match read_text(&companion(path, "prj"))? {
        Some(text) if !text.trim().is_empty() => table.crs = Some(Crs::from_wkt(text.trim_start_matches('\u{feff}'))),
        Some(_) => table.crs_problem = Some("the shapefile's .prj file is empty".to_owned()),
        None => table.crs_problem = Some("the shapefile has no .prj file beside it".to_owned()),
    }
    Ok(table)
}

/// How to name the encoding of a shapefile, as the end of a message about its fields.
fn encoding_note(path: &Path) -> String {
    format!(
        "; the file does not say in which encoding the names are: write it into {}, for instance EUC-KR, GBK, Big5, Shift_JIS \
         or 1251",
        path.with_extension("cpg").display()
    )
}

fn mismatch(path: &Path, shapes: &str, records: u32) -> Error {
    Error::file(
        path,
        format!("there are {shapes} shapes, but {records} records in the .dbf file: they do not belong together"),
    )
}

fn open(path: &Path) -> Result<ShapeReader<BufReader<File>>> {
    let source = || open_to_read(path).map(BufReader::new);
    if let Ok(index) = File::open(companion(path, "shx"))
        && let Ok(reader) = ShapeReader::with_shx(source()?, BufReader::new(index))
    {
        return Ok(reader);
    }
    ShapeReader::new(source()?).map_err(|e| {
        Error::file_cause(path, "the file is not a shapefile, or it is broken; copy or export it again", e)
    })
}

/// The content of a small text file, if it exists. Bytes that are not UTF-8 only occur in names that are not looked
/// for.
fn read_text(path: &Path) -> Result<Option<String>> {
    match std::fs::read(path) {
        Ok(bytes) => Ok(Some(String::from_utf8_lossy(&bytes).into_owned())),
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => Ok(None),
        Err(e) => Err(Error::io("read", path, e)),
    }
}

fn add_shape(shape: Shape, feature: &mut Feature, table: &mut Table) {
    let mut spot = |x: f64, y: f64, z: Option<f64>| feature.spots.push(Spot { place: DVec2::new(x, y), z });
    match shape {
        Shape::NullShape => table.leave_out(NO_GEOMETRY),
        Shape::Point(p) => spot(p.x, p.y, None),
        Shape::PointM(p) => spot(p.x, p.y, None),
        Shape::PointZ(p) => spot(p.x, p.y, Some(p.z)),
        Shape::Multipoint(points) => points.points().iter().for_each(|p| spot(p.x, p.y, None)),
        Shape::MultipointM(points) => points.points().iter().for_each(|p| spot(p.x, p.y, None)),
        Shape::MultipointZ(points) => points.points().iter().for_each(|p| spot(p.x, p.y, Some(p.z))),
        Shape::Polyline(line) => {
            for part in line.parts() {
                feature.push_line(part.iter().map(|p| DVec2::new(p.x, p.y)).collect(), &[]);
            }
        }
        Shape::PolylineM(line) => {
            for part in line.parts() {
                feature.push_line(part.iter().map(|p| DVec2::new(p.x, p.y)).collect(), &[]);
            }
        }
        Shape::PolylineZ(line) => {
            for part in line.parts() {
                let z: Vec<f64> = part.iter().map(|p| p.z).collect();
                feature.push_line(part.iter().map(|p| DVec2::new(p.x, p.y)).collect(), &z);
            }
        }
        Shape::Polygon(p) if table.wants_rings => push_rings(p.rings(), |p| DVec2::new(p.x, p.y), None, feature),
        Shape::PolygonM(p) if table.wants_rings => push_rings(p.rings(), |p| DVec2::new(p.x, p.y), None, feature),
        Shape::PolygonZ(p) if table.wants_rings => {
            push_rings(p.rings(), |p| DVec2::new(p.x, p.y), Some(|p| p.z), feature);
        }
        Shape::Polygon(_) | Shape::PolygonM(_) | Shape::PolygonZ(_) if !table.wants_polygons => {
            table.leave_out("Polygon");
        }
        Shape::Polygon(p) => add_rings(p.into_inner(), |p| DVec2::new(p.x, p.y), feature, table),
        Shape::PolygonM(p) => add_rings(p.into_inner(), |p| DVec2::new(p.x, p.y), feature, table),
        Shape::PolygonZ(p) => {
            let rings = p.into_inner();
            let z: Vec<f64> = rings.iter().flat_map(|ring| ring.points()).map(|p| p.z).collect();
            feature.note_polygon_z(&z);
            add_rings(rings, |p| DVec2::new(p.x, p.y), feature, table);
        }
        Shape::Multipatch(_) => table.leave_out("MultiPatch"),
    }
}

/// Adds rings as lines.
fn push_rings<P>(rings: &[PolygonRing<P>], place: fn(&P) -> DVec2, z: Option<fn(&P) -> f64>, feature: &mut Feature) {
    for ring in rings {
        let z: Vec<f64> = z.map(|z| ring.points().iter().map(z).collect()).unwrap_or_default();
        feature.push_ring("Polygon", ring.points().iter().map(place).collect(), &z);
    }
}

fn add_rings<P>(rings: Vec<PolygonRing<P>>, place: fn(&P) -> DVec2, feature: &mut Feature, table: &mut Table) {
    let rings: Vec<Vec<DVec2>> =
        rings.iter().filter(|ring| !ring.is_empty()).map(|ring| ring.points().iter().map(place).collect()).collect();
    if rings.is_empty() {
        table.leave_out(NO_GEOMETRY);
    }
    feature.polygons.extend(polygon::grouped(rings));
}
