//! What tiles are put into: an archive, a database, or a folder.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use flate2::Compression;
use pmtiles::{PmTilesStreamWriter, PmTilesWriter, TileCoord};
use rusqlite::{Connection, params};
use serde_json::{Map, Value, json};

use super::format::{METADATA_FILE, TileFormat};
use crate::maker::{MADE_BY, PROGRAM};
use crate::staged::StagedOutput;
use tokosen_core::base::error::{Error, Result};
use tokosen_core::tiles::TilePlace;

/// What a set of tiles says about itself.
#[derive(Debug, Clone)]
pub(super) struct About {
    pub name: String,
    pub kind: Kind,
    pub min_zoom: u8,
    pub max_zoom: u8,
    /// West, south, east and north, degrees.
    pub bounds: [f64; 4],
    /// Further entries of the metadata.
    pub more: Map<String, Value>,
}

/// What a tile holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Vector tiles, compressed with gzip in archives.
    Vector,
    /// Pictures.
    Png,
    /// Pictures.
    Webp,
}

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Self::Vector => "pbf",
            Self::Png => "png",
            Self::Webp => "webp",
        }
    }
}

impl About {
    fn centre(&self) -> [f64; 2] {
        let [west, south, east, north] = self.bounds;
        [0.5 * (west + east), 0.5 * (south + north)]
    }

    /// The zoom at which a viewer opens the tiles.
    fn first_zoom(&self) -> u8 {
        self.min_zoom.midpoint(self.max_zoom)
    }

    /// The metadata as other programs write them: texts, except in `more`.
    fn metadata(&self) -> Map<String, Value> {
        let round = |angle: f64| (angle * 1e7).round() / 1e7;
        let list = |angles: &[f64]| angles.iter().map(|a| round(*a).to_string()).collect::<Vec<_>>().join(",");
        let mut all = Map::new();
        let mut add = |key: &str, value: String| all.insert(key.into(), value.into());
        add("name", self.name.clone());
        add("description", MADE_BY.into());
        add("generator", PROGRAM.into());
        add("format", self.kind.name().into());
        add("type", "overlay".into());
        add("version", "1".into());
        add("minzoom", self.min_zoom.to_string());
        add("maxzoom", self.max_zoom.to_string());
        add("bounds", list(&self.bounds));
        add("center", format!("{},{}", list(&self.centre()), self.first_zoom()));
        all.extend(self.more.clone());
        all
    }
}

/// A set of tiles that is being written. Tiles come in the order of their numbers in PMTiles.
pub(super) enum Archive {
    PmTiles(Box<PmTilesStreamWriter<File>>, PathBuf),
    MbTiles(Connection, PathBuf),
    Folder { root: PathBuf, extension: String },
}

impl Archive {
    /// What `path` names, under its temporary name.
    pub fn create(out: &StagedOutput, path: &Path, about: &About) -> Result<Self> {
        match (TileFormat::of(path), TileFormat::folder(path)) {
            (_, Some((_, extension))) => Self::folder(&out.path(), extension, about),
            (Some(TileFormat::MbTiles), _) => Self::mbtiles(&out.path(), about),
            _ => Self::pmtiles(&out.path(), about),
        }
    }

    /// A PMTiles archive at `path`.
    fn pmtiles(path: &Path, about: &About) -> Result<Self> {
        let file = File::create(path).map_err(|e| Error::io("create", path, e))?;
        let [west, south, east, north] = about.bounds;
        let [longitude, latitude] = about.centre();
        let (kind, compression) = match about.kind {
            Kind::Vector => (pmtiles::TileType::Mvt, pmtiles::Compression::Gzip),
            Kind::Png => (pmtiles::TileType::Png, pmtiles::Compression::None),
            Kind::Webp => (pmtiles::TileType::Webp, pmtiles::Compression::None),
        };
        let made = PmTilesWriter::new(kind)
            .precompressed(compression)
            .min_zoom(about.min_zoom)
            .max_zoom(about.max_zoom)
            .bounds(west, south, east, north)
            .center(longitude, latitude)
            .center_zoom(about.first_zoom())
            .metadata(Value::Object(about.metadata()).to_string())
            .create(file);
        Ok(Self::PmTiles(Box::new(made.map_err(|e| archive_error(path, e))?), path.to_owned()))
    }

