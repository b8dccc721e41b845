//! Reads GeoJSON into a table.

use std::fmt;
use std::path::Path;

use serde::de::{DeserializeSeed, Deserializer, Error as _, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde_json::error::Category;

use super::coordinates::{Coordinates, Part};
use crate::table::{Feature, NO_GEOMETRY, Request, Spot, Table, Value};
use crate::text;
use tokosen_core::base::error::{Error, Result};
use tokosen_core::crs::Crs;

/// Reads a feature collection, a feature or a bare geometry.
///
/// Features are numbered from 0 in the order of the file, as GIS programs show them.
pub(crate) fn read(path: &Path, request: &Request<'_>) -> Result<Table> {
    let bytes = text::read(path, request.memory, |_| None)?;
    parse(path, &bytes, request)
}

/// Reads the text of a file, as [`read`].
pub(crate) fn parse(path: &Path, bytes: &[u8], request: &Request<'_>) -> Result<Table> {
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    if text.trim_ascii().is_empty() {
        return Err(Error::empty(path));
    }
    let mut table = Table::new(request);
    let mut json = serde_json::Deserializer::from_slice(text);
    let root = ObjectSeed { table: &mut table, is_root: true }
        .deserialize(&mut json)
        .and_then(|root| json.end().map(|()| root))
        .map_err(|e| wrong(path, e))?;
    let crs = root.crs.clone();
    match root.kind.as_deref() {
        Some("FeatureCollection") if root.has_features => {}
        Some("FeatureCollection") => return Err(Error::file(path, "the feature collection has no features member")),
        Some(kind) if is_feature(kind) => add_feature(root, 0, &mut table),
        Some(other) => return Err(Error::file(path, format!("the file is JSON of type {other:?}, not GeoJSON"))),
        None => return Err(Error::file(path, "the file is JSON, but not GeoJSON: its type member is missing")),
    }
    set_crs(crs, &mut table);
    Ok(table)
}

/// Whether an object of this type is a feature or a geometry.
pub(super) fn is_feature(kind: &str) -> bool {
    matches!(
        kind,
        "Feature"
            | "GeometryCollection"
            | "Point"
            | "MultiPoint"
            | "LineString"
            | "MultiLineString"
            | "Polygon"
            | "MultiPolygon"
    )
}

/// The error for a text that is no GeoJSON.
pub(super) fn wrong(path: &Path, error: serde_json::Error) -> Error {
    match error.classify() {
        Category::Eof => Error::file(path, "the file ends in the middle; it is not complete: copy or export it again"),
        Category::Data => {
            Error::file_cause(path, "the file is JSON, but not GeoJSON; export it again as GeoJSON", error)
        }
        _ => {
            let message =
                format!("the text is not JSON ({error}); correct this place, or export the file again as GeoJSON");
            Error::file(path, message)
        }
    }
}

/// Any GeoJSON object. One type serves all, because the `type` member may come last.
#[derive(Default)]
pub(super) struct Object {
    pub kind: Option<String>,
    parts: Vec<Part>,
    members: Vec<Object>,
    geometry: Option<Box<Object>>,
    values: Vec<(usize, Value)>,
    pub crs: Option<serde_json::Value>,
    has_features: bool,
}

pub(super) struct ObjectSeed<'t> {
    pub table: &'t mut Table,
    /// Only the root object may have features. They go directly into the table.
    pub is_root: bool,
}

impl<'de> DeserializeSeed<'de> for ObjectSeed<'_> {
    type Value = Object;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Object, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for ObjectSeed<'_> {
    type Value = Object;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object of GeoJSON")
    }

    fn visit_unit<E>(self) -> Result<Object, E> {
        Ok(Object::default())
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Object, A::Error> {
        let mut object = Object::default();
        while let Some(key) = map.next_key::<std::borrow::Cow<'_, str>>()? {
            match key.as_ref() {
                "type" => object.kind = map.next_value()?,
                "coordinates" => map.next_value_seed(Coordinates(&mut object.parts))?,
                "properties" => object.values = map.next_value_seed(Properties(self.table))?,
                "geometry" => {
                    let geometry = map.next_value_seed(ObjectSeed { table: self.table, is_root: false })?;
                    object.geometry = Some(Box::new(geometry));
                }
                "geometries" => object.members = map.next_value_seed(Geometries(self.table))?,
                "crs" if self.is_root => object.crs = Some(map.next_value()?),
                "features" if self.is_root => {
                    map.next_value_seed(Features(self.table))?;
                    object.has_features = true;
                }
                _ => {
                    map.next_value::<IgnoredAny>()?;
                }
            }
        }
        Ok(object)
    }
}

/// Declares a seed that reads an array, element by element.
macro_rules! array_seed {
    ($seed:ident, $value:ty, $what:literal, |$table:ident, $seq:ident| $body:expr) => {
        struct $seed<'t>(&'t mut Table);

        impl<'de> DeserializeSeed<'de> for $seed<'_> {
            type Value = $value;

            fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<$value, D::Error> {
                deserializer.deserialize_seq(self)
            }
        }

        impl<'de> Visitor<'de> for $seed<'_> {
            type Value = $value;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str($what)
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut $seq: A) -> Result<$value, A::Error> {
                let $table = self.0;
                $body
            }
        }
    };
}

