//! The files that a run writes.

use std::path::{Path, PathBuf};

use clap::ValueEnum;
use tokosen::base::ElevationUnit;
use tokosen::base::error::Report;
use tokosen::crs::Crs;
use tokosen::io::StagedOutput;
use tokosen::io::raster::{
    EngineFiles, Quantity, RasterParams, TWO_BAND_EXTENSIONS, reading, write_for_engine, write_raster, write_rows,
    write_shade, write_stac_item, write_with_errors,
};
use tokosen::io::tiles::{TerrainTiles, TileFormat, WrittenTerrain, write_terrain_tiles};
use tokosen::raster::{Dem, RasterRows};
use tokosen::terrain::HeightMap;
use tokosen::{GridSpec, Terrain};

use super::console::Console;
use super::engine::{self, ForEngine};
use super::extensions::{check_extension, extension, is_tiff, open_raster};
use super::failure::Failure;
use super::height_map::{HeightMapArgs, PngArg};
use super::terrain_tiles;
use super::unit::of_drawing;
use super::vertical_shift::Shift;

/// A height map to write, with its file, which was opened before the work.
pub struct DemOutput {
    staged: StagedOutput,
    pub grid: GridSpec,
    format: DemFormat,
}

/// How a height map is stored.
enum DemFormat {
    Raster(RasterParams, Option<String>),
    /// Tiles, with the path that was given.
    Tiles(TerrainTiles, PathBuf),
    /// For a game engine or the like.
    Engine(ForEngine),
}

/// A height map that is written, still under its temporary name.
pub struct WrittenDem {
    pub map: HeightMap,
    /// What is in the tiles, if they are some.
    tiles: Option<WrittenTerrain>,
    /// What an engine gets.
    engine: Option<EngineFiles>,
}

impl DemOutput {
    /// Opens the file, whose heights will be in `unit`, and reads the raster whose cells are asked for. `crs` is the
    /// system that the cells are to be in, if it is named. `attribution` is the source that tiles state.
    pub fn open(
        path: &Path,
        wanted: &HeightMapArgs,
        crs: Option<&Crs>,
        unit: ElevationUnit,
        attribution: Option<&str>,
    ) -> Result<Self, Failure> {
        wanted.check(path, crs, unit)?;
        if let Some(mut tiles) = wanted.tiles(path, crs, unit)? {
            tiles.attribution = attribution.map(str::to_owned);
            let staged = TileFormat::open(path)?;
            return Ok(Self {
                staged,
                grid: terrain_tiles::grid(&tiles),
                format: DemFormat::Tiles(tiles, path.to_owned()),
            });
        }
        let encoding = wanted.png_encoding.unwrap_or(PngArg::Gray16);
        let is_colour = encoding != PngArg::Gray16;
        if is_colour && extension(path) != "png" {
            let message = format!("{}: --png-encoding applies to height maps in .png", path.display());
            return Err(Failure::Usage(message));
        }
        if let Some(value) = encoding.to_possible_value().filter(|_| is_colour && unit.is_foot()) {
            let message = format!("--png-encoding {} holds metres only, so --to-unit cannot be feet", value.get_name());
            return Err(Failure::Usage(message));
        }
        wanted.cog.check([path])?;
        if wanted.uncertainty {
            check_extension(path, "heights with --uncertainty", &TWO_BAND_EXTENSIONS)?;
        }
        let staged = open_raster(path)?;
        Ok(Self {
            staged,
            grid: wanted.grid.spec(crs)?,
            format: DemFormat::Raster(wanted.raster(unit), wanted.stac.clone()),
        })
    }

    /// Opens the file of a height map for a game engine or the like.
    pub fn for_engine(path: &Path, wanted: &ForEngine) -> Result<Self, Failure> {
        Ok(Self { staged: StagedOutput::create(path)?, grid: wanted.grid(), format: DemFormat::Engine(wanted.clone()) })
    }

