//! The kinds of tile sets, by their path, and how one that this program made is recognised.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use flate2::read::GzDecoder;
use rusqlite::{Connection, OpenFlags};

use crate::maker::MADE_BY;
use crate::staged::StagedOutput;
use tokosen_core::base::error::Result;

/// Where the length and the place of the metadata stand in a PMTiles archive (version 3), bytes.
const METADATA_PLACE: usize = 24;
const HEADER: usize = 127;
/// Most bytes of metadata that are looked at.
const MOST: u64 = 1 << 20;
/// The file that describes a folder of tiles.
pub(super) const METADATA_FILE: &str = "metadata.json";

/// What tiles are written into.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TileFormat {
    /// `.pmtiles`: one archive, version 3.
    PmTiles,
    /// `.mbtiles`: an SQLite database.
    MbTiles,
    /// `FOLDER/{z}/{x}/{y}.pbf`: a file for each tile.
    Folder,
}

impl TileFormat {
    /// The kind of a path; none if it does not name tiles.
    pub fn of(path: &Path) -> Option<Self> {
        if Self::folder(path).is_some() {
            return Some(Self::Folder);
        }
        match path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase().as_str() {
            "pmtiles" => Some(Self::PmTiles),
            "mbtiles" => Some(Self::MbTiles),
            _ => None,
        }
    }

    /// The folder that tiles at `FOLDER/{z}/{x}/{y}.EXT` are in, and the extension.
    pub fn folder(path: &Path) -> Option<(PathBuf, &str)> {
        let extension = path.file_name()?.to_str()?.strip_prefix("{y}.")?;
        let column = path.parent()?;
        let zoom = column.parent()?;
        let is_pattern = column.file_name()? == "{x}" && zoom.file_name()? == "{z}";
        let folder = zoom.parent().filter(|folder| folder.file_name().is_some())?;
        (is_pattern && !extension.is_empty()).then(|| (folder.to_owned(), extension))
    }

    /// What appears for a path: the file, or the folder.
    pub fn target(path: &Path) -> PathBuf {
        Self::folder(path).map_or_else(|| path.to_owned(), |(folder, _)| folder)
    }

    /// Whether contours can be written to a path of tiles: in a folder, their tiles are `.pbf` or `.mvt`.
    pub fn takes_contours(path: &Path) -> bool {
        Self::folder(path).is_none_or(|(_, extension)| ["pbf", "mvt"].contains(&extension))
    }

    /// Opens the output at a path: a folder for the tiles of a folder, otherwise a file.
    ///
    /// # Errors
    /// As [`StagedOutput::create`].
    pub fn open(path: &Path) -> Result<StagedOutput> {
        match Self::folder(path) {
            Some((folder, _)) => StagedOutput::create_folder(&folder),
            None => StagedOutput::create(path),
        }
    }
}

/// Whether a PMTiles archive states that this program made it.
pub(crate) fn is_own_pmtiles(mut file: File) -> bool {
    let mut header = [0; HEADER];
    if file.read_exact(&mut header).is_err() || !header.starts_with(b"PMTiles\x03") {
        return false;
    }
    let number = |at: usize| {
        let bytes: [u8; 8] = header[at..at + 8].try_into().unwrap_or_default();
        u64::from_le_bytes(bytes)
    };
    let (place, length) = (number(METADATA_PLACE), number(METADATA_PLACE + 8));
    let mut text = Vec::new();
    length <= MOST
        && file.seek(SeekFrom::Start(place)).is_ok()
        && GzDecoder::new(file.take(length)).take(MOST).read_to_end(&mut text).is_ok()
        && states_maker(&text)
}

/// Whether an MBTiles database states that this program made it.
pub(crate) fn is_own_mbtiles(path: &Path) -> bool {
    let mode = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let stated = Connection::open_with_flags(path, mode).and_then(|db| {
        let query = "SELECT value FROM metadata WHERE name = 'description'";
        db.query_row(query, [], |row| row.get::<_, String>(0))
    });
    stated.is_ok_and(|text| text == MADE_BY)
}

