//! What the fuzz targets of readers call. Readers take files, so each input goes through one. Errors are fine, panics are not.

use std::path::Path;

use tokosen::features::Role;
use tokosen::io::raster::read_dem;
use tokosen::io::{ReadOptions, read_area, read_contours, read_features, read_spot_heights};

/// All that is read of a vector file.
pub fn vectors(data: &[u8], extension: &str) {
    with_file(data, extension, |path| {
        let options = ReadOptions::default();
        let _ = read_contours(path, &options);
        let _ = read_spot_heights(path, &options);
        let _ = read_area(path, &options);
        for role in Role::all() {
            let _ = read_features(role, path, &options);
        }
    });
}

/// A height map.
pub fn heights(data: &[u8], extension: &str) {
    with_file(data, extension, |path| drop(read_dem(path)));
}

/// Writes an input to a file with this extension and hands over its path.
fn with_file(data: &[u8], extension: &str, read: impl Fn(&Path)) {
    let suffix = format!(".{extension}");
    let file = tempfile::Builder::new().suffix(&suffix).tempfile().expect("there is room for a small file");
    std::fs::write(file.path(), data).expect("there is room for a small file");
    read(file.path());
}