array_seed!(Features, (), "an array of features", |table, seq| {
    let mut number = 0;
    while let Some(object) = seq.next_element_seed(ObjectSeed { table, is_root: false })? {
        if object.kind.as_deref().is_some_and(|kind| kind != "Feature") {
            return Err(A::Error::custom(format!("the member {number} of features is not a feature")));
        }
        add_feature(object, number, table);
        number += 1;
    }
    Ok(())
});

array_seed!(Geometries, Vec<Object>, "an array of geometries", |table, seq| {
    let mut members = Vec::new();
    while let Some(object) = seq.next_element_seed(ObjectSeed { table, is_root: false })? {
        members.push(object);
    }
    Ok(members)
});

struct Properties<'t>(&'t mut Table);

impl<'de> DeserializeSeed<'de> for Properties<'_> {
    type Value = Vec<(usize, Value)>;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Self::Value, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Properties<'_> {
    type Value = Vec<(usize, Value)>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object of properties")
    }

    fn visit_unit<E>(self) -> Result<Self::Value, E> {
        Ok(Vec::new())
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let mut values = Vec::new();
        while let Some(key) = map.next_key::<std::borrow::Cow<'_, str>>()? {
            let field = self.0.field(&key);
            if self.0.wants(field) {
                let value = match map.next_value()? {
                    serde_json::Value::Null => Value::Null,
                    serde_json::Value::Number(number) => Value::Number(number.as_f64().unwrap_or(f64::NAN)),
                    serde_json::Value::String(text) => Value::Text(text),
                    other => Value::Text(other.to_string()),
                };
                self.0.note(&mut values, field, value);
            } else {
                map.next_value::<IgnoredAny>()?;
            }
        }
        Ok(values)
    }
}

pub(super) fn add_feature(object: Object, number: u64, table: &mut Table) {
    let mut feature = Feature { number, ..Feature::default() };
    let geometry = if object.kind.as_deref() == Some("Feature") || object.geometry.is_some() {
        feature.values = object.values;
        object.geometry.map(|geometry| *geometry)
    } else {
        Some(object)
    };
    add_geometry(geometry.unwrap_or_default(), &mut feature, table);
    table.push(feature);
}

fn add_geometry(object: Object, feature: &mut Feature, table: &mut Table) {
    match object.kind.as_deref() {
        Some("LineString" | "MultiLineString") if !object.parts.is_empty() => {
            for part in object.parts {
                feature.push_line(part.points, &part.z);
            }
        }
        Some("Point" | "MultiPoint") if !object.parts.is_empty() => {
            for part in object.parts {
                let z = |i: usize| part.z.get(i).copied().filter(|z| !z.is_nan());
                let spots = part.points.iter().enumerate().map(|(i, &place)| Spot { place, z: z(i) });
                feature.spots.extend(spots);
            }
        }
        Some("Polygon" | "MultiPolygon") if table.wants_polygons && !object.parts.is_empty() => {
            let mut rings = Vec::new();
            for part in object.parts {
                feature.note_polygon_z(&part.z);
                rings.push(part.points);
                if part.ends_group {
                    feature.polygons.push(std::mem::take(&mut rings));
                }
            }
            feature.polygons.extend((!rings.is_empty()).then_some(rings));
        }
        Some(kind @ ("Polygon" | "MultiPolygon")) if table.wants_rings && !object.parts.is_empty() => {
            let kind = if kind == "Polygon" { "Polygon" } else { "MultiPolygon" };
            object.parts.into_iter().for_each(|part| feature.push_ring(kind, part.points, &part.z));
        }
        Some("GeometryCollection") if !object.members.is_empty() => {
            for member in object.members {
                add_geometry(member, feature, table);
            }
        }
        Some("LineString" | "MultiLineString" | "Point" | "MultiPoint" | "GeometryCollection") | None => {
            table.leave_out(NO_GEOMETRY);
        }
        Some("Polygon" | "MultiPolygon") if table.wants_polygons => table.leave_out(NO_GEOMETRY),
        Some(other) => table.leave_out(other),
    }
}

/// The system of the `crs` member. Without that member it is WGS 84 if the coordinates can be degrees.
pub(super) fn set_crs(member: Option<serde_json::Value>, table: &mut Table) {
    let Some(member) = member else {
        let lines = table.features.iter().flat_map(|f| f.lines.iter().flat_map(|line| &line.points));
        let spots = table.features.iter().flat_map(|f| f.spots.iter().map(|spot| &spot.place));
        let corners = table.features.iter().flat_map(|f| f.polygons.iter().flatten().flatten());
        if lines.chain(spots).chain(corners).all(|p| p.x.abs() <= 180.0 && p.y.abs() <= 90.0) {
            table.crs = Some(Crs::wgs84());
        } else {
            let problem = "the file does not name its coordinate reference system, and its coordinates are not degrees, \
                           as GeoJSON requires";
            table.crs_problem = Some(problem.to_owned());
        }
        return;
    };
    if member.is_null() {
        return;
    }
    let properties = &member["properties"];
    let name = properties["name"].as_str().map(str::to_owned);
    let name = name.or_else(|| properties["code"].as_u64().map(|code| format!("EPSG:{code}")));
    table.crs = name.as_deref().and_then(Crs::from_name);
    if table.crs.is_none() {
        let shown = name.unwrap_or_else(|| member.to_string());
        table.crs_problem = Some(format!("the coordinate reference system {shown:?} is not known"));
    }
}
