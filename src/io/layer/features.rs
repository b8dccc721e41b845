//! Features with attributes, and the checks before they are written.

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::ffi::OsString;
use std::path::Path;

use glam::{DVec2, DVec3};

use tokosen_core::base::error::{Error, Result};

/// The type of an attribute. Every value may also be missing ([`Cell::Null`]).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A finite number.
    Real,
    /// A finite number: a height in metres. An output has it in its own unit of heights.
    Height,
    /// A finite number: the error of a height in metres, rounded to three decimals. An output has it in its own unit of
    /// heights, rounded likewise.
    HeightError,
    /// A whole number between ±2⁵³. Beyond that, programs read JSON numbers differently.
    Int,
    /// Text of at most this many bytes in UTF-8. Some formats reserve the same space for every value.
    Text(u8),
    /// Text of any length. A shapefile stores its first 254 bytes.
    LongText,
    /// Yes or no.
    Bool,
}

/// An attribute.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Column {
    /// One to ten ASCII letters, digits and underscores, and not an SQL keyword. Then the name is the same in every
    /// format.
    pub name: &'static str,
    /// The type of its cells.
    pub kind: Kind,
}

/// The value of an attribute.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell<'a> {
    /// A value of [`Kind::Real`], [`Kind::Height`] or [`Kind::HeightError`].
    Real(f64),
    /// A value of [`Kind::Int`].
    Int(i64),
    /// A value of [`Kind::Text`] or [`Kind::LongText`].
    Text(Cow<'a, str>),
    /// A value of [`Kind::Bool`].
    Bool(bool),
    /// No value.
    Null,
}

/// The geometry of a feature, in map units; heights in metres.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape<'a> {
    /// A point, or a feature without geometry.
    Point(Option<DVec2>),
    /// A line at one height.
    Contour(&'a [DVec2], f64),
    /// A line with a height of its own at every vertex.
    Line(&'a [DVec3]),
    /// An area without heights: its outer ring, then its holes. Each ring is closed (the first point is repeated). Its
    /// direction is free: each writer turns it as its format requires. A ring without area is written unchanged.
    Area(Vec<Vec<DVec2>>),
}

/// The geometry type of a layer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Geometry {
    /// [`Shape::Point`]. They are written as GeoPackage and GeoJSON.
    Points,
    /// [`Shape::Contour`] and [`Shape::Line`].
    Lines,
    /// [`Shape::Area`].
    Areas,
}

/// A shape with its attributes.
#[derive(Debug, Clone, PartialEq)]
pub struct Row<'a> {
    /// Its geometry.
    pub shape: Shape<'a>,
    /// One cell per column.
    pub cells: Vec<Cell<'a>>,
}

/// Features that share a geometry type and attributes.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer<'a> {
    /// The name of the table, or the part of the file name that differs between layers.
    pub name: &'a str,
    /// The type of its geometries; a layer without rows has a type too.
    pub geometry: Geometry,
    /// The attributes.
    pub columns: &'static [Column],
    /// The features.
    pub rows: Vec<Row<'a>>,
}

/// Least x, greatest x, least y, greatest y.
pub(crate) type Bounds = [f64; 4];

/// The bounds of an empty layer.
pub(crate) const NO_BOUNDS: Bounds = [f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY];

/// The bounds of two objects together.
pub(crate) fn joined(a: Bounds, b: Bounds) -> Bounds {
    [a[0].min(b[0]), a[1].max(b[1]), a[2].min(b[2]), a[3].max(b[3])]
}

/// The direction of an outer ring; its holes have the opposite direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outer {
    /// As in a shapefile.
    Clockwise,
    /// As in a GeoPackage and in GeoJSON.
    Counterclockwise,
}

impl Shape<'_> {
    /// The geometry type of this shape.
    fn geometry(&self) -> Geometry {
        match self {
            Self::Point(_) => Geometry::Points,
            Self::Contour(..) | Self::Line(_) => Geometry::Lines,
            Self::Area(_) => Geometry::Areas,
        }
    }

    /// All vertices. Points and vertices of an area have height 0; an area gives ring after ring.
    pub(crate) fn vertices(&self) -> impl Iterator<Item = DVec3> {
        let (level, z, line, rings): (&[DVec2], f64, &[DVec3], &[Vec<DVec2>]) = match self {
            Self::Point(place) => (place.as_slice(), 0.0, &[], &[]),
            Self::Contour(points, z) => (points, *z, &[], &[]),
            Self::Line(points) => (&[], 0.0, points, &[]),
            Self::Area(rings) => (&[], 0.0, &[], rings),
        };
        let flat = rings.iter().flatten().map(|p| p.extend(0.0));
        level.iter().map(move |p| p.extend(z)).chain(line.iter().copied()).chain(flat)
    }

    /// How many vertices there are.
    pub(crate) fn vertex_count(&self) -> usize {
        match self {
            Self::Point(place) => place.iter().len(),
            Self::Contour(points, _) => points.len(),
            Self::Line(points) => points.len(),
            Self::Area(rings) => rings.iter().map(Vec::len).sum(),
        }
    }

    /// The rings of an area, in the direction that a format requires. A line has none.
    pub fn rings(&self, outer: Outer) -> impl ExactSizeIterator<Item = impl ExactSizeIterator<Item = DVec2>> {
        let rings: &[Vec<DVec2>] = if let Self::Area(rings) = self { rings } else { &[] };
        rings.iter().enumerate().map(move |(i, ring)| {
            let wants_left = (outer == Outer::Counterclockwise) == (i == 0);
            let area = doubled_area(ring);
            let turns = if wants_left { area < 0.0 } else { area > 0.0 };
            (0..ring.len()).map(move |k| ring[if turns { ring.len() - 1 - k } else { k }])
        })
    }

    /// The bounding box.
    pub(crate) fn bounds(&self) -> Bounds {
        self.vertices().fold(NO_BOUNDS, |bounds, p| joined(bounds, [p.x, p.x, p.y, p.y]))
    }

    /// The reason why the shape cannot be written, if there is one.
    fn flaw(&self) -> Option<&'static str> {
        if !self.vertices().all(|p| p.is_finite()) {
            return Some("has coordinates that are not finite");
        }
        match self {
            Self::Contour(..) | Self::Line(_) if self.vertex_count() < 2 => Some("has fewer than two points"),
            Self::Area(rings) if rings.is_empty() => Some("is an area without a ring"),
            Self::Area(rings) if rings.iter().any(|ring| ring.len() < 4 || ring.first() != ring.last()) => {
                Some("has a ring of fewer than four points or one that is not closed")
            }
            _ => None,
        }
    }
}