    /// Rasterises the surface and writes the file, still under its temporary name. The findings are about the base.
    /// `shift` brings the heights to another height system.
    pub fn write(
        &self,
        terrain: &Terrain,
        shift: Option<&Shift>,
        console: &Console,
    ) -> Result<Report<WrittenDem>, Failure> {
        let Report { value: mut map, mut findings } = terrain.height_map(&self.grid, console)?;
        if let Some(shift) = shift {
            findings.extend(shift.apply(&mut map.dem)?);
        }
        let HeightMap { dem, errors, .. } = &map;
        let (mut tiles, mut engine) = (None, None);
        let written = match &self.format {
            DemFormat::Tiles(params, path) => {
                write_terrain_tiles(&self.staged, path, dem, params, console).map(|written| {
                    findings.extend(written.beyond_map(params));
                    tiles = Some(written);
                })
            }
            DemFormat::Engine(wanted) => console.step("writing", || {
                let side = wanted.side(dem.grid.cols);
                engine = Some(write_for_engine(&self.staged.path(), dem, wanted.engine, side)?);
                Ok(())
            }),
            DemFormat::Raster(params, date) => console.step("writing", || {
                let path = self.staged.path();
                match errors {
                    Some(errors) => write_with_errors(&path, dem, errors, params)?,
                    None => write_raster(&path, dem, params)?,
                }
                let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
                match date.as_deref().filter(|_| is_tiff(&path)) {
                    Some(date) => write_stac_item(&path.with_extension("json"), dem, name, (date, params.unit)),
                    None => Ok(()),
                }
            }),
        };
        written.map_err(|e| self.staged.with_final_name(e))?;
        Ok(Report { value: WrittenDem { map, tiles, engine }, findings })
    }

    /// Puts the file in its place, and prints what is in it.
    pub fn commit(self, written: &WrittenDem, console: &Console) -> Result<(), Failure> {
        let path = self.staged.commit()?;
        let dem = &written.map.dem;
        match (&self.format, &written.tiles) {
            (DemFormat::Tiles(params, path), Some(tiles)) => terrain_tiles::describe(path, params, tiles, console),
            (DemFormat::Raster(params, _), _) => {
                describe(&path, dem, params.unit, console);
                reading(&path, dem, params).iter().for_each(|line| console.say(&format!("           {line}")));
            }
            (DemFormat::Engine(wanted), _) => {
                let Some(files) = &written.engine else { return Ok(()) };
                let first = files.names.first().map_or(path.clone(), |name| path.with_file_name(name));
                describe(&first, dem, ElevationUnit::Metre, console);
                engine::describe(&path, wanted.engine, files, console);
            }
            (DemFormat::Tiles(..), None) => {}
        }
        Ok(())
    }
}

/// One line of the summary about a height map.
fn describe(path: &Path, dem: &Dem, unit: ElevationUnit, console: &Console) {
    let valid = dem.values.iter().filter(|v| !v.is_nan());
    let (low, high) = valid.clone().fold((f32::INFINITY, f32::NEG_INFINITY), |m, &v| (m.0.min(v), m.1.max(v)));
    let count = valid.count();
    let [low, high] = [low, high].map(|height| unit.about(f64::from(height)));
    let range = match count {
        0 => "no data".into(),
        _ => format!("heights {low:.2} to {high:.2} {}", unit.symbol()),
    };
    console.say(&format!(
        "written    {} ({} x {} cells, {:.1} % with data, {range}{})",
        path.display(),
        dem.grid.cols,
        dem.grid.rows,
        100.0 * count as f64 / dem.grid.len().max(1) as f64,
        of_drawing(dem.crs.as_ref(), unit)
    ));
}

/// Writes a raster, still under its temporary name, if it is asked for.
pub fn write_if_asked(
    staged: Option<&StagedOutput>,
    params: &RasterParams,
    rows: &dyn RasterRows,
    console: &Console,
) -> Result<(), Failure> {
    let Some(staged) = staged else { return Ok(()) };
    let path = staged.path();
    let written = console.step(params.quantity.name(), || match params.quantity {
        Quantity::Shade if extension(&path) == "png" => write_shade(&path, rows),
        _ => write_rows(&path, rows, params),
    });
    Ok(written.map_err(|e| staged.with_final_name(e))?)
}
