//! Writes layers as KML or KMZ, for phones and globes.
//!
//! A layer is a folder, with a folder in it for each kind of feature, so that a phone can show index contours alone. A contour is
//! called by its elevation. Shapes lie on the ground of the viewer (`clampToGround`): its terrain differs from that of the map,
//! and lines at their own heights would float above it or vanish below it. Elevations are attributes.

use std::collections::BTreeSet;
use std::fs::File;
use std::io::{BufWriter, Result as Written, Write};
use std::path::Path;

use glam::DVec2;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::looks::{Look, escaped};
use crate::gsi::archive::has_extension;
use crate::layer::{Cell, Kind, Layer, Outer, Row, Shape};
use crate::maker::MADE_BY;
use tokosen_core::base::ElevationUnit;
use tokosen_core::base::error::{Error, Result};

/// Decimals of degrees: about a centimetre.
const DECIMALS: usize = 7;

/// Writes one file: `.kmz` as an archive with a KML in it, otherwise a KML. Coordinates are longitudes and latitudes on WGS 84, and
/// the attributes that are heights are in `unit`.
pub(crate) fn write(path: &Path, layers: &[Layer<'_>], unit: ElevationUnit) -> Result<()> {
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let run = || -> Written<()> {
        let file = BufWriter::with_capacity(1 << 16, File::create(path)?);
        if !has_extension(path, "kmz") {
            let mut file = file;
            document(&mut file, &name, layers, unit)?;
            return file.flush();
        }
        let mut archive = ZipWriter::new(file);
        archive.set_comment(MADE_BY)?;
        // Without a time, the same map gives the same bytes.
        let options = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
        archive.start_file("doc.kml", options.large_file(true))?;
        let mut inner = BufWriter::with_capacity(1 << 16, archive);
        document(&mut inner, &name, layers, unit)?;
        inner.into_inner().map_err(|error| error.into_error())?.finish()?.flush()
    };
    run().map_err(|e| Error::io("write", path, e))
}

fn document(out: &mut impl Write, name: &str, layers: &[Layer<'_>], unit: ElevationUnit) -> Written<()> {
    writeln!(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- {MADE_BY} -->")?;
    writeln!(out, "<kml xmlns=\"http://www.opengis.net/kml/2.2\">\n<Document>\n<name>{}</name>", escaped(name))?;
    let looks: BTreeSet<Look> = rows(layers).map(|(layer, row)| Look::of(layer, row)).collect();
    looks.iter().try_for_each(|look| look.write(out))?;
    for (k, layer) in layers.iter().enumerate() {
        schema(out, k, layer)?;
    }
    for (k, layer) in layers.iter().enumerate() {
        writeln!(out, "<Folder><name>{}</name>", escaped(layer.name))?;
        let own: BTreeSet<Look> = layer.rows.iter().map(|row| Look::of(layer, row)).collect();
        // A single kind needs no folder of its own.
        let [open, close] = if own.len() > 1 { ["<Folder>", "</Folder>\n"] } else { [""; 2] };
        for look in &own {
            if !open.is_empty() {
                writeln!(out, "{open}<name>{}</name>", look.title())?;
            }
            for row in layer.rows.iter().filter(|row| Look::of(layer, row) == *look) {
                placemark(out, (k, layer), row, look, unit)?;
            }
            write!(out, "{close}")?;
        }
        writeln!(out, "</Folder>")?;
    }
    writeln!(out, "</Document>\n</kml>")
}

fn rows<'a, 'b>(layers: &'a [Layer<'b>]) -> impl Iterator<Item = (&'a Layer<'b>, &'a Row<'b>)> {
    layers.iter().flat_map(|layer| layer.rows.iter().map(move |row| (layer, row)))
}

/// The types of the attributes of a layer.
fn schema(out: &mut impl Write, number: usize, layer: &Layer<'_>) -> Written<()> {
    writeln!(out, "<Schema name=\"{}\" id=\"layer{number}\">", escaped(layer.name))?;
    for column in layer.columns {
        let kind = match column.kind {
            Kind::Real | Kind::Height | Kind::HeightError => "double",
            Kind::Int => "int",
            Kind::Bool => "bool",
            Kind::Text(_) | Kind::LongText => "string",
        };
        writeln!(out, "<SimpleField type=\"{kind}\" name=\"{}\"/>", column.name)?;
    }
    writeln!(out, "</Schema>")
}

fn placemark(
    out: &mut impl Write,
    (number, layer): (usize, &Layer<'_>),
    row: &Row<'_>,
    look: &Look,
    unit: ElevationUnit,
) -> Written<()> {
    write!(out, "<Placemark>")?;
    if let Some(name) = name_of(layer, row, unit) {
        write!(out, "<name>{}</name>", escaped(&name))?;
    }
    write!(out, "<styleUrl>#{}</styleUrl>", look.id())?;
    if row.cells.iter().any(|cell| *cell != Cell::Null) {
        write!(out, "<ExtendedData><SchemaData schemaUrl=\"#layer{number}\">")?;
        for (column, cell) in layer.columns.iter().zip(&row.cells) {
            let value = match cell {
                Cell::Real(number) => number.to_string(),
                Cell::Int(number) => number.to_string(),
                Cell::Text(text) => escaped(text),
                Cell::Bool(yes) => u8::from(*yes).to_string(),
                Cell::Null => continue,
            };
            write!(out, "<SimpleData name=\"{}\">{value}</SimpleData>", column.name)?;
        }
        write!(out, "</SchemaData></ExtendedData>")?;
    }
    match &row.shape {
        Shape::Point(None) => {}
        Shape::Point(Some(place)) => {
            write!(out, "<Point><coordinates>")?;
            positions(out, [*place])?;
            write!(out, "</coordinates></Point>")?;
        }
        Shape::Contour(points, _) => line(out, points.iter().copied())?,
        Shape::Line(points) => line(out, points.iter().map(|p| p.truncate()))?,
        Shape::Area(_) => {
            write!(out, "<Polygon><tessellate>1</tessellate>")?;
            for (k, ring) in row.shape.rings(Outer::Counterclockwise).enumerate() {
                let side = if k == 0 { "outer" } else { "inner" };
                write!(out, "<{side}BoundaryIs><LinearRing><coordinates>")?;
                positions(out, ring)?;
                write!(out, "</coordinates></LinearRing></{side}BoundaryIs>")?;
            }
            write!(out, "</Polygon>")?;
        }
    }
    writeln!(out, "</Placemark>")
}

fn line(out: &mut impl Write, points: impl IntoIterator<Item = DVec2>) -> Written<()> {
    write!(out, "<LineString><tessellate>1</tessellate><altitudeMode>clampToGround</altitudeMode><coordinates>")?;
    positions(out, points)?;
    write!(out, "</coordinates></LineString>")
}

/// Longitudes and latitudes, without the height, which counts from the ground here.
fn positions(out: &mut impl Write, points: impl IntoIterator<Item = DVec2>) -> Written<()> {
    for (k, p) in points.into_iter().enumerate() {
        let gap = if k == 0 { "" } else { " " };
        write!(out, "{gap}{},{}", degrees(p.x), degrees(p.y))?;
    }
    Ok(())
}

fn degrees(value: f64) -> String {
    let text = format!("{value:.DECIMALS$}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// What a feature is called: a contour by its elevation, a label by its text, others by their class or kind.
fn name_of(layer: &Layer<'_>, row: &Row<'_>, unit: ElevationUnit) -> Option<String> {
    let cell = |name: &str| {
        let place = layer.columns.iter().position(|column| column.name == name)?;
        row.cells.get(place)
    };
    let text = |name: &str| match cell(name)? {
        Cell::Text(text) if !text.is_empty() => Some(text.clone().into_owned()),
        _ => None,
    };
    match (text("text"), cell("elev")) {
        (Some(label), _) => Some(label),
        (None, Some(Cell::Real(height))) => {
            let digits = format!("{height:.3}");
            Some(format!("{} {}", digits.trim_end_matches('0').trim_end_matches('.'), unit.symbol()))
        }
        _ => ["name", "class", "kind"].into_iter().find_map(text),
    }
}
