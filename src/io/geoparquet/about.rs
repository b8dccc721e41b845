//! What a file says about its geometries: the column that holds them, their coordinate reference system, and the columns with
//! their boxes.

use parquet::basic::{LogicalType, Type as Physical};
use parquet::file::metadata::FileMetaData;
use serde_json::Value;

use tokosen_core::crs::Crs;

/// The key of GeoParquet's metadata.
pub(super) const KEY: &str = "geo";
/// The key of the well-known text of a system that has no code. Only this program writes and reads it.
pub(super) const WKT_KEY: &str = "tokosen_crs_wkt";

/// The geometries of a file.
pub(super) struct Geometries {
    /// The number of their column among the leaves of the schema.
    pub leaf: usize,
    pub crs: Option<Crs>,
    /// Why there is no coordinate reference system, if the file names one.
    pub crs_problem: Option<String>,
    /// The columns of least x, least y, greatest x and greatest y, among the leaves.
    pub boxes: Option<[usize; 4]>,
}

/// Finds the geometries of a file, or says why there are none that can be read.
pub(super) fn geometries(file: &FileMetaData) -> Result<Geometries, String> {
    match metadata(file, KEY) {
        Some(text) => by_metadata(file, text),
        None => by_type(file),
    }
}

/// The value of a key in the file's metadata.
fn metadata<'a>(file: &'a FileMetaData, key: &str) -> Option<&'a str> {
    let entries = file.key_value_metadata()?;
    entries.iter().find(|entry| entry.key == key).and_then(|entry| entry.value.as_deref())
}

/// As GeoParquet states it.
fn by_metadata(file: &FileMetaData, text: &str) -> Result<Geometries, String> {
    let about: Value = serde_json::from_str(text).map_err(|e| format!("its metadata 'geo' is not valid: {e}"))?;
    let name = about["primary_column"].as_str().ok_or("its metadata 'geo' names no column")?;
    let column = &about["columns"][name];
    match column["encoding"].as_str() {
        Some("WKB") => {}
        Some(other) => {
            return Err(format!(
                "its geometries are stored as {other:?}, which is not read; write them as WKB, for example with geopandas"
            ));
        }
        None => return Err(format!("its metadata 'geo' does not describe the column {name:?}")),
    }
    let leaf = leaf(file, &[name]).ok_or_else(|| format!("there is no column {name:?} with geometries"))?;
    let (crs, crs_problem) = match column.get("crs") {
        // Without an entry, coordinates are longitudes and latitudes. With null, nobody knows.
        None => (Some(Crs::wgs84()), None),
        Some(Value::Null) => (None, None),
        Some(value) => match (Crs::from_projjson(value), metadata(file, WKT_KEY)) {
            (None, Some(text)) => (Some(Crs::from_wkt(text)), None),
            _ => known(value),
        },
    };
    let side = |key: &str| -> Option<usize> {
        let path: Vec<&str> =
            column["covering"]["bbox"][key].as_array()?.iter().map(Value::as_str).collect::<Option<_>>()?;
        leaf_of_numbers(file, &path)
    };
    let sides: Option<Vec<usize>> = ["xmin", "ymin", "xmax", "ymax"].into_iter().map(side).collect();
    Ok(Geometries { leaf, crs, crs_problem, boxes: sides.and_then(|sides| sides.try_into().ok()) })
}

/// By the types of the columns. Their geometries are always WKB.
fn by_type(file: &FileMetaData) -> Result<Geometries, String> {
    let columns = file.schema_descr().columns();
    let found = columns.iter().enumerate().find_map(|(leaf, column)| match column.logical_type_ref()? {
        LogicalType::Geometry(kind) => Some((leaf, kind.crs.as_deref())),
        LogicalType::Geography(kind) => Some((leaf, kind.crs.as_deref())),
        _ => None,
    });
    let (leaf, named) = found.filter(|(leaf, _)| columns[*leaf].max_rep_level() == 0).ok_or(
        "no column has geometries: neither the metadata 'geo' of GeoParquet nor the type GEOMETRY is there; write it with geopandas \
         or with ogr2ogr",
    )?;
    let (crs, crs_problem) = match named.map(str::trim) {
        None | Some("") => (Some(Crs::wgs84()), None),
        Some(text) => {
            let entry = text.strip_prefix("projjson:").and_then(|key| metadata(file, key)).unwrap_or(text);
            match (serde_json::from_str::<Value>(entry), text.strip_prefix("srid:")) {
                (_, Some("0")) => (None, None),
                (_, Some(code)) => known(&Value::String(format!("EPSG:{code}"))),
                (Ok(value), None) if value.is_object() => known(&value),
                _ => known(&Value::String(entry.to_owned())),
            }
        }
    };
    Ok(Geometries { leaf, crs, crs_problem, boxes: None })
}

/// The system of a PROJJSON or of a name, or why it is not known.
fn known(value: &Value) -> (Option<Crs>, Option<String>) {
    let found = value.as_str().map_or_else(|| Crs::from_projjson(value), Crs::from_name);
    let name = || value["name"].as_str().or(value.as_str()).unwrap_or("without a name").to_owned();
    let problem = found.is_none().then(|| {
        format!("the coordinate reference system {:?} has no EPSG code in the file, so it is not known", name())
    });
    (found, problem)
}

/// The number of a leaf that is not repeated and holds bytes.
fn leaf(file: &FileMetaData, path: &[&str]) -> Option<usize> {
    let columns = file.schema_descr().columns();
    columns.iter().position(|column| {
        column.path().parts() == path && column.physical_type() == Physical::BYTE_ARRAY && column.max_rep_level() == 0
    })
}

/// The number of a leaf that is not repeated and holds numbers.
fn leaf_of_numbers(file: &FileMetaData, path: &[&str]) -> Option<usize> {
    let columns = file.schema_descr().columns();
    let is_number = |kind| matches!(kind, Physical::FLOAT | Physical::DOUBLE);
    columns.iter().position(|column| {
        column.path().parts() == path && is_number(column.physical_type()) && column.max_rep_level() == 0
    })
}
