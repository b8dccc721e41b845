//! The table into which every vector format is read before elevations are found. It holds features with lines, points
//! and polygons, and the few attribute values that could be an elevation.
//!
//! Other attributes are not kept; one example value of each remains for messages.

use std::collections::{BTreeMap, HashMap};
use std::path::Path;

use glam::DVec2;

use super::attributes::{
    is_depth_name, is_elevation_name, is_kind_name, is_open_name, is_sigma_name, may_give_unit, may_mark, unit_in_name,
};
use super::file_box::FileBox;
use super::unit_words::LengthWord;
use tokosen_core::base::error::{Finding, FindingKind};
use tokosen_core::contour::UnitHint;
use tokosen_core::crs::{Crs, HeightSystem, LengthUnit};
use tokosen_core::features::{Role, Shapes};

/// What the caller requests from a reader.
pub(super) struct Request<'a> {
    /// The attribute that the user named.
    pub elevation_field: Option<&'a str>,
    /// The layer that the user named.
    pub layer: Option<&'a str>,
    /// The purpose of reading the file.
    pub purpose: Purpose,
    /// The box that features must meet. A reader may leave out others, and need not.
    pub within: Option<FileBox>,
    /// Memory limit, bytes, if there is one.
    pub memory: Option<u64>,
}

/// The purpose of reading a file.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Purpose {
    /// Contours, with the spot heights that come with them.
    Contours,
    /// Spot heights alone.
    Spots,
    /// Polygons that bound an area. For lines and points, polygons are left out.
    Area,
    /// Places alone: points, whose heights do not count.
    Places,
    /// Features in a role beside the contours.
    Features(Role),
}

/// An attribute of the features.
pub(super) struct Field {
    pub name: String,
    /// An example value, as text.
    pub example: Option<String>,
    /// Whether its values are kept.
    pub kept: bool,
}

/// A value of an attribute.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    Null,
    Number(f64),
    /// A number with a unit behind it, from a text.
    Measured(f64, LengthWord),
    Text(String),
}

impl std::fmt::Display for Value {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Null => f.write_str("nothing"),
            Self::Number(number) => write!(f, "{number}"),
            Self::Measured(number, unit) => write!(f, "{number} {}", unit.name()),
            Self::Text(text) => write!(f, "{text:?}"),
        }
    }
}

/// A line of the file.
pub(super) struct Line {
    pub points: Vec<DVec2>,
    /// Least and greatest z of its vertices; both NaN if one vertex has none.
    pub z: Option<[f64; 2]>,
    /// z of each vertex if they differ; otherwise empty.
    pub heights: Vec<f64>,
    /// Whether it is a ring of a polygon.
    pub is_ring: bool,
}

/// A point of the file.
pub(super) struct Spot {
    pub place: DVec2,
    pub z: Option<f64>,
}

/// A feature with its geometry, as far as it is used.
#[derive(Default)]
pub(super) struct Feature {
    /// The number that GIS programs show as the feature's id in this format.
    pub number: u64,
    /// Values of kept fields, by the field's index in [`Table::fields`].
    pub values: Vec<(usize, Value)>,
    pub lines: Vec<Line>,
    /// The type of the polygons whose rings are among the lines.
    pub outline: Option<&'static str>,
    pub spots: Vec<Spot>,
    pub polygons: Vec<Rings>,
    /// Least and greatest z of all vertices of polygons; both NaN if one vertex has none.
    pub polygon_z: Option<[f64; 2]>,
}

/// A polygon of the file: the exterior ring, then the holes.
pub(super) type Rings = Vec<Vec<DVec2>>;

impl Feature {
    /// Adds a line. `z` has one value per vertex, or is empty.
    pub fn push_line(&mut self, mut points: Vec<DVec2>, z: &[f64]) {
        if points.is_empty() {
            return;
        }
        points.shrink_to_fit();
        let range = widened(None, z);
        let heights = if range.is_some_and(|[lo, hi]| lo != hi) { z.to_vec() } else { Vec::new() };
        self.lines.push(Line { points, z: range, heights, is_ring: false });
    }

    /// Adds a ring of a polygon, or of a geometry of the type `kind`, as a closed line. `z` as in [`Feature::push_line`].
    pub fn push_ring(&mut self, kind: &'static str, mut points: Vec<DVec2>, z: &[f64]) {
        self.outline = Some(kind);
        if points.first() != points.last() {
            points.extend(points.first().copied());
        }
        let range = widened(None, z);
        if !points.is_empty() {
            self.lines.push(Line { points, z: range, heights: Vec::new(), is_ring: true });
        }
    }