/// Whether a folder is empty, or has a description which states that this program made it.
pub(crate) fn is_own_folder(folder: &Path) -> bool {
    let is_empty = std::fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_none());
    let mut text = Vec::new();
    let mut described =
        || File::open(folder.join(METADATA_FILE)).and_then(|file| file.take(MOST).read_to_end(&mut text));
    is_empty || (described().is_ok() && states_maker(&text))
}

/// The first entry of a folder that does not belong to tiles; none if there is no such entry.
///
/// # Errors
/// A folder cannot be read.
pub(crate) fn foreign_entry(folder: &Path) -> std::io::Result<Option<PathBuf>> {
    for zoom in std::fs::read_dir(folder)? {
        let zoom = zoom?;
        if zoom.file_name() == METADATA_FILE {
            continue;
        }
        if !is_number(zoom.file_name().to_str()) || !zoom.file_type()?.is_dir() {
            return Ok(Some(zoom.path()));
        }
        for column in std::fs::read_dir(zoom.path())? {
            let column = column?;
            if !is_number(column.file_name().to_str()) || !column.file_type()?.is_dir() {
                return Ok(Some(column.path()));
            }
            for tile in std::fs::read_dir(column.path())? {
                let tile = tile?;
                let name = PathBuf::from(tile.file_name());
                let is_tile = is_number(name.file_stem().and_then(|stem| stem.to_str())) && tile.file_type()?.is_file();
                if !is_tile {
                    return Ok(Some(tile.path()));
                }
            }
        }
    }
    Ok(None)
}

fn is_number(name: Option<&str>) -> bool {
    name.is_some_and(|name| !name.is_empty() && name.bytes().all(|b| b.is_ascii_digit()))
}

fn states_maker(metadata: &[u8]) -> bool {
    let stated: Result<serde_json::Value, _> = serde_json::from_slice(metadata);
    stated.is_ok_and(|stated| stated.get("description").and_then(|text| text.as_str()) == Some(MADE_BY))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_name_their_kind() {
        for (path, kind) in [
            ("a.pmtiles", Some(TileFormat::PmTiles)),
            ("b/a.MBTILES", Some(TileFormat::MbTiles)),
            ("tiles/{z}/{x}/{y}.pbf", Some(TileFormat::Folder)),
            ("/a/b/{z}/{x}/{y}.png", Some(TileFormat::Folder)),
            ("{z}/{x}/{y}.pbf", None),
            ("tiles/{z}/{y}/{x}.pbf", None),
            ("tiles/{z}/{x}/{y}", None),
            ("a.gpkg", None),
            ("", None),
        ] {
            assert_eq!(TileFormat::of(Path::new(path)), kind, "{path}");
        }
        assert_eq!(TileFormat::target(Path::new("a/t/{z}/{x}/{y}.pbf")), Path::new("a/t"));
    }

    #[test]
    fn files_beside_tiles_are_seen() {
        let dir = tempfile::tempdir().unwrap();
        let put = |name: &str| {
            let path = dir.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(&path, "").unwrap();
            path
        };
        put("metadata.json");
        put("11/3/5.pbf");
        put("11/4/5.pbf");
        assert_eq!(foreign_entry(dir.path()).unwrap(), None);
        for name in ["index.html", ".git", "12", "11/notes.txt", "11/4/dem.tif"] {
            let path = put(name);
            assert_eq!(foreign_entry(dir.path()).unwrap(), Some(path.clone()));
            std::fs::remove_file(path).unwrap();
        }
        assert_eq!(foreign_entry(dir.path()).unwrap(), None);
    }

    #[test]
    fn other_files_are_not_own() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.pmtiles");
        for bytes in [&b""[..], b"PMTiles\x03", &[0xff; 300]] {
            std::fs::write(&path, bytes).unwrap();
            assert!(!is_own_pmtiles(File::open(&path).unwrap()));
            assert!(!is_own_mbtiles(&path));
        }
        let mut far = b"PMTiles\x03".to_vec();
        far.resize(127, 0xff);
        std::fs::write(&path, far).unwrap();
        assert!(!is_own_pmtiles(File::open(&path).unwrap()));
        assert!(!is_own_folder(dir.path()));
        assert!(!is_own_folder(&dir.path().join("missing")));
        std::fs::write(dir.path().join(METADATA_FILE), "{\"description\":\"mine\"}").unwrap();
        assert!(!is_own_folder(dir.path()));
    }
}