    /// An MBTiles database at `path`.
    fn mbtiles(path: &Path, about: &About) -> Result<Self> {
        let made = || -> rusqlite::Result<Connection> {
            let db = Connection::open(path)?;
            // The file gets its name when it is complete. It needs no journal before.
            db.execute_batch(
                "PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF; BEGIN;
                 CREATE TABLE metadata (name TEXT, value TEXT);
                 CREATE TABLE tiles (zoom_level INTEGER, tile_column INTEGER, tile_row INTEGER, tile_data BLOB);
                 CREATE UNIQUE INDEX tile_index ON tiles (zoom_level, tile_column, tile_row);",
            )?;
            // What is not a text goes into one entry, as the specification has it.
            let (texts, others): (Vec<_>, Vec<_>) =
                about.metadata().into_iter().partition(|(_, value)| value.is_string());
            let json = Value::Object(others.into_iter().collect()).to_string();
            let texts = texts.iter().map(|(name, value)| (name.as_str(), value.as_str().unwrap_or_default()));
            for (name, value) in texts.chain([("json", json.as_str())]) {
                db.execute("INSERT INTO metadata VALUES (?1, ?2)", params![name, value])?;
            }
            Ok(db)
        };
        Ok(Self::MbTiles(made().map_err(|e| Error::file_cause(path, "cannot be written", e))?, path.to_owned()))
    }

    /// A folder at `root`, with files of this extension.
    fn folder(root: &Path, extension: &str, about: &About) -> Result<Self> {
        fs::create_dir(root).map_err(|e| Error::io("create", root, e))?;
        let path = root.join(METADATA_FILE);
        let text = format!("{:#}\n", Value::Object(about.metadata()));
        fs::write(&path, text).map_err(|e| Error::io("write", &path, e))?;
        Ok(Self::Folder { root: root.to_owned(), extension: extension.to_owned() })
    }

    /// Adds a tile. Its bytes are compressed as [`compressed`] does it, except for a folder.
    pub fn add(&mut self, tile: TilePlace, bytes: &[u8]) -> Result<()> {
        let TilePlace { zoom, x, y } = tile;
        match self {
            Self::PmTiles(out, path) => {
                let place = TileCoord::new(zoom, x, y);
                place.and_then(|place| out.add_tile(place, bytes)).map_err(|e| archive_error(path, e))
            }
            Self::MbTiles(db, path) => {
                // Rows count from the south.
                let row = (1_u32 << zoom) - 1 - y;
                let added = db
                    .prepare_cached("INSERT INTO tiles VALUES (?1, ?2, ?3, ?4)")
                    .and_then(|mut insert| insert.execute(params![zoom, x, row, bytes]));
                added.map(|_| ()).map_err(|e| Error::file_cause(path, "cannot be written", e))
            }
            Self::Folder { root, extension } => {
                let column = root.join(zoom.to_string()).join(x.to_string());
                let path = column.join(format!("{y}.{extension}"));
                fs::create_dir_all(&column)
                    .and_then(|()| fs::write(&path, bytes))
                    .map_err(|e| Error::io("write", &path, e))
            }
        }
    }

    /// Writes what is left, such as the directory of an archive.
    pub fn finish(self) -> Result<()> {
        match self {
            Self::PmTiles(out, path) => out.finalize().map_err(|e| archive_error(&path, e)),
            Self::MbTiles(db, path) => {
                let ended = db.execute_batch("COMMIT");
                ended
                    .and_then(|()| db.close().map_err(|(_, e)| e))
                    .map_err(|e| Error::file_cause(&path, "cannot be written", e))
            }
            Self::Folder { .. } => Ok(()),
        }
    }
}

fn archive_error(path: &Path, error: pmtiles::PmtError) -> Error {
    match error {
        pmtiles::PmtError::Reading(e) => Error::io("write", path, e),
        other => Error::file_cause(path, "cannot be written", other),
    }
}

/// Compresses a tile with gzip. The file says nothing about the time, so the same tile has the same bytes.
pub(super) fn compressed(bytes: &[u8]) -> std::io::Result<Vec<u8>> {
    use std::io::Write;
    let mut out = flate2::write::GzEncoder::new(Vec::with_capacity(bytes.len() / 2), Compression::new(9));
    out.write_all(bytes)?;
    out.finish()
}

/// The number of a tile in PMTiles: archives have their tiles in the order of these.
pub(super) fn tile_number(tile: TilePlace) -> u64 {
    // The crate refuses what is no tile of its zoom. There is none.
    TileCoord::new(tile.zoom, tile.x, tile.y).map_or(0, |place| pmtiles::TileId::from(place).value())
}

/// The name of a set of tiles: that of its file or folder.
pub(super) fn name_of(path: &Path) -> String {
    let target = TileFormat::target(path);
    target.file_stem().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

/// The entry of the metadata about the layers of vector tiles.
pub(super) fn vector_layer(name: &str, about: &str, fields: &[(&str, &str)], zooms: [u8; 2]) -> Value {
    let fields: Map<String, Value> = fields.iter().map(|(key, kind)| ((*key).into(), (*kind).into())).collect();
    json!([{ "id": name, "description": about, "fields": fields, "minzoom": zooms[0], "maxzoom": zooms[1] }])
}
