//! Recognises files that this program made.
//!
//! Formats with a place for it name the program, as other GIS programs do too. Such a file may be replaced without
//! asking: whoever made it can make it again. ESRI ASCII grids, text files and shapefiles have no such place.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use tiff::decoder::Decoder;
use tiff::tags::Tag;
use zip::ZipArchive;

use super::ordinary::open_to_read;
use super::{geoparquet, tiles};

/// The name of the program in files.
pub(super) const PROGRAM: &str = "tokosen";
/// The statement in the properties of a GeoJSON, FlatGeobuf, DXF or page.
pub(super) const MADE_BY: &str = "made by tokosen";
/// The statement in the file of a saved run.
pub const SAVED_RUN: &str = "run saved by tokosen";
/// Bytes at the beginning of a file in which the statement is.
const HEAD: u64 = 1 << 14;

/// Statements at the beginning of a file, by its extension.
const STATEMENTS: &[(&[&str], &[u8])] = &[
    (&["geojson", "json"], b"\"description\":\"made by tokosen\""),
    (&["json"], b"\"description\": \"run saved by tokosen\""),
    (&["json"], b"\"description\": \"made by tokosen\""),
    (&["fgb"], b"made by tokosen"),
    (&["dxf"], b"999\nmade by tokosen\n"),
    (&["png"], b"tEXtSoftware\0tokosen"),
    (&["exr"], b"software\0string\0\x07\0\0\0tokosen"),
    (&["glb"], b"\"generator\":\"tokosen\""),
    (&["obj"], b"# tokosen\n"),
    (&["ply"], b"\ncomment tokosen\n"),
    (&["xml"], b"<Application name=\"tokosen\""),
    (&["stl"], b"tokosen, in mm"),
    (&["pdf"], b"/Producer (tokosen)"),
    (&["svg", "kml"], b"<!-- made by tokosen -->"),
    (&["html", "htm"], b"<meta name=\"generator\" content=\"tokosen\">"),
];

/// Whether this program made the file, or the file is empty. A file that cannot be read was made by another program.
pub(super) fn is_own(path: &Path) -> bool {
    if path.is_dir() {
        return tiles::is_own_folder(path);
    }
    let Ok(file) = open_to_read(path) else { return false };
    if file.metadata().is_ok_and(|meta| meta.len() == 0) {
        return true;
    }
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    if matches!(extension.as_str(), "tif" | "tiff") {
        return software(file).is_some_and(|software| software == PROGRAM);
    }
    match extension.as_str() {
        "parquet" | "geoparquet" => return geoparquet::is_own(file),
        "kmz" | "3mf" => return ZipArchive::new(file).is_ok_and(|archive| archive.comment() == MADE_BY.as_bytes()),
        "pmtiles" => return tiles::is_own_pmtiles(file),
        "mbtiles" => return tiles::is_own_mbtiles(path),
        _ => {}
    }
    let mut head = Vec::new();
    if file.take(HEAD).read_to_end(&mut head).is_err() {
        return false;
    }
    let known = STATEMENTS.iter().filter(|(names, _)| names.contains(&extension.as_str()));
    known.into_iter().any(|(_, statement)| head.windows(statement.len()).any(|bytes| bytes == *statement))
}

/// The program that a GeoTIFF names.
fn software(file: File) -> Option<String> {
    Decoder::new(BufReader::new(file)).ok()?.get_tag_ascii_string(Tag::Software).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_other_programs_are_not_own() {
        let dir = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &[u8]| {
            let path = dir.path().join(name);
            std::fs::write(&path, text).unwrap();
            path
        };
        assert!(is_own(&write("empty.tif", b"")));
        assert!(is_own(&write("a.PLY", b"ply\nformat ascii 1.0\ncomment tokosen\n")));
        assert!(!is_own(&write("b.ply", b"ply\nformat ascii 1.0\ncomment tokosen likes this\n")));
        assert!(is_own(&write("run.json", format!("{{\n  \"description\": \"{SAVED_RUN}\"\n}}").as_bytes())));
        assert!(is_own(&write("lines.json", b"{\"description\":\"made by tokosen\"}")));
        assert!(!is_own(&write("other.json", b"{}")));
        assert!(!is_own(&write("c.geojson", b"{\"type\":\"FeatureCollection\",\"name\":\"tokosen\"}")));
        assert!(!is_own(&write("d.tif", b"no picture")));
        assert!(!is_own(&write("e.asc", b"made by tokosen")));
        assert!(!is_own(&dir.path().join("missing.geojson")));
    }
}
