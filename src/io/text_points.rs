//! Reads tables in text: CSV with a header, or lines of x, y and height.
//!
//! Fields are separated by commas, semicolons, tabs or spaces. The header names the coordinates: x and y, easting and
//! northing, lon and lat; or a column has geometries as well-known text, such as lines. The other columns are attributes,
//! so the height is found as in every other format. Without a header, there are three columns: x, y, height.

use std::path::Path;

use csv::{ReaderBuilder, StringRecord, Trim};
use encoding_rs::{SHIFT_JIS, UTF_8, WINDOWS_1252};
use glam::DVec2;

use super::shapefile::encoding::{self, Guess};
use super::table::{Feature, NO_GEOMETRY, Request, Spot, Table, Value};
use super::{text, wkt};
use tokosen_core::base::error::{Error, Finding, FindingKind, Result};
use tokosen_core::crs::Crs;

/// Extensions of such files.
const EXTENSIONS: [&str; 4] = ["csv", "tsv", "txt", "xyz"];

/// Names of the coordinates to the east and to the north, in lower case.
const EAST: [&str; 10] = ["x", "e", "east", "easting", "eastings", "xcoord", "x_coord", "point_x", "coord_x", "pos_x"];
const NORTH: [&str; 10] =
    ["y", "n", "north", "northing", "northings", "ycoord", "y_coord", "point_y", "coord_y", "pos_y"];
/// The same for degrees.
const LONGITUDE: [&str; 5] = ["lon", "long", "lng", "longitude", "経度"];
const LATITUDE: [&str; 3] = ["lat", "latitude", "緯度"];
/// WGS 84, the system of longitudes and latitudes in a file that names none.
const WGS_84: u32 = 4326;

/// Whether a path is read as such text.
pub(super) fn is_source(path: &Path) -> bool {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    EXTENSIONS.contains(&extension.as_str())
}

/// Names of columns that hold geometries as well-known text, in lower case.
const GEOMETRY: [&str; 9] =
    ["wkt", "geom", "geometry", "the_geom", "wkt_geom", "geom_wkt", "wkt_geometry", "geometry_wkt", "shape"];

/// Where the coordinates are.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Place {
    /// Columns to the east and to the north.
    Coordinates { east: usize, north: usize, in_degrees: bool },
    /// A column of geometries.
    Geometry(usize),
}

impl Place {
    fn is_in(self, column: usize) -> bool {
        match self {
            Self::Coordinates { east, north, .. } => column == east || column == north,
            Self::Geometry(geometry) => column == geometry,
        }
    }
}

/// What the header says.
struct Columns {
    place: Place,
    /// The names of all columns.
    names: Vec<String>,
}

