//! Features in memory, as another program holds them: a source like a file.
//!
//! They go into the same table as the features of a file. So the same rules find elevations, kinds and standard errors.

use std::path::Path;
use std::sync::Arc;

use super::geojson;
use super::gpkg::wkb;
use super::table::{Feature, NO_GEOMETRY, Request, Table, Value};
use tokosen_core::base::error::{Error, Result};
use tokosen_core::crs::Crs;

/// Features in memory. Copies share them.
#[derive(Debug, Clone)]
pub struct InMemory(Arc<Content>);

#[derive(Debug)]
enum Content {
    GeoJson(Vec<u8>),
    Features(MemoryLayer),
}

/// Features as columns: their geometries, and attributes.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MemoryLayer {
    /// The geometries as well-known binary (WKB), one after the other.
    pub wkb: Vec<u8>,
    /// Where each geometry starts in `wkb`, and at the end its length. A feature of no bytes has no geometry.
    pub offsets: Vec<usize>,
    /// The attributes: their names, and a value for each feature.
    pub attributes: Vec<(String, Attribute)>,
    /// The coordinate reference system, if it is known.
    pub crs: Option<Crs>,
}

/// The values of an attribute, one for each feature.
#[derive(Debug, Clone, PartialEq)]
pub enum Attribute {
    /// Numbers; NaN where there is no value.
    Numbers(Vec<f64>),
    /// Texts.
    Texts(Vec<Option<String>>),
}

impl Attribute {
    fn len(&self) -> usize {
        match self {
            Self::Numbers(values) => values.len(),
            Self::Texts(values) => values.len(),
        }
    }

    fn value(&self, feature: usize) -> Value {
        match self {
            Self::Numbers(values) => {
                values.get(feature).filter(|z| !z.is_nan()).map_or(Value::Null, |z| Value::Number(*z))
            }
            Self::Texts(values) => values.get(feature).cloned().flatten().map_or(Value::Null, Value::Text),
        }
    }
}

/// Two are the same if they share their features.
impl PartialEq for InMemory {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl Eq for InMemory {}

impl From<MemoryLayer> for InMemory {
    fn from(features: MemoryLayer) -> Self {
        Self(Arc::new(Content::Features(features)))
    }
}

impl InMemory {
    /// The text of a GeoJSON file.
    pub fn geojson(text: Vec<u8>) -> Self {
        Self(Arc::new(Content::GeoJson(text)))
    }

    /// The features as a table. `name` stands for the path of a file in messages.
    pub(super) fn read(&self, name: &Path, request: &Request<'_>) -> Result<Table> {
        match &*self.0 {
            Content::GeoJson(text) => geojson::parse(name, text, request),
            Content::Features(features) => features.read(name, request),
        }
    }
}

impl MemoryLayer {
    fn read(&self, name: &Path, request: &Request<'_>) -> Result<Table> {
        let Self { wkb, offsets, attributes, crs } = self;
        let count = offsets.len().saturating_sub(1);
        if let Some((attribute, values)) = attributes.iter().find(|(_, values)| values.len() != count) {
            let message = format!("there are {} values of {attribute:?} for {count} features", values.len());
            return Err(Error::file(name, message));
        }
        let mut table = Table::new(request);
        let fields: Vec<usize> = attributes.iter().map(|(attribute, _)| table.field(attribute)).collect();
        for (k, number) in (0..count).zip(0..) {
            let mut feature = Feature { number, ..Feature::default() };
            for (&field, (_, values)) in fields.iter().zip(attributes) {
                if table.wants(field) {
                    table.note(&mut feature.values, field, values.value(k));
                }
            }
            let wrong = |what: &str| Error::file(name, format!("feature {number}: {what}"));
            match wkb.get(offsets[k]..offsets[k + 1]) {
                None => return Err(wrong("the offsets of its geometry are wrong")),
                Some([]) => table.leave_out(NO_GEOMETRY),
                Some(geometry) => wkb::read(geometry, &mut feature, &mut table).map_err(|what| wrong(&what))?,
            }
            table.push(feature);
        }
        table.crs.clone_from(crs);
        Ok(table)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::Purpose;

    /// A line from (0, 0) to (`x`, 1) as WKB.
    fn line(x: f64) -> Vec<u8> {
        let numbers = [0.0, 0.0, x, 1.0_f64].map(f64::to_le_bytes);
        [&[1, 2, 0, 0, 0, 2, 0, 0, 0], numbers.as_flattened()].concat()
    }

    fn read(features: MemoryLayer) -> Result<Table> {
        let request =
            Request { elevation_field: Some("H"), layer: None, purpose: Purpose::Contours, within: None, memory: None };
        InMemory::from(features).read(Path::new("contours"), &request)
    }

    #[test]
    fn features_keep_their_numbers_and_the_values_that_count() {
        let wkb = [line(1.0), line(2.0)].concat();
        let attributes = vec![
            ("h".to_owned(), Attribute::Numbers(vec![10.0, 15.0, f64::NAN])),
            ("name".to_owned(), Attribute::Texts(vec![None, None, Some("x".to_owned())])),
        ];
        let offsets = vec![0, wkb.len() / 2, wkb.len() / 2, wkb.len()];
        let table = read(MemoryLayer { wkb, offsets, attributes, crs: Some(Crs::wgs84()) }).unwrap();
        let found: Vec<_> =
            table.features.iter().map(|f| (f.number, f.lines[0].points[1].x, f.values.clone())).collect();
        assert_eq!(found, [(0, 1.0, vec![(0, Value::Number(10.0))]), (2, 2.0, vec![(0, Value::Null)])]);
        assert_eq!(table.left_out.get(NO_GEOMETRY), Some(&1));
        assert_eq!((table.crs, table.fields[1].example.as_deref()), (Some(Crs::wgs84()), Some("\"x\"")));
    }

    #[test]
    fn columns_that_do_not_fit_and_broken_geometries_are_told() {
        let fault = |features| read(features).err().map(|error| error.to_string()).unwrap();
        let attributes = vec![("h".to_owned(), Attribute::Numbers(vec![10.0]))];
        let two = MemoryLayer { wkb: line(1.0), offsets: vec![0, 41, 41], attributes, crs: None };
        assert_eq!(fault(two.clone()), "contours: there are 1 values of \"h\" for 2 features");
        let cut = MemoryLayer { offsets: vec![0, 20], ..two.clone() };
        assert_eq!(fault(cut), "contours: feature 0: its geometry ends too early");
        let beyond = MemoryLayer { offsets: vec![0, 99], ..two };
        assert_eq!(fault(beyond), "contours: feature 0: the offsets of its geometry are wrong");
    }
}
