//! Height maps for game engines and 3-D programs: square, 16 bits or floating point, with a JSON file beside them that says what to
//! type in.
//!
//! | program | samples on a side | files | first row | names of tiles |
//! |---|---|---|---|---|
//! | Unreal | 127, 253, 505, 1009, 2017, 4033, 8129 | `.png`, `.r16`, `.raw` | north | `NAME_x0_y0`, y to the south |
//! | Unity | 33, 65, 129 ... 4097 | `.raw` | south | `NAME_0_0`, the second number to the north |
//! | Godot | 513, 1025, 2049, 4097 | `.exr`, `.r16`, `.raw` | north | `NAME_x0_y0`, y to the south |
//! | Blender | any | `.exr`, `.png` | north | no tiles |
//!
//! Sources: Unreal Engine documentation, "Landscape Technical Guide" (recommended sizes; the steps of heights); Unity manual, "Working with
//! Heightmaps", and Terrain Tools manual, "Import Heightmap" (names of tiles; the file's first row is at z = 0, and values are divided by
//! 65536); documentation of the Godot add-ons HTerrain (sizes, RAW) and Terrain3D (EXR with real heights, `.r16` with the range typed
//! in). All read 16-bit files with the low byte first.
//!
//! 16-bit files use the whole range: 0 is the lowest height, 65535 the highest.

use std::io::Write;
use std::path::Path;

use png::{BitDepth, ColorType, Encoder};
use serde_json::{Value, json};
use tokosen_core::base::error::{Error, Result};
use tokosen_core::base::{Grid, parallel};
use tokosen_core::raster::Dem;

use super::output::{Filled, check, create};
use super::png::filled;
use super::{RasterParams, write_raster};
use crate::maker::MADE_BY;

/// The largest 16-bit value.
const MOST: f64 = 65535.0;
/// Unreal: height of a step in units of its own (centimetres) at a Z scale of 1.
const UNREAL_STEP: f64 = 1.0 / 128.0;
/// Unreal: the value of height 0.
const UNREAL_ZERO: f64 = 32768.0;

/// A program that takes height maps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Engine {
    /// Unreal Engine, landscapes.
    Unreal,
    /// Unity, terrains.
    Unity,
    /// Godot, with the add-on HTerrain or Terrain3D.
    Godot,
    /// Blender, as a displacement.
    Blender,
}

/// What was written.
#[derive(Debug, Clone, PartialEq)]
pub struct EngineFiles {
    /// The names of the height maps.
    pub names: Vec<String>,
    /// Number of tiles from west to east and from north to south.
    pub tiles: [usize; 2],
    /// Samples on a side of a tile; for Blender the columns.
    pub side: usize,
    /// The share of the samples that have no height. They got the lowest one.
    pub filled: f64,
    /// What to type in, as name and number.
    pub settings: Vec<(&'static str, f64)>,
}

impl Engine {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Unreal => "unreal",
            Self::Unity => "unity",
            Self::Godot => "godot",
            Self::Blender => "blender",
        }
    }

    /// The samples that a side may have; empty if it may have any number.
    pub fn sides(self) -> &'static [usize] {
        match self {
            Self::Unreal => &[127, 253, 505, 1009, 2017, 4033, 8129],
            Self::Unity => &[33, 65, 129, 257, 513, 1025, 2049, 4097],
            Self::Godot => &[513, 1025, 2049, 4097],
            Self::Blender => &[],
        }
    }

    /// The extensions of the files that it reads.
    pub fn extensions(self) -> &'static [&'static str] {
        match self {
            Self::Unreal => &["png", "r16", "raw"],
            Self::Unity => &["raw"],
            Self::Godot => &["exr", "r16", "raw"],
            Self::Blender => &["exr", "png"],
        }
    }

    /// The name of a tile, without extension: columns count to the east, rows to the south.
    fn tile(self, name: &str, [col, row]: [usize; 2], rows: usize) -> String {
        match self {
            Self::Unity => format!("{name}_{col}_{}", rows - 1 - row),
            _ => format!("{name}_x{col}_y{row}"),
        }
    }

    /// What to type in for heights from `low` to `high` and samples so far apart, all in metres.
    fn settings(self, [low, high]: [f64; 2], spacing: f64, side: usize, is_float: bool) -> Vec<(&'static str, f64)> {
        let range = high - low;
        let width = spacing * (side as f64 - 1.0);
        match self {
            Self::Unreal => vec![
                ("Scale X", 100.0 * spacing),
                ("Scale Y", 100.0 * spacing),
                ("Scale Z", 100.0 * range / (MOST * UNREAL_STEP)),
                ("Location Z", 100.0 * (low + range * UNREAL_ZERO / MOST)),
            ],
            // A value is divided by 65536. So the highest one stays a step below the terrain's height.
            Self::Unity => vec![
                ("Terrain Width", width),
                ("Terrain Length", width),
                ("Terrain Height", range * (MOST + 1.0) / MOST),
                ("Position Y", low),
            ],
            Self::Godot if is_float => vec![("vertex spacing", spacing), ("height scale", 1.0), ("height offset", 0.0)],
            Self::Godot => vec![("vertex spacing", spacing), ("range from", low), ("range to", high)],
            Self::Blender if is_float => {
                vec![("plane width", width), ("displacement midlevel", 0.0), ("displacement scale", 1.0)]
            }
            Self::Blender => {
                vec![
                    ("plane width", width),
                    ("displacement midlevel", 0.0),
                    ("displacement scale", range),
                    ("location Z", low),
                ]
            }
        }
    }
}