/// Reads points or geometries, and the columns of a header as attributes.
pub(super) fn read(path: &Path, request: &Request<'_>) -> Result<Table> {
    let bytes = text::read(path, request.memory, |_| None)?;
    let text = decoded(&bytes, request.elevation_field);
    let first = text.lines().map(str::trim).find(|line| !line.is_empty() && !line.starts_with('#'));
    let first = first.ok_or_else(|| Error::empty(path))?;
    let separator = [b';', b'\t', b','].into_iter().find(|&separator| first.contains(char::from(separator)));
    let mut table = Table::new(request);
    let mut columns: Option<(Columns, Vec<Option<usize>>)> = None;
    let mut srids: Vec<Option<u32>> = Vec::new();
    for_each_row(&text, separator, &mut |line, row| {
        let (columns, fields) = match &mut columns {
            Some(known) => known,
            None => {
                let (found, is_header) = columns_of(row).map_err(|message| Error::file(path, message))?;
                let is_attribute = |column: &usize| !found.place.is_in(*column);
                let attributes = (0..found.names.len()).map(|k| Some(k).filter(is_attribute));
                let fields = attributes.map(|k| Some(table.field(&found.names[k?]))).collect();
                let known = columns.insert((found, fields));
                if is_header {
                    return Ok(());
                }
                known
            }
        };
        let mut feature = Feature { number: line, ..Feature::default() };
        match columns.place {
            Place::Coordinates { east, north, .. } => {
                let place = [east, north].map(|k| row.get(k).and_then(number));
                let [Some(x), Some(y)] = place else {
                    let message = format!("line {line} left out: it has no coordinates");
                    table.findings.push(Finding::general(FindingKind::SkippedFeature, message));
                    return Ok(());
                };
                feature.spots.push(Spot { place: DVec2::new(x, y), z: None });
            }
            Place::Geometry(column) => {
                let text = row.get(column).unwrap_or_default();
                if text.is_empty() {
                    table.leave_out(NO_GEOMETRY);
                    return Ok(());
                }
                let srid = wkt::srid(text).0;
                if !srids.contains(&srid) {
                    srids.push(srid);
                }
                wkt::add(text, &mut feature, &mut table)
                    .map_err(|what| Error::Data(format!("line {line}: the geometry {what}")))?;
            }
        }
        for (value, field) in row.iter().zip(fields) {
            let Some(field) = field.filter(|field| table.wants(*field)) else { continue };
            let value = match number(value) {
                Some(number) => Value::Number(number),
                None if value.is_empty() => Value::Null,
                None => Value::Text(value.to_owned()),
            };
            table.note(&mut feature.values, field, value);
        }
        table.push(feature);
        Ok(())
    })
    .map_err(|error| error.in_file(path))?;
    match (columns.map(|(columns, _)| columns.place), &srids[..]) {
        (Some(Place::Coordinates { in_degrees: true, .. }), _) => table.crs = Some(Crs::from_epsg(WGS_84)),
        (Some(Place::Geometry(_)), [Some(code)]) => table.crs = Some(Crs::from_epsg(*code)),
        (Some(Place::Geometry(_)), [_, _, ..]) => {
            let message = "its geometries have several coordinate reference systems (SRID); write them in one";
            return Err(Error::file(path, message));
        }
        _ => {}
    }
    Ok(table)
}

/// Text in UTF-8, otherwise in an encoding in which the header has a known name or the one that the user `named`, otherwise
/// in Shift JIS, otherwise in the encoding of western Europe.
fn decoded(bytes: &[u8], named: Option<&str>) -> String {
    if let Ok(text) = std::str::from_utf8(bytes) {
        return text.trim_start_matches('\u{feff}').to_owned();
    }
    let header = bytes.split(|&byte| byte == b'\n').find(|line| !line.trim_ascii().is_empty()).unwrap_or_default();
    let names: Vec<Vec<u8>> =
        header.split(|byte| b",;\t \r\"".contains(byte)).filter(|name| !name.is_empty()).map(<[u8]>::to_vec).collect();
    let Guess { encoding, is_sure } = encoding::guessed(&names, named, None);
    if is_sure && encoding != UTF_8 {
        return encoding.decode(bytes).0.into_owned();
    }
    let (text, _, is_wrong) = SHIFT_JIS.decode(bytes);
    if is_wrong { WINDOWS_1252.decode(bytes).0.into_owned() } else { text.into_owned() }
}

/// Calls `visit` with each row and the number of its line. Fields are separated by spaces if `separator` is `None`.
fn for_each_row(
    text: &str,
    separator: Option<u8>,
    visit: &mut dyn FnMut(u64, &StringRecord) -> Result<()>,
) -> Result<()> {
    let Some(separator) = separator else {
        for (number, line) in (1..).zip(text.lines()) {
            let row: StringRecord = line.split_whitespace().collect();
            if !row.is_empty() && !line.trim_start().starts_with('#') {
                visit(number, &row)?;
            }
        }
        return Ok(());
    };
    let mut builder = ReaderBuilder::new();
    builder.delimiter(separator).has_headers(false).flexible(true).trim(Trim::All).comment(Some(b'#'));
    for row in builder.from_reader(text.as_bytes()).records() {
        let row = row.map_err(|e| Error::Data(format!("the text cannot be read: {e}")))?;
        let line = row.position().map_or(0, csv::Position::line);
        if row.iter().any(|field| !field.is_empty()) {
            visit(line, &row)?;
        }
    }
    Ok(())
}

