//! The sets of tiles in a folder that this program made.

use std::fs::{self, File};
use std::io;
use std::path::Path;

use super::format::{is_own_folder, is_own_pmtiles};

/// A set of tiles that a web server can give out: an archive, or a folder of files.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct TileSet {
    /// The name of the archive or of the folder.
    pub name: String,
    /// The extension of its tiles, if it is a folder.
    pub extension: Option<String>,
}

/// The sets in a folder that this program made, by name. MBTiles are none of them: a web server cannot give out parts of a
/// database. Names that are no text are left out.
///
/// # Errors
/// The folder cannot be read.
pub fn tile_sets(folder: &Path) -> io::Result<Vec<TileSet>> {
    let mut sets = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        let Some(name) = path.file_name().and_then(|name| name.to_str()).map(str::to_owned) else { continue };
        let is_archive = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("pmtiles")) && path.is_file();
        if is_archive && File::open(&path).is_ok_and(is_own_pmtiles) {
            sets.push(TileSet { name, extension: None });
        } else if path.is_dir() && is_own_folder(&path) {
            // An empty folder has no tile.
            let extension = first_tile(&path);
            sets.extend(extension.map(|extension| TileSet { name, extension: Some(extension) }));
        }
    }
    sets.sort();
    Ok(sets)
}

/// The extension of a tile in a folder `{z}/{x}/{y}.EXTENSION`.
fn first_tile(folder: &Path) -> Option<String> {
    let inside = |folder: &Path| fs::read_dir(folder).ok()?.filter_map(|entry| Some(entry.ok()?.path())).next();
    let zoom = fs::read_dir(folder).ok()?.filter_map(|entry| Some(entry.ok()?.path())).find(|path| path.is_dir())?;
    let tile = inside(&inside(&zoom)?)?;
    Some(tile.extension()?.to_str()?.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_sets_of_this_program_are_found() {
        let dir = tempfile::tempdir().unwrap();
        let put = |name: &str, text: &str| {
            let path = dir.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        };
        put("other.pmtiles", "PMTiles");
        put("mine/metadata.json", "{\"description\":\"made by tokosen\"}");
        put("mine/11/3/5.pbf", "");
        put("theirs/metadata.json", "{\"description\":\"mine\"}");
        put("theirs/11/3/5.pbf", "");
        fs::create_dir(dir.path().join("empty")).unwrap();
        let found = tile_sets(dir.path()).unwrap();
        assert_eq!(found, [TileSet { name: "mine".into(), extension: Some("pbf".into()) }]);
        assert!(tile_sets(&dir.path().join("missing")).is_err());
    }
}