    /// Bytes of memory in a table, without those of texts. A feature without geometry is not kept.
    pub fn bytes(&self) -> usize {
        let lines = self.lines.iter().map(|line| {
            size_of::<Line>() + size_of::<DVec2>() * line.points.len() + size_of::<f64>() * line.heights.len()
        });
        let rings = self.polygons.iter().flatten().map(|ring| size_of_val(ring) + size_of::<DVec2>() * ring.len());
        let spots = size_of::<Spot>() * self.spots.len() + size_of::<(usize, Value)>() * self.values.len();
        let geometry = lines.chain(rings).sum::<usize>();
        if geometry == 0 && self.spots.is_empty() { 0 } else { size_of::<Self>() + spots + geometry }
    }

    /// The least and the greatest x and y of its vertices: least x, least y, greatest x, greatest y.
    pub fn sides(&self) -> [f64; 4] {
        let lines = self.lines.iter().flat_map(|line| &line.points);
        let all =
            lines.chain(self.polygons.iter().flatten().flatten()).chain(self.spots.iter().map(|spot| &spot.place));
        let nothing = [DVec2::INFINITY, DVec2::NEG_INFINITY];
        let [low, high] = all.fold(nothing, |[low, high], p| [low.min(*p), high.max(*p)]);
        [low.x, low.y, high.x, high.y]
    }

    /// Extends the z range of the feature's polygons by these vertices.
    pub fn note_polygon_z(&mut self, z: &[f64]) {
        self.polygon_z = widened(self.polygon_z, z);
    }
}

/// A range of z, extended by further values.
fn widened(range: Option<[f64; 2]>, z: &[f64]) -> Option<[f64; 2]> {
    z.iter().fold(range, |range, &z| match range {
        None => Some([z, z]),
        Some([lo, hi]) if z.is_nan() || lo.is_nan() || hi.is_nan() => Some([f64::NAN; 2]),
        Some([lo, hi]) => Some([lo.min(z), hi.max(z)]),
    })
}

/// The content of a file, or of the requested layers.
#[derive(Default)]
pub(super) struct Table {
    pub fields: Vec<Field>,
    /// What else to say where a message lists the fields.
    pub fields_note: Option<String>,
    by_name: HashMap<String, usize>,
    named: Option<String>,
    /// Whether attributes that may mark depressions are kept.
    wants_marks: bool,
    /// Whether attributes that may tell the kind of a break line are kept.
    wants_kinds: bool,
    /// Whether attributes that may hold a standard error are kept.
    wants_sigmas: bool,
    /// Whether attributes are kept that may give the unit of elevations.
    wants_units: bool,
    /// Whether polygons are kept.
    pub wants_polygons: bool,
    /// Whether rings of polygons are kept as lines.
    pub wants_rings: bool,
    /// Whether areas are cut at the edges of grid squares. Then areas that share an edge are one.
    pub in_pieces: bool,
    pub features: Vec<Feature>,
    pub crs: Option<Crs>,
    /// The height system, if the file names one beside its coordinate reference system.
    pub height_system: Option<HeightSystem>,
    /// Why there is no coordinate reference system, if the reason is not only that the file names none.
    pub crs_problem: Option<String>,
    /// The unit of x and y, if the file states it and names no coordinate reference system.
    pub plane_unit: Option<LengthUnit>,
    /// What the format lets suppose about the unit of heights, if it is more than nothing.
    pub unit_hint: Option<UnitHint>,
    /// Geometries that were left out, with a count per kind.
    pub left_out: BTreeMap<String, u64>,
    pub findings: Vec<Finding>,
}

/// The kind under which features without geometry are counted in [`Table::left_out`].
pub(super) const NO_GEOMETRY: &str = "no geometry";

impl Table {
    /// An empty table that keeps the fields that the request may need.
    pub fn new(request: &Request<'_>) -> Self {
        Self {
            named: request.elevation_field.map(str::to_lowercase),
            wants_marks: request.purpose == Purpose::Contours,
            wants_kinds: request.purpose == Purpose::Features(Role::BreakLines),
            wants_sigmas: request.purpose == Purpose::Spots,
            wants_polygons: match request.purpose {
                Purpose::Area => true,
                Purpose::Features(role) => role.shapes() != Shapes::Lines,
                Purpose::Contours | Purpose::Spots | Purpose::Places => false,
            },
            wants_rings: request.purpose == Purpose::Contours,
            wants_units: matches!(
                request.purpose,
                Purpose::Contours | Purpose::Spots | Purpose::Features(Role::Water | Role::Coast)
            ),
            ..Self::default()
        }
    }

    /// Reports the geometries that were left out, and `also` others, because features in this role have other shapes.
    pub fn report_left_out(&mut self, path: &Path, role: Role, also: Option<(&str, u64)>) {
        let kinds = self.left_out.iter();
        let kinds = kinds.map(|(kind, count)| {
            (if kind == NO_GEOMETRY { "features without geometry" } else { kind.as_str() }, *count)
        });
        let kinds: Vec<(&str, u64)> = kinds.chain(also).filter(|(_, count)| *count > 0).collect();
        for (what, count) in kinds {
            let message = format!("{}: {count} {what} left out; {}", path.display(), role.sentence());
            self.findings.push(Finding::general(FindingKind::SkippedFeature, message));
        }
    }