/// The columns that the first row tells of, and whether it is a header.
fn columns_of(row: &StringRecord) -> Result<(Columns, bool), String> {
    if row.iter().all(|field| number(field).is_some()) {
        return match row.len() {
            3 => {
                let names = ["x", "y", "z"].map(str::to_owned).to_vec();
                Ok((Columns { place: Place::Coordinates { east: 0, north: 1, in_degrees: false }, names }, false))
            }
            n => Err(format!("it has {n} columns and no header: add a line such as x,y,z above the first point")),
        };
    }
    let names: Vec<String> = row.iter().map(str::to_owned).collect();
    let column = |known: &[&str]| names.iter().position(|name| known.contains(&name.to_lowercase().as_str()));
    let pair = |east: &[&str], north: &[&str]| column(east).zip(column(north));
    if let Some(column) = column(&GEOMETRY) {
        return Ok((Columns { place: Place::Geometry(column), names }, true));
    }
    let found = pair(&LONGITUDE, &LATITUDE).map(|pair| (pair, true)).or(pair(&EAST, &NORTH).map(|pair| (pair, false)));
    match found {
        Some(((east, north), in_degrees)) => {
            Ok((Columns { place: Place::Coordinates { east, north, in_degrees }, names }, true))
        }
        None => Err(format!(
            "no columns are known to hold coordinates; name them x and y, easting and northing, lon and lat, or WKT for \
             geometries as well-known text, in the first line, which is {}",
            names.join(", ")
        )),
    }
}

/// A number, also with a comma before its decimals.
fn number(text: &str) -> Option<f64> {
    let text = text.trim();
    text.parse().ok().or_else(|| text.replacen(',', ".", 1).parse().ok())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ReadOptions, read_spot_heights};

    /// The points that a text holds, and their system.
    fn read(text: &[u8]) -> Result<(Vec<[f64; 3]>, Option<u32>, usize)> {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("points.csv");
        std::fs::write(&path, text).expect("a file");
        let read = read_spot_heights(&path, &ReadOptions::default())?;
        let skipped = read.findings.iter().filter(|f| f.kind != FindingKind::UnknownCrs).count();
        let points = read.value.points.iter().map(|p| p.to_array()).collect();
        Ok((points, read.value.crs.and_then(|crs| crs.epsg), skipped))
    }

    #[test]
    fn separators_headers_and_encodings() {
        let both = vec![[1.5, 2.0, 30.0], [4.0, 5.0, 60.25]];
        let shift_jis = SHIFT_JIS.encode("番号,x,y,標高\n一,1.5,2,30\n二,4,5,60.25\n").0.into_owned();
        let cases: [(&[u8], Option<u32>); 9] = [
            (b"x,y,z\n1.5,2,30\n4,5,60.25\n", None),
            (b"\xef\xbb\xbfname;Easting;Northing;Elev\nA;1,5;2;30\n\"B;C\";4;5;60,25\n", None),
            (b"# made by hand\n1.5 2 30\n\n  4   5 60.25\n", None),
            (b"1.5\t2\t30\r\n4\t5\t60.25\r\n", None),
            (b"id,lat,lon,elevation\n1,2,1.5,30\n2,5,4,60.25", Some(4326)),
            (&shift_jis, None),
            (b"N E H elev\n2 1.5 0 30\n5 4 0 60.25\n", None),
            (b"POINT_X,POINT_Y,HEIGHT\n1.5,2,30\n4,5,60.25\n", None),
            (b"x y z\n1.5 2 30\n4 5 60.25\n", None),
        ];
        for (text, crs) in cases {
            assert_eq!(read(text).expect("points"), (both.clone(), crs, 0), "{}", String::from_utf8_lossy(text));
        }
    }

    #[test]
    fn what_cannot_be_used_is_told() {
        let (points, _, skipped) = read(b"x,y,z\n1,2,30\nn/a,3,40\n5,6,\n7,8,90\n").expect("points");
        assert_eq!((points.len(), skipped), (2, 2));
        for (text, words) in [
            (&b"1,2,3,4\n5,6,7,8\n"[..], "4 columns and no header"),
            (b"a,b,z\n1,2,3\n", "name them x and y"),
            (b"x,y,name\n1,2,hill\n", "no field"),
            (b"\n", "empty"),
            (b"x,y,z\n", "no point"),
        ] {
            let message = read(text).expect_err("an error").to_string();
            assert!(message.contains(words), "{message}");
        }
    }
}