/// Writes a height map for a program, in metres, as one file or as tiles with common samples at their borders; and `NAME.json` beside
/// them. `side` is the number of samples on a side of a tile, if the program asks for squares.
///
/// # Errors
/// There are no heights. The extension is not one that the program reads. The operating system reports an error.
pub fn write_for_engine(path: &Path, dem: &Dem, engine: Engine, side: Option<usize>) -> Result<EngineFiles> {
    check(path, dem)?;
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    if !engine.extensions().contains(&extension.as_str()) {
        let known: Vec<String> = engine.extensions().iter().map(|e| format!(".{e}")).collect();
        return Err(Error::file(
            path,
            format!("height maps for {} are written as {}", engine.name(), known.join(", ")),
        ));
    }
    let valid = dem.values.iter().filter(|z| z.is_finite());
    let [low, high] = valid.clone().fold([f32::INFINITY, f32::NEG_INFINITY], |[lo, hi], z| [lo.min(*z), hi.max(*z)]);
    if low > high {
        return Err(Error::file(path, "there are no heights to write"));
    }
    let filled = 1.0 - valid.count() as f64 / dem.values.len() as f64;
    let Grid { cols, rows, cell, .. } = dem.grid;
    let [width, height] = side.map_or([cols, rows], |side| [side, side]);
    // Neighbours share the samples at their border.
    let tiles = [(cols - 1).div_ceil((width - 1).max(1)).max(1), (rows - 1).div_ceil((height - 1).max(1)).max(1)];
    let name = path.file_stem().and_then(|name| name.to_str()).unwrap_or("terrain").to_owned();
    let mut names = Vec::new();
    for row in 0..tiles[1] {
        for col in 0..tiles[0] {
            let first = [col * (width - 1), row * (height - 1)];
            let part = part(dem, first, [width, height], low);
            let stem = if tiles == [1, 1] { name.clone() } else { engine.tile(&name, [col, row], tiles[1]) };
            let file = path.with_file_name(format!("{stem}.{extension}"));
            match extension.as_str() {
                "exr" => write_raster(&file, &part, &RasterParams::default())?,
                "png" => write_png(&file, &part, [low, high])?,
                _ => write_raw(&file, &part, [low, high], engine == Engine::Unity)?,
            }
            names.push(format!("{stem}.{extension}"));
        }
    }
    let is_float = extension == "exr";
    let range = [f64::from(low), f64::from(high)];
    let settings = engine.settings(range, cell.x, width, is_float);
    let first_row = if engine == Engine::Unity { "south" } else { "north" };
    let typed: serde_json::Map<String, Value> = settings.iter().map(|&(name, v)| (name.to_owned(), json!(v))).collect();
    let about = json!({
        "description": MADE_BY,
        "engine": engine.name(),
        "files": names,
        "tiles": tiles,
        "samples": [width, height],
        "spacing_m": cell.x,
        "lowest_m": range[0],
        "highest_m": range[1],
        "values": if is_float { "heights in metres" } else { "0 is the lowest height, 65535 the highest; low byte first in .raw and .r16" },
        "first_row": first_row,
        "settings": typed,
        "north_west_sample": [dem.grid.center(0, 0).x, dem.grid.center(0, 0).y],
        "crs": dem.crs.as_ref().and_then(tokosen_core::crs::Crs::name),
    });
    let beside = path.with_file_name(format!("{name}.json"));
    create(&beside, |out| Ok(writeln!(out, "{about:#}")?))?;
    Ok(EngineFiles { names, tiles, side: width, filled, settings })
}

/// A part of a height map from a first column and row on. Samples without a height get `low`.
fn part(dem: &Dem, [col, row]: [usize; 2], [width, height]: [usize; 2], low: f32) -> Dem {
    let Grid { cols, rows, cell, corner } = dem.grid;
    let values = parallel::map_each(&(0..width * height).collect::<Vec<_>>(), |k| {
        let (c, r) = (col + k % width, row + k / width);
        let height = if c < cols && r < rows { dem.values[r * cols + c] } else { f32::NAN };
        if height.is_finite() { height } else { low }
    });
    let corner = glam::DVec2::new(corner.x + col as f64 * cell.x, corner.y - row as f64 * cell.y);
    Dem { grid: Grid { corner, cell, cols: width, rows: height }, values, crs: dem.crs.clone() }
}