/// An expected error has three decimals; more would have no meaning.
const ERROR_SCALE: f64 = 1e3;

/// An expected error as it is written.
pub(super) fn rounded_error(error: f64) -> f64 {
    (error * ERROR_SCALE).round() / ERROR_SCALE
}

/// Twice the area of a closed ring, positive if it is counterclockwise.
///
/// The turn at an extreme vertex would be exact, but it is wrong where a ring touches itself at that vertex.
fn doubled_area(ring: &[DVec2]) -> f64 {
    let Some(&origin) = ring.first() else { return 0.0 };
    ring.windows(2).map(|w| (w[0] - origin).perp_dot(w[1] - origin)).sum()
}

/// Up to this number, 64-bit floating point represents all whole numbers.
const GREATEST_INT: u64 = 1 << 53;

impl Cell<'_> {
    /// The reason why the cell does not fit a column, if there is one.
    fn flaw(&self, kind: Kind) -> Option<&'static str> {
        match (self, kind) {
            (Self::Null, _) | (Self::Bool(_), Kind::Bool) | (Self::Text(_), Kind::LongText) => None,
            (Self::Real(number), Kind::Real | Kind::Height | Kind::HeightError) => {
                (!number.is_finite()).then_some("is not finite")
            }
            (Self::Int(number), Kind::Int) => {
                (number.unsigned_abs() > GREATEST_INT).then_some("is too large a whole number")
            }
            (Self::Text(text), Kind::Text(most)) => {
                (text.len() > usize::from(most)).then_some("is longer than the attribute may be")
            }
            _ => Some("is of another kind than the attribute"),
        }
    }
}

/// Refuses content that a format cannot store, or that formats would store differently.
pub(crate) fn check(layer: &Layer<'_>) -> Result<()> {
    let name = layer.name;
    let mut names = BTreeSet::new();
    for column in layer.columns {
        let is_plain = column.name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_');
        let is_own = ["fid", "geom"].contains(&column.name.to_ascii_lowercase().as_str());
        if !is_plain || is_own || !(1..=10).contains(&column.name.len()) {
            return Err(Error::Parameter(format!("layer {name:?}: {:?} is not a valid attribute name", column.name)));
        }
        if !names.insert(column.name.to_ascii_lowercase()) {
            return Err(Error::Parameter(format!("layer {name:?}: two attributes are called {:?}", column.name)));
        }
    }
    for (i, row) in layer.rows.iter().enumerate() {
        let wrong = |what: &str| {
            let place = row.shape.vertices().next().map_or(String::new(), |p| format!(" at {:.3} {:.3}", p.x, p.y));
            Err(Error::Data(format!("layer {name:?}: feature {}{place} {what}", i + 1)))
        };
        if row.shape.geometry() != layer.geometry {
            return wrong("has another type of geometry than the layer");
        }
        if let Some(flaw) = row.shape.flaw() {
            return wrong(flaw);
        }
        if row.cells.len() != layer.columns.len() {
            return wrong("does not have one value per attribute of the layer");
        }
        for (column, cell) in layer.columns.iter().zip(&row.cells) {
            if let Some(flaw) = cell.flaw(column.kind) {
                return wrong(&format!("cannot be written: its {} {flaw}", column.name));
            }
        }
    }
    Ok(())
}

/// Checks layer names, which become names of tables and files: at least one, and all different.
pub(crate) fn check_names(names: &[&str]) -> Result<()> {
    if names.is_empty() {
        return Err(Error::Parameter("there is no layer to write".to_owned()));
    }
    let mut seen = BTreeSet::new();
    for name in names {
        if name.trim().is_empty() || name.contains('\0') {
            return Err(Error::Parameter(format!("{name:?} is not a valid layer name")));
        }
        if !seen.insert(suffix(name).to_lowercase()) {
            return Err(Error::Parameter(format!("two layers would be called {name:?}")));
        }
    }
    Ok(())
}

/// The file of a layer, in a format that holds one layer per file: the target's name, or `STEM_SUFFIX.EXT` if there are
/// several layers.
pub(crate) fn file_name(target: &Path, layer: &str, layer_count: usize) -> OsString {
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

/// The suffix of a layer's file: its name without the prefix `contours_`, with safe characters only.
fn suffix(name: &str) -> String {
    let short = name.strip_prefix("contours_").filter(|short| !short.is_empty()).unwrap_or(name);
    short.chars().map(|c| if c.is_alphanumeric() || matches!(c, '.' | '-' | '_') { c } else { '_' }).collect()
}
