//! Writes layers of features as a DXF of AutoCAD 2000, the oldest version with `LWPOLYLINE`.
//!
//! Contours and rings of areas become one `LWPOLYLINE` each. Lines with varying height become three-dimensional
//! `POLYLINE`s. Labels become `TEXT`. The layer name holds the most important attributes, such as `CONTOUR-INPUT-INDEX`. Numbers have enough
//! digits to preserve every f64 bit for bit.

use std::collections::BTreeMap;
use std::io::Result as Written;
use std::path::Path;

use glam::{DVec2, DVec3};

use super::drawing::{Drawing, write_level};
use super::output::GroupWriter;
use super::tables::{Look, MODEL_SPACE};
use crate::layer::{Cell, Geometry, LABELS_LAYER, Layer, NO_BOUNDS, Outer, Row, Shape, joined};
use tokosen_core::base::error::Result;
use tokosen_core::crs::Crs;

/// Writes one file. Of the system of the coordinates, the header states the unit.
pub(crate) fn write(path: &Path, layers: &[Layer<'_>], crs: Option<&Crs>) -> Result<()> {
    let rows = || layers.iter().flat_map(|layer| layer.rows.iter().map(move |row| (layer, row)));
    let names: Vec<String> = rows().map(|(layer, row)| layer_name(layer, row)).collect();
    let look = |(layer, row)| if is_index(layer, row) { Look::INDEX } else { Look::CONTOUR };
    let looks: BTreeMap<&str, Look> = names.iter().map(String::as_str).zip(rows().map(look)).collect();
    let bounds = rows().fold(NO_BOUNDS, |bounds, (_, row)| joined(bounds, row.shape.bounds()));
    let drawing = Drawing {
        looks: &looks,
        handles: rows().map(|(_, row)| handles_of(row)).sum(),
        bounds: if names.is_empty() { [0.0, 1.0, 0.0, 1.0] } else { bounds },
        unit: crs.and_then(Crs::length_unit),
    };
    drawing.write(path, |out| {
        names.iter().zip(rows()).try_for_each(|(name, (layer, row))| match text_of(layer, row) {
            Some(text) => text.write(out, name),
            None => write_shape(out, name, &row.shape),
        })
    })
}

/// How many handles the entities of a feature need.
fn handles_of(row: &Row<'_>) -> u64 {
    match &row.shape {
        Shape::Contour(..) | Shape::Point(_) => 1,
        // The line, its vertices and their end.
        Shape::Line(points) => points.len() as u64 + 2,
        Shape::Area(rings) => rings.len() as u64,
    }
}

fn write_shape(out: &mut GroupWriter, layer: &str, shape: &Shape<'_>) -> Written<()> {
    match shape {
        Shape::Contour(points, elevation) => write_level(out, layer, points, *elevation),
        Shape::Line(points) => write_climbing(out, layer, points),
        Shape::Point(point) => point.map_or(Ok(()), |p| write_level(out, layer, &[p], 0.0)),
        Shape::Area(_) => {
            for ring in shape.rings(Outer::Counterclockwise) {
                write_level(out, layer, &ring.collect::<Vec<DVec2>>(), 0.0)?;
            }
            Ok(())
        }
    }
}

fn write_climbing(out: &mut GroupWriter, layer: &str, points: &[DVec3]) -> Written<()> {
    let line = out.begin_entity("POLYLINE", MODEL_SPACE, layer)?;
    out.pairs(&[(100, "AcDb3dPolyline"), (66, "1")])?;
    out.numbers(10, &[0.0; 3])?;
    out.pairs(&[(70, "8")])?;
    for p in points {
        out.begin_entity("VERTEX", line, layer)?;
        out.pairs(&[(100, "AcDbVertex"), (100, "AcDb3dPolylineVertex")])?;
        out.numbers(10, &p.to_array())?;
        out.pairs(&[(70, "32")])?;
    }
    out.begin_entity("SEQEND", line, layer)?;
    Ok(())
}

/// A label.
struct Text<'a> {
    text: &'a str,
    middle: DVec3,
    angle: f64,
    height: f64,
}

/// The text of a label; `None` for other features.
fn text_of<'a>(layer: &Layer<'_>, row: &'a Row<'_>) -> Option<Text<'a>> {
    let number = |column: &str| match cell(layer, row, column) {
        Some(Cell::Real(number)) => Some(*number),
        _ => None,
    };
    match (&row.shape, cell(layer, row, "text")) {
        (Shape::Point(Some(place)), Some(Cell::Text(text))) => Some(Text {
            text,
            middle: place.extend(number("elev")?),
            angle: number("angle")?,
            height: number("height")?,
        }),
        _ => None,
    }
}

impl Text<'_> {
    fn write(&self, out: &mut GroupWriter, layer: &str) -> Written<()> {
        out.begin_entity("TEXT", MODEL_SPACE, layer)?;
        out.pairs(&[(100, "AcDbText")])?;
        out.numbers(10, &self.middle.to_array())?;
        out.numbers(40, &[self.height])?;
        out.put(1, self.text)?;
        out.numbers(50, &[self.angle])?;
        // Centred in both directions on the point that follows.
        out.pairs(&[(72, "1")])?;
        out.numbers(11, &self.middle.to_array())?;
        out.pairs(&[(100, "AcDbText"), (73, "2")])
    }
}

/// The layer name of a feature: the content of the layer, the kind of the feature, and whether it is an index contour.
fn layer_name(layer: &Layer<'_>, row: &Row<'_>) -> String {
    let mut name = match layer.name.starts_with("contours") {
        true => "CONTOUR".to_owned(),
        false if layer.name.starts_with(LABELS_LAYER) => "CONTOUR-LABEL".to_owned(),
        false => layer.name.to_uppercase(),
    };
    let kind = ["source", "kind", "class"].iter().find_map(|column| match cell(layer, row, column) {
        Some(Cell::Text(text)) if !text.is_empty() => Some(text.to_uppercase()),
        _ => None,
    });
    let supplementary = match cell(layer, row, "kind") {
        Some(Cell::Text(text)) if text.starts_with("supplementary") => Some(text.to_uppercase()),
        _ => None,
    };
    let kinds =
        kind.as_deref().into_iter().chain(is_index(layer, row).then_some("INDEX")).chain(supplementary.as_deref());
    for part in kinds {
        name.push('-');
        name.push_str(part);
    }
    // Layer names of that version allow few characters, and its text is in a code page.
    name.chars().map(|c| if c.is_ascii_alphanumeric() || matches!(c, '-' | '_') { c } else { '_' }).take(255).collect()
}

fn is_index(layer: &Layer<'_>, row: &Row<'_>) -> bool {
    layer.geometry == Geometry::Lines && cell(layer, row, "is_index") == Some(&Cell::Bool(true))
}

fn cell<'a>(layer: &Layer<'_>, row: &'a Row<'_>, column: &str) -> Option<&'a Cell<'a>> {
    let place = layer.columns.iter().position(|c| c.name == column)?;
    row.cells.get(place)
}
