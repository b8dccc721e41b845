//! Map tiles: the same tiles in each kind of set, what replaces what, and wrong usage.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

use flate2::read::GzDecoder;
use rusqlite::Connection;

use crate::common::Folder;
use crate::running::{Running, folder_with, folder_with_part};

/// Status of wrong usage.
const USAGE: i32 = 2;
/// Status of work that failed.
const FAILED: i32 = 1;

/// All tiles of a database: zoom, column, row from the north, bytes.
fn tiles(path: &Path) -> Vec<(u32, u32, u32, Vec<u8>)> {
    let db = Connection::open(path).unwrap();
    let mut rows = db.prepare("SELECT zoom_level, tile_column, tile_row, tile_data FROM tiles").unwrap();
    let found = rows.query_map([], |row| {
        let (zoom, row_from_south): (u32, u32) = (row.get(0)?, row.get(2)?);
        Ok((zoom, row.get(1)?, (1 << zoom) - 1 - row_from_south, row.get(3)?))
    });
    found.unwrap().map(Result::unwrap).collect()
}

fn unzipped(bytes: &[u8]) -> Vec<u8> {
    let mut plain = Vec::new();
    GzDecoder::new(bytes).read_to_end(&mut plain).unwrap();
    plain
}

fn number(bytes: &[u8], at: usize) -> u64 {
    u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap())
}

/// The files in a folder and below it.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries.flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] }).collect()
}

#[test]
fn a_database_a_folder_and_an_archive_have_the_same_tiles() {
    let folder = folder_with_part("in.gpkg");
    let said = folder.succeeds("densify in.gpkg -i 10 -o a.mbtiles");
    assert!(said.contains("a.mbtiles (zooms ") && said.contains("zoom 14: every 10 m"), "{said}");
    folder.succeeds("densify in.gpkg -i 10 -o a/{z}/{x}/{y}.pbf");
    folder.succeeds("densify in.gpkg -i 10 -o a.pmtiles --threads 1");
    let database = tiles(&folder.path("a.mbtiles"));
    assert!(database.len() > 10);
    assert_eq!(files(&folder.path("a")).len(), database.len() + 1, "the tiles, and metadata.json");
    let archive = fs::read(folder.path("a.pmtiles")).unwrap();
    assert!(archive.starts_with(b"PMTiles\x03"));
    // Tiles that are addressed, entries, contents, and whether they are clustered.
    assert_eq!([72, 80, 88].map(|at| number(&archive, at)), [database.len() as u64; 3]);
    assert_eq!(archive[96], 1);
    let data = &archive[number(&archive, 56) as usize..][..number(&archive, 64) as usize];
    assert_eq!(data.len(), database.iter().map(|(.., bytes)| bytes.len()).sum::<usize>());
    let lowest = database.iter().map(|(zoom, ..)| *zoom).min();
    let is_first = |(zoom, _, _, bytes): &(u32, u32, u32, Vec<u8>)| Some(*zoom) == lowest && data.starts_with(bytes);
    assert!(database.iter().any(is_first), "the lowest zoom comes first");
    for (zoom, x, y, bytes) in &database {
        let single = fs::read(folder.path(&format!("a/{zoom}/{x}/{y}.pbf"))).unwrap();
        assert!(unzipped(bytes) == single, "{zoom}/{x}/{y}");
    }
    let about: serde_json::Value = serde_json::from_slice(&fs::read(folder.path("a/metadata.json")).unwrap()).unwrap();
    assert_eq!(about["vector_layers"][0]["id"], "contours");
    assert_eq!(about["intervals"]["14"], 10.0);
    // The same again, and with two threads, byte for byte. Own sets are replaced.
    folder.succeeds("densify in.gpkg -i 10 -o a.pmtiles --threads 2");
    assert!(fs::read(folder.path("a.pmtiles")).unwrap() == archive);
    folder.succeeds("densify in.gpkg -i 10 --zooms 14:10 -o a/{z}/{x}/{y}.pbf");
    let left = fs::read_dir(folder.path("a")).unwrap().count();
    assert_eq!(left, 2, "one zoom, and metadata.json: the former folder is gone");
}

#[test]
fn zooms_and_units_are_those_that_are_asked_for() {
    let folder = folder_with("caryville_20m_truth.tif", "dem.tif");
    let said = folder.succeeds("contour dem.tif --zooms 9:100,11:50 --to-unit ft -o a.mbtiles");
    assert!(said.contains("zoom 9: every 100 ft") && said.contains("zoom 10: every 100 ft"), "{said}");
    assert!(said.contains("zoom 11: every 50 ft") && !said.contains("zoom 12"), "{said}");
    let said = folder.succeeds("contour dem.tif --levels 400,410.5 -o b.mbtiles");
    assert!(said.contains("all levels"), "{said}");
    let all = tiles(&folder.path("b.mbtiles"));
    let text =
        |text: &str| all.iter().all(|(.., bytes)| unzipped(bytes).windows(text.len()).any(|w| w == text.as_bytes()));
    assert!(text("contours") && text("410.5") && text("label"));
}

