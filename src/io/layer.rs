//! Layers of line features, as the writers of all formats take them.

use std::collections::BTreeSet;
use std::ffi::OsString;
use std::path::Path;

use glam::DVec2;

use crate::contour::{ContourLayer, Source};
use crate::error::{Error, Result};

/// What an attribute holds. Text comes with the most bytes that a value has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Real,
    Text(u8),
    Bool,
}

/// An attribute. Names are at most ten characters and no words of SQL, so that they are the same in every format.
#[derive(Debug, Clone, Copy)]
pub(super) struct Column {
    pub name: &'static str,
    pub kind: Kind,
}

/// The value of an attribute.
#[derive(Debug, Clone, Copy)]
pub(super) enum Cell {
    Real(f64),
    Text(&'static str),
    Bool(bool),
}

/// A line with its attributes.
pub(super) struct Row<'a> {
    pub points: &'a [DVec2],
    /// Height of every vertex.
    pub z: f64,
    pub cells: Vec<Cell>,
}

/// Lines that share their attributes' names.
pub(super) struct Layer<'a> {
    pub name: &'a str,
    pub columns: &'static [Column],
    pub rows: Vec<Row<'a>>,
}

const CONTOUR_COLUMNS: &[Column] = &[
    Column { name: "elev", kind: Kind::Real },
    Column { name: "source", kind: Kind::Text(12) },
    Column { name: "is_index", kind: Kind::Bool },
    Column { name: "depression", kind: Kind::Bool },
    Column { name: "closed", kind: Kind::Bool },
];

/// The features of a layer of contours.
///
/// # Errors
/// If a line has fewer than two points or something in it is not finite: no format can say that.
pub(super) fn of_contours(layer: &ContourLayer) -> Result<Layer<'_>> {
    let mut rows = Vec::with_capacity(layer.lines.len());
    for line in &layer.lines {
        if line.points.len() < 2 || !line.elevation.is_finite() || !line.points.iter().all(|p| p.is_finite()) {
            return Err(Error::Data(format!(
                "layer {:?}: a line of elevation {} has fewer than two points or coordinates that are not finite",
                layer.name, line.elevation
            )));
        }
        let source = match line.source {
            Source::Input => "input",
            Source::Interpolated => "interpolated",
        };
        let cells = vec![
            Cell::Real(line.elevation),
            Cell::Text(source),
            Cell::Bool(line.index),
            Cell::Bool(line.depression),
            Cell::Bool(line.is_closed()),
        ];
        rows.push(Row { points: &line.points, z: line.elevation, cells });
    }
    Ok(Layer { name: &layer.name, columns: CONTOUR_COLUMNS, rows })
}

/// Names of layers become names of tables and files: there must be at least one, and no two alike.
pub(super) fn check_names(names: &[&str]) -> Result<()> {
    if names.is_empty() {
        return Err(Error::Parameter("there is no layer to write".to_owned()));
    }
    let mut seen = BTreeSet::new();
    for name in names {
        if name.trim().is_empty() || name.contains('\0') {
            return Err(Error::Parameter(format!("{name:?} is no name for a layer")));
        }
        if !seen.insert(suffix(name).to_lowercase()) {
            return Err(Error::Parameter(format!("two layers would be called {name:?}")));
        }
    }
    Ok(())
}

/// The file of a layer in a format that holds one layer a file: the target's name, or `STEM_SUFFIX.EXT` if there are
/// several layers.
pub(super) fn file_name(target: &Path, layer: &str, layer_count: usize) -> OsString {
    if layer_count == 1 {
        return target.file_name().unwrap_or_default().to_owned();
    }
    let mut name = target.file_stem().unwrap_or_default().to_owned();
    name.push("_");
    name.push(suffix(layer));
    if let Some(extension) = target.extension() {
        name.push(".");
        name.push(extension);
    }
    name
}

/// What tells a layer's file from the others: its name without what all contours share, safe in a file name.
fn suffix(name: &str) -> String {
    let short = name.strip_prefix("contours_").filter(|short| !short.is_empty()).unwrap_or(name);
    short.chars().map(|c| if c.is_alphanumeric() || matches!(c, '.' | '-' | '_') { c } else { '_' }).collect()
}