    /// The index of a field. A new field is added.
    pub fn field(&mut self, name: &str) -> usize {
        if let Some(&index) = self.by_name.get(name) {
            return index;
        }
        let marks = self.wants_marks && may_mark(name);
        let kept = marks
            || (self.wants_kinds && is_kind_name(name))
            || (self.wants_sigmas && is_sigma_name(name))
            || (self.wants_units && may_give_unit(name))
            || is_elevation_name(name)
            || is_open_name(name)
            || is_depth_name(name)
            || unit_in_name(name).is_some()
            || self.named.as_ref().is_some_and(|named| *named == name.to_lowercase());
        self.fields.push(Field { name: name.to_owned(), example: None, kept });
        self.by_name.insert(name.to_owned(), self.fields.len() - 1);
        self.fields.len() - 1
    }

    /// Whether values of this field are needed.
    pub fn wants(&self, field: usize) -> bool {
        self.fields[field].kept || self.fields[field].example.is_none()
    }

    /// Records a value: as an example, and in the feature's `values` if the field is kept.
    pub fn note(&mut self, values: &mut Vec<(usize, Value)>, index: usize, value: Value) {
        let field = &mut self.fields[index];
        if field.example.is_none() && value != Value::Null {
            field.example = Some(shortened(&value.to_string()));
        }
        if field.kept {
            values.push((index, value));
        }
    }

    /// Records an attribute that a document gives as text, unless the feature has it already.
    pub fn note_text(&mut self, feature: &mut Feature, name: &str, text: &str) {
        let text = text.trim();
        let value = match text.parse() {
            _ if text.is_empty() => Value::Null,
            Ok(number) => Value::Number(number),
            Err(_) => Value::Text(text.to_owned()),
        };
        let field = self.field(name);
        if self.wants(field) && feature.values.iter().all(|(known, _)| *known != field) {
            self.note(&mut feature.values, field, value);
        }
    }

    /// Moves the polygons into a table of their own.
    pub fn take_polygons(&mut self) -> Self {
        let with_polygons = self.features.iter_mut().filter(|feature| !feature.polygons.is_empty());
        let of_polygons = |feature: &mut Feature| Feature {
            number: feature.number,
            polygons: std::mem::take(&mut feature.polygons),
            ..Feature::default()
        };
        Self { features: with_polygons.map(of_polygons).collect(), ..Self::default() }
    }

    /// Adds a feature, or counts it if it has no usable geometry.
    pub fn push(&mut self, feature: Feature) {
        if !feature.lines.is_empty() || !feature.spots.is_empty() || !feature.polygons.is_empty() {
            self.features.push(feature);
        }
    }

    /// Counts a geometry that is left out.
    pub fn leave_out(&mut self, kind: &str) {
        match self.left_out.get_mut(kind) {
            Some(count) => *count += 1,
            None => {
                self.left_out.insert(kind.to_owned(), 1);
            }
        }
    }

    /// Number of features with polygons whose rings are lines, by the type of the geometry.
    pub fn outlines(&self) -> BTreeMap<&'static str, usize> {
        let mut counts = BTreeMap::new();
        self.features
            .iter()
            .filter_map(|feature| feature.outline)
            .for_each(|kind| *counts.entry(kind).or_default() += 1);
        counts
    }

    /// The end of a message that lists what else the file contains. Empty if there is nothing.
    pub fn found_words(&self) -> String {
        let mut found: Vec<String> = self.left_out.iter().map(|(kind, count)| format!("{count} {kind}")).collect();
        let count = |of: fn(&Feature) -> usize| self.features.iter().map(of).sum::<usize>();
        let lines = count(|f| f.lines.iter().filter(|line| !line.is_ring).count());
        let outlines = self.outlines();
        let spots = count(|f| f.spots.len());
        found.extend(outlines.into_iter().map(|(kind, count)| format!("{count} {kind}")));
        found.extend((lines > 0).then(|| format!("{lines} lines")));
        found.extend((spots > 0).then(|| format!("{spots} points")));
        if found.is_empty() { String::new() } else { format!(" (found: {})", found.join(", ")) }
    }
}

/// The largest number of characters of a value in a message.
const EXAMPLE_LENGTH: usize = 24;

fn shortened(text: &str) -> String {
    if text.chars().count() <= EXAMPLE_LENGTH {
        return text.to_owned();
    }
    text.chars().take(EXAMPLE_LENGTH - 1).chain(['…']).collect()
}
