//! What the fuzz targets share: readers take files, so each input goes through one; for the pipeline, bytes make a map.

// Of what the tests share, the guarantees ask for this alone; the rest wants crates that are not needed here.
#[path = "../../common/crossings.rs"]
mod common;
#[path = "../../guarantees/mod.rs"]
mod guarantees;
pub mod pipeline;

use std::path::Path;

use tokosen::features::Role;
use tokosen::io::raster::read_dem;
use tokosen::io::{ReadOptions, read_area, read_contours, read_features, read_spot_heights};

/// Writes an input to a file with this extension and hands over its path.
pub fn with_file(data: &[u8], extension: &str, read: impl Fn(&Path)) {
    let suffix = format!(".{extension}");
    let file = tempfile::Builder::new().suffix(&suffix).tempfile().expect("there is room for a small file");
    std::fs::write(file.path(), data).expect("there is room for a small file");
    read(file.path());
}

/// All that is read of a vector file. Errors are fine, panics are not.
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