#[test]
fn terrain_tiles_hold_the_heights() {
    let folder = folder_with_part("in.gpkg");
    let said = folder.succeeds("dem in.gpkg --max-zoom 12 --tile-size 256 --png-encoding mapbox -o t/{z}/{x}/{y}.png");
    assert!(said.contains("tiles of 256 pixels") && said.contains("mapbox"), "{said}");
    folder.succeeds("dem in.gpkg --to-crs EPSG:3857 --cell 38.21851414258813 -o same.tif");
    let dem = tokosen::io::raster::read_dem(&folder.path("same.tif")).unwrap().value.dem;
    let (mut compared, mut off) = (0, 0.0_f64);
    for path in files(&folder.path("t/12")) {
        let picture = image::open(&path).unwrap().into_rgb8();
        let number = |path: &Path| path.file_stem().unwrap().to_str().unwrap().parse::<f64>().unwrap();
        let (x, y) = (number(path.parent().unwrap()), number(&path));
        for (col, row, pixel) in picture.enumerate_pixels() {
            let [red, green, blue] = pixel.0.map(f64::from);
            let height = 0.1 * (65536.0 * red + 256.0 * green + blue) - 10_000.0;
            assert!((200.0..1100.0).contains(&height), "{height}: no hole");
            let half = 20_037_508.342_789_244;
            let east = (x * 256.0 + f64::from(col) + 0.5) * dem.grid.cell.x - half;
            let north = half - (y * 256.0 + f64::from(row) + 0.5) * dem.grid.cell.y;
            let place = dem.grid.place(glam::DVec2::new(east, north)).round();
            if place.min_element() < 0.0 || place.x >= dem.grid.cols as f64 || place.y >= dem.grid.rows as f64 {
                continue;
            }
            let own = dem.values[place.y as usize * dem.grid.cols + place.x as usize];
            if !own.is_nan() {
                (compared, off) = (compared + 1, off.max((f64::from(own) - height).abs()));
            }
        }
    }
    assert!(compared > 5_000 && off <= 0.0501, "{compared} pixels, {off} m");
    let said = folder.succeeds("dem in.gpkg --max-zoom 11 --tile-image webp -o t.pmtiles");
    assert!(said.contains("terrarium") && said.contains("continued"), "{said}");
}

#[test]
fn wrong_usage_is_refused_before_the_work() {
    let folder = folder_with_part("in.gpkg");
    for (line, expected) in [
        ("densify in.gpkg -i 5,10 -o a.pmtiles", "one interval for each zoom"),
        ("densify in.gpkg -i 5 --labels -o a.pmtiles", "the attribute 'label'"),
        ("densify in.gpkg -i 5 --to-crs EPSG:4326 -o a.pmtiles", "Web Mercator"),
        ("densify in.gpkg -i 5 --zooms 12:5 -o a.gpkg", "--zooms applies to map tiles"),
        ("densify in.gpkg -i 5 --zooms 12 -o a.pmtiles", "such as 12:20"),
        ("densify in.gpkg -i 5 -o a/{z}/{x}/{y}.png", ".pbf or .mvt"),
        ("dem in.gpkg --cell 10 -o a.pmtiles", "--max-zoom 13"),
        ("dem in.gpkg --max-zoom 12 -o a.tif", "--max-zoom applies to terrain tiles"),
        ("dem in.gpkg --max-zoom 12 --to-unit ft -o a.pmtiles", "metres only"),
        ("dem in.gpkg --max-zoom 12 -o a/{z}/{x}/{y}.jpg", ".png or .webp"),
        ("dem in.gpkg --cell 10 --tile-image webp -o a.tif", "--tile-image applies to terrain tiles"),
        ("densify in.gpkg -i 5 --zooms 12:7,14:5 -o a.pmtiles", "whole multiple"),
    ] {
        assert!(folder.ends(line, USAGE).contains(expected), "{line}");
    }
    assert_eq!(fs::read_dir(folder.0.path()).unwrap().count(), 1, "nothing was left behind");
}

#[test]
fn what_another_program_made_stays() {
    let folder: Folder = folder_with_part("in.gpkg");
    fs::create_dir(folder.path("mine")).unwrap();
    fs::write(folder.path("mine/notes.txt"), "mine").unwrap();
    fs::write(folder.path("mine.pmtiles"), "PMTiles\x03 mine").unwrap();
    let said = folder.ends("densify in.gpkg -i 10 -o mine.pmtiles", FAILED);
    assert!(said.contains("--overwrite"), "{said}");
    // A folder is replaced as a whole. So one with other files is refused in any case.
    for overwrite in ["", " --overwrite"] {
        let said = folder.ends(&format!("densify in.gpkg -i 10 -o mine/{{z}}/{{x}}/{{y}}.pbf{overwrite}"), FAILED);
        assert!(said.contains("notes.txt: is no tile"), "{said}");
    }
    assert_eq!(fs::read_to_string(folder.path("mine/notes.txt")).unwrap(), "mine");
    folder.succeeds("densify in.gpkg -i 10 -o mine.pmtiles --overwrite");
    let said = folder.ends("densify in.gpkg -i 10 -o mine.pmtiles/{z}/{x}/{y}.pbf", FAILED);
    assert!(said.contains("is not a folder"), "{said}");
    folder.succeeds("densify in.gpkg -i 20 -o own/{z}/{x}/{y}.pbf");
    let said = folder.ends("densify in.gpkg -i 20 -o own/{z}/{x}/{y}.pbf --dem own/dem.tif --cell 50", USAGE);
    assert!(said.contains("lies in the folder of the tiles"), "{said}");
    folder.succeeds("densify in.gpkg -i 20 -o own/{z}/{x}/{y}.pbf");
    fs::copy(folder.path("in.gpkg"), folder.path("own/in.gpkg")).unwrap();
    let said = folder.ends("densify own/in.gpkg -i 20 -o own/{z}/{x}/{y}.pbf", FAILED);
    assert!(said.contains("in.gpkg: is no tile") && folder.path("own/in.gpkg").exists(), "{said}");
}