/// A height as a 16-bit value.
fn value(height: f32, [low, high]: [f32; 2]) -> u16 {
    let share = f64::from(height - low) / f64::from(high - low).max(f64::MIN_POSITIVE);
    (share * MOST).round() as u16
}

fn write_png(path: &Path, dem: &Dem, range: [f32; 2]) -> Result<()> {
    create(path, |out| {
        let mut encoder = Encoder::new(out, dem.grid.cols as u32, dem.grid.rows as u32);
        encoder.set_color(ColorType::Grayscale);
        encoder.set_depth(BitDepth::Sixteen);
        encoder.set_compression(png::Compression::Balanced);
        let bytes: Vec<u8> = dem.values.iter().flat_map(|&z| value(z, range).to_be_bytes()).collect();
        let mut writer = encoder.write_header().map_err(filled)?;
        writer.write_image_data(&bytes).and_then(|()| writer.finish()).map_err(filled)
    })
}

fn write_raw(path: &Path, dem: &Dem, range: [f32; 2], is_south_first: bool) -> Result<()> {
    create(path, |out| {
        let mut rows: Vec<&[f32]> = dem.values.chunks_exact(dem.grid.cols).collect();
        if is_south_first {
            rows.reverse();
        }
        for row in rows {
            let bytes: Vec<u8> = row.iter().flat_map(|&z| value(z, range).to_le_bytes()).collect();
            out.write_all(&bytes).map_err(Filled::Io)?;
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;

    /// Heights that grow to the east and the north, from 100 m, with one sample missing.
    fn ramp(cols: usize, rows: usize) -> Dem {
        let grid = Grid { corner: DVec2::ZERO, cell: DVec2::splat(2.0), cols, rows };
        let mut values: Vec<f32> = (0..cols * rows).map(|k| 100.0 + (k % cols + rows - 1 - k / cols) as f32).collect();
        values[cols + 1] = f32::NAN;
        Dem { grid, values, crs: None }
    }

    fn read(path: &Path) -> Vec<u16> {
        std::fs::read(path).unwrap().chunks(2).map(|b| u16::from_le_bytes([b[0], b[1]])).collect()
    }

    #[test]
    fn unity_gets_tiles_from_the_south_with_common_borders() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("hill.raw");
        let written = write_for_engine(&path, &ramp(65, 33), Engine::Unity, Some(33)).unwrap();
        assert_eq!((written.tiles, written.side), ([2, 1], 33));
        let [west, east] = ["hill_0_0.raw", "hill_1_0.raw"].map(|name| read(&folder.path().join(name)));
        assert_eq!((west.len(), west[0], east[33 * 33 - 1]), (33 * 33, 0, 65535));
        for row in 0..33 {
            assert_eq!(west[row * 33 + 32], east[row * 33], "row {row}");
        }
        // The file begins in the south: heights rise from row to row.
        assert!(west[33] > west[0]);
        let text = std::fs::read_to_string(folder.path().join("hill.json")).unwrap();
        let about: Value = serde_json::from_str(&text).unwrap();
        let settings = &about["settings"];
        let metres = |value: u16| {
            settings["Position Y"].as_f64().unwrap()
                + f64::from(value) / 65536.0 * settings["Terrain Height"].as_f64().unwrap()
        };
        assert!((metres(west[32]) - 132.0).abs() < 1e-3 && (metres(east[33 * 33 - 1]) - 196.0).abs() < 1e-3);
        assert_eq!(settings["Terrain Width"], 64.0);
        assert!(written.filled > 0.0 && written.filled < 0.001);
    }

    #[test]
    fn unreal_gets_heights_back_by_its_own_rule() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("hill.r16");
        let dem = ramp(127, 127);
        write_for_engine(&path, &dem, Engine::Unreal, Some(127)).unwrap();
        let about: Value = serde_json::from_slice(&std::fs::read(folder.path().join("hill.json")).unwrap()).unwrap();
        let number = |name: &str| about["settings"][name].as_f64().unwrap();
        for (value, z) in read(&path).iter().zip(&dem.values).filter(|(_, z)| z.is_finite()) {
            let centimetres = number("Location Z") + (f64::from(*value) - 32768.0) / 128.0 * number("Scale Z");
            assert!((centimetres / 100.0 - f64::from(*z)).abs() < 0.003, "{centimetres} {z}");
        }
    }

    #[test]
    fn what_a_program_does_not_read_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("hill.png");
        let error = write_for_engine(&path, &ramp(33, 33), Engine::Unity, Some(33)).unwrap_err();
        assert!(error.to_string().contains(".raw"), "{error}");
        let empty = Dem { values: vec![f32::NAN; 9], grid: Grid { cols: 3, rows: 3, ..ramp(2, 2).grid }, crs: None };
        assert!(write_for_engine(&path, &empty, Engine::Blender, None).is_err());
    }
}
