//! Features with attributes, and what keeps them from being written.

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::ffi::OsString;
use std::path::Path;

use glam::{DVec2, DVec3};

use crate::base::error::{Error, Result};

/// What an attribute holds. Every kind may also be missing ([`Cell::Null`]).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A finite number.
    Real,
    /// A whole number between ±2⁵³, beyond which programs read JSON's numbers differently.
    Int,
    /// Text of at most so many bytes in UTF-8, for formats that give every value the same room.
    Text(u8),
    /// Text of any length. A shapefile takes 254 bytes of it.
    LongText,
    /// Yes or no.
    Bool,
}

/// An attribute.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Column {
    /// One to ten ASCII letters, digits and underscores, and no word of SQL, so that it is the same in every format.
    pub name: &'static str,
    /// What its cells hold.
    pub kind: Kind,
}

/// The value of an attribute.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell<'a> {
    /// A value of [`Kind::Real`].
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

/// Where a feature is, in map units; heights in metres.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape<'a> {
    /// A point, or a feature without a place.
    Point(Option<DVec2>),
    /// A line at one height.
    Contour(&'a [DVec2], f64),
    /// A line with a height of its own at every vertex.
    Line(&'a [DVec3]),
    /// An area without heights: its outer ring, then its holes, each closed (the first point is repeated) and turning
    /// either way: the formats demand different ways and get them. A ring whose area is zero is written as it stands.
    Area(Vec<Vec<DVec2>>),
}

/// The family of shapes that a layer holds.
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
    /// Where it is.
    pub shape: Shape<'a>,
    /// One a column.
    pub cells: Vec<Cell<'a>>,
}

/// Features of one family of shapes that share their attributes' names.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer<'a> {
    /// The name of the table, or what tells the layer's file from the others.
    pub name: &'a str,
    /// What its shapes are, so that a layer without rows has a type too.
    pub geometry: Geometry,
    /// The attributes.
    pub columns: &'static [Column],
    /// The features.
    pub rows: Vec<Row<'a>>,
}

/// Least x, greatest x, least y, greatest y.
pub(in crate::io) type Bounds = [f64; 4];

/// Bounds of nothing.
pub(in crate::io) const NO_BOUNDS: Bounds = [f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY];

/// The bounds of two things together.
pub(in crate::io) fn joined(a: Bounds, b: Bounds) -> Bounds {
    [a[0].min(b[0]), a[1].max(b[1]), a[2].min(b[2]), a[3].max(b[3])]
}

/// The way an outer ring turns; its holes turn the other way.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(in crate::io) enum Outer {
    Clockwise,
    Counterclockwise,
}

impl Shape<'_> {
    /// The family that this is of.
    fn geometry(&self) -> Geometry {
        match self {
            Self::Point(_) => Geometry::Points,
            Self::Contour(..) | Self::Line(_) => Geometry::Lines,
            Self::Area(_) => Geometry::Areas,
        }
    }

    /// All vertices; points and those of an area at height 0, ring after ring.
    pub(in crate::io) fn vertices(&self) -> impl Iterator<Item = DVec3> {
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
    pub(in crate::io) fn vertex_count(&self) -> usize {
        match self {
            Self::Point(place) => place.iter().len(),
            Self::Contour(points, _) => points.len(),
            Self::Line(points) => points.len(),
            Self::Area(rings) => rings.iter().map(Vec::len).sum(),
        }
    }

    /// The rings of an area, turned as a format demands; a line has none.
    pub(in crate::io) fn rings(
        &self,
        outer: Outer,
    ) -> impl ExactSizeIterator<Item = impl ExactSizeIterator<Item = DVec2>> {
        let rings: &[Vec<DVec2>] = if let Self::Area(rings) = self { rings } else { &[] };
        rings.iter().enumerate().map(move |(i, ring)| {
            let wants_left = (outer == Outer::Counterclockwise) == (i == 0);
            let area = doubled_area(ring);
            let turns = if wants_left { area < 0.0 } else { area > 0.0 };
            (0..ring.len()).map(move |k| ring[if turns { ring.len() - 1 - k } else { k }])
        })
    }

    /// The box around it.
    pub(in crate::io) fn bounds(&self) -> Bounds {
        self.vertices().fold(NO_BOUNDS, |bounds, p| joined(bounds, [p.x, p.x, p.y, p.y]))
    }

    /// What keeps it from being written, if anything.
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

/// Twice the area of a closed ring, positive if it turns left.
///
/// The turn at an extreme vertex would be exact, but says the wrong thing where a ring touches itself there.
fn doubled_area(ring: &[DVec2]) -> f64 {
    let Some(&origin) = ring.first() else { return 0.0 };
    ring.windows(2).map(|w| (w[0] - origin).perp_dot(w[1] - origin)).sum()
}

/// Greatest whole number up to which all are the same as 64-bit floating point.
const GREATEST_INT: u64 = 1 << 53;

impl Cell<'_> {
    /// What keeps it from standing in a column, if anything.
    fn flaw(&self, kind: Kind) -> Option<&'static str> {
        match (self, kind) {
            (Self::Null, _) | (Self::Bool(_), Kind::Bool) | (Self::Text(_), Kind::LongText) => None,
            (Self::Real(number), Kind::Real) => (!number.is_finite()).then_some("is not finite"),
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

/// Refuses what some format cannot say, or would say differently from the others.
pub(in crate::io) fn check(layer: &Layer<'_>) -> Result<()> {
    let name = layer.name;
    let mut names = BTreeSet::new();
    for column in layer.columns {
        let is_plain = column.name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_');
        let is_own = ["fid", "geom"].contains(&column.name.to_ascii_lowercase().as_str());
        if !is_plain || is_own || !(1..=10).contains(&column.name.len()) {
            return Err(Error::Parameter(format!("layer {name:?}: {:?} is no name for an attribute", column.name)));
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
            return wrong("has not as many values as the layer has attributes");
        }
        for (column, cell) in layer.columns.iter().zip(&row.cells) {
            if let Some(flaw) = cell.flaw(column.kind) {
                return wrong(&format!("cannot be written: its {} {flaw}", column.name));
            }
        }
    }
    Ok(())
}

/// Names of layers become names of tables and files: there must be at least one, and no two alike.
pub(in crate::io) fn check_names(names: &[&str]) -> Result<()> {
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
pub(in crate::io) fn file_name(target: &Path, layer: &str, layer_count: usize) -> OsString {
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
