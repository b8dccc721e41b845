//! The arguments about height maps, and the files that a run writes.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use tokosen::base::ElevationUnit;
use tokosen::base::error::Report;
use tokosen::crs::Crs;
use tokosen::io::raster::{
    DEM_EXTENSIONS, EngineFiles, PngEncoding, Quantity, RasterParams, TWO_BAND_EXTENSIONS, TiffLayout, reading,
    write_for_engine, write_raster, write_rows, write_shade, write_stac_item, write_with_errors,
};
use tokosen::io::tiles::{TerrainTiles, WrittenTerrain, write_terrain_tiles};
use tokosen::io::{StagedOutput, VectorFormat};
use tokosen::raster::{Dem, RasterRows};
use tokosen::surface::Uncertainty;
use tokosen::terrain::HeightMap;
use tokosen::{GridSpec, Terrain};

use super::console::Console;
use super::engine::{self, ForEngine};
use super::failure::Failure;
use super::terrain_tiles::{self, TerrainTileArgs};
use super::unit::of_drawing;
use super::vertical_shift::Shift;

/// The flags that ask for a grid.
pub const ABOUT_GRID: [&str; 3] = ["--cell", "--cell-degrees", "--like"];

/// The flags about the file of a height map.
pub const ABOUT_HEIGHT_MAP: [&str; 5] = ["--cell", "--cell-degrees", "--like", "--png-encoding", "--cog"];

/// Where the cells of a height map are.
#[derive(Debug, Clone, Args)]
pub struct GridArgs {
    /// Cell size of the height map [units of the working CRS, or of --to-crs; those of a drawing without a CRS that is in
    /// feet]; cells lie on multiples of it
    #[arg(long, value_name = "SIZE")]
    pub cell: Option<f64>,
    /// Make the height map in degrees, with cells of this size [degrees; seconds with an s: 0.4s]
    #[arg(
        long,
        value_name = "SIZE",
        value_parser = degrees,
        conflicts_with = "cell",
        hide_short_help = true
    )]
    pub cell_degrees: Option<f64>,
    /// Use the grid of this height map (.tif, .asc, .exr, .png, .xyz): its extent, its cells, square or not, and its
    /// coordinate reference system
    #[arg(long, value_name = "RASTER", conflicts_with_all = ["cell", "cell_degrees"])]
    pub like: Option<PathBuf>,
}

/// A height map to write: where its cells are, and how heights are stored.
#[derive(Debug, Clone, Args)]
pub struct HeightMapArgs {
    #[command(flatten)]
    pub grid: GridArgs,
    /// How heights are stored in a .png, or in terrain tiles, which cannot be gray16 [default: gray16; in tiles terrarium]
    #[arg(long, value_enum, hide_short_help = true)]
    pub png_encoding: Option<PngArg>,
    #[command(flatten)]
    pub cog: CogArgs,
    /// Also write a STAC item beside a --cog .tif, as .json. STAC asks for the date of the ground: 2016-10-01
    #[arg(long, value_name = "DATE", value_parser = date, requires = "cog", hide_short_help = true)]
    pub stac: Option<String>,
    /// Also estimate standard errors of heights, by cross-validation on hidden contours. A height map gets a second
    /// band (.tif) or channel (.exr) 'standard error' [metres, or the unit of --to-unit], new contours the attributes
    /// err_v, err_h and inferred
    #[arg(long)]
    pub uncertainty: bool,
    #[command(flatten)]
    pub tiles: TerrainTileArgs,
}

/// The layout of GeoTIFFs.
#[derive(Debug, Clone, Args)]
pub struct CogArgs {
    /// Write .tif as Cloud Optimized GeoTIFF, with overviews (means of 2 x 2 cells); larger by about a third
    #[arg(long)]
    pub cog: bool,
}

impl CogArgs {
    /// The library's layout.
    pub fn layout(&self) -> TiffLayout {
        if self.cog { TiffLayout::CloudOptimized } else { TiffLayout::Plain }
    }

    /// Refuses the flag if none of the rasters is a GeoTIFF.
    pub fn check<'a>(&self, rasters: impl IntoIterator<Item = &'a Path>) -> Result<(), Failure> {
        if self.cog && !rasters.into_iter().any(is_tiff) {
            return Err(Failure::Usage("--cog applies to .tif, and no output is one".into()));
        }
        Ok(())
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum PngArg {
    /// 16-bit grey, with scale and offset in a file beside it; GDAL and QGIS read heights from it
    Gray16,
    /// Colours of GSI elevation tiles (地理院 標高タイル), steps of 1 cm; QGIS shows colours, not heights
    Gsi,
    /// Colours of Terrarium tiles, steps of 1/256 m, for web maps; no data is transparent
    Terrarium,
    /// Colours of Mapbox Terrain-RGB tiles, steps of 0.1 m, for web maps; no data is transparent
    Mapbox,
}

/// A date as STAC writes it.
fn date(text: &str) -> Result<String, String> {
    let parts: Vec<&str> = text.split('-').collect();
    let number = |k: usize, digits: usize, most: u32| {
        parts
            .get(k)
            .filter(|part| part.len() == digits)
            .is_some_and(|part| part.parse().is_ok_and(|n: u32| (1..=most).contains(&n)))
    };
    let is_date = parts.len() == 3 && number(0, 4, 9999) && number(1, 2, 12) && number(2, 2, 31);
    if is_date { Ok(text.to_owned()) } else { Err("give year, month and day: 2016-10-01".into()) }
}

/// An angle in degrees or, if an s follows, in seconds.
fn degrees(text: &str) -> Result<f64, String> {
    let (number, parts) = text.strip_suffix('s').map_or((text, 1.0), |number| (number, 3600.0));
    number.parse().map(|angle: f64| angle / parts).map_err(|e| e.to_string())
}

impl GridArgs {
    /// Checks what can be checked before anything is read. `crs` is the system that the cells are to be in, if it is
    /// named.
    pub fn check(&self, crs: Option<&Crs>) -> Result<(), Failure> {
        match self.size(crs)? {
            Some(size) => Ok(size.check()?),
            None if self.like.is_some() => Ok(()),
            None => Err(Failure::Usage("a height map needs --cell SIZE, --cell-degrees SIZE or --like RASTER".into())),
        }
    }

    /// The grid that is asked for; reads that of `--like`. `crs` as for [`GridArgs::check`].
    pub fn spec(&self, crs: Option<&Crs>) -> Result<GridSpec, Failure> {
        self.check(crs)?;
        match (&self.like, self.size(crs)?) {
            (Some(path), _) => Ok(GridSpec::like(path)?),
            (None, size) => Ok(size.unwrap_or(GridSpec::Cell(0.0))),
        }
    }

    /// The cells by their size, if it is given, in its unit.
    fn size(&self, crs: Option<&Crs>) -> Result<Option<GridSpec>, Failure> {
        let name = |crs: &Crs| crs.name().unwrap_or_default();
        Ok(match (self.cell, self.cell_degrees, crs) {
            (Some(_), _, Some(crs)) if crs.is_geographic() => {
                return Err(Failure::Usage(format!(
                    "--to-crs {} is in degrees: give the size of cells with --cell-degrees, such as --cell-degrees 0.4s",
                    name(crs)
                )));
            }
            (None, Some(_), Some(crs)) if !crs.is_geographic() => {
                return Err(Failure::Usage(format!(
                    "--to-crs {} is not in degrees: give the size of cells with --cell, in its units",
                    name(crs)
                )));
            }
            (Some(size), _, Some(crs)) | (None, Some(size), Some(crs)) => {
                Some(GridSpec::CellIn { size, crs: crs.clone() })
            }
            (Some(size), _, None) => Some(GridSpec::Cell(size)),
            (None, Some(size), None) => Some(GridSpec::Degrees(size)),
            (None, None, _) => None,
        })
    }
}

impl HeightMapArgs {
    /// Whether to estimate standard errors.
    pub fn uncertainty(&self) -> Uncertainty {
        if self.uncertainty { Uncertainty::Learnt } else { Uncertainty::Unknown }
    }

    /// How to write the height map, with heights in `unit`.
    fn raster(&self, unit: ElevationUnit) -> RasterParams {
        RasterParams { png: self.png(), tiff: self.cog.layout(), unit, ..RasterParams::default() }
    }

    /// The file that is written beside a height map, if one is.
    pub fn stac_item(&self, path: &Path) -> Option<PathBuf> {
        self.stac.as_ref().filter(|_| is_tiff(path)).map(|_| path.with_extension("json"))
    }

    /// The tiles that a path asks for; none if it is another file. `crs` is the system that the cells are to be in, if it is
    /// named.
    pub fn tiles(&self, path: &Path, crs: Option<&Crs>, unit: ElevationUnit) -> Result<Option<TerrainTiles>, Failure> {
        let tiles = self.tiles.tiles(path, crs, unit, self.png_encoding.map(PngArg::encoding))?;
        if tiles.is_some() && self.uncertainty {
            let message = "terrain tiles hold heights only, so --uncertainty does not apply";
            return Err(Failure::Usage(format!("{}: {message}", path.display())));
        }
        Ok(tiles)
    }

    /// Checks what can be checked before anything is read.
    pub fn check(&self, path: &Path, crs: Option<&Crs>, unit: ElevationUnit) -> Result<(), Failure> {
        match self.tiles(path, crs, unit)? {
            Some(_) => Ok(()),
            None => self.grid.check(crs),
        }
    }

    /// How a PNG stores heights.
    pub fn png(&self) -> PngEncoding {
        self.png_encoding.unwrap_or(PngArg::Gray16).encoding()
    }
}

impl PngArg {
    /// The library's encoding.
    fn encoding(self) -> PngEncoding {
        match self {
            Self::Gray16 => PngEncoding::Gray16,
            Self::Gsi => PngEncoding::Gsi,
            Self::Terrarium => PngEncoding::Terrarium,
            Self::Mapbox => PngEncoding::Mapbox,
        }
    }
}

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

/// Refuses a file whose extension is not that of a vector format; `kinds` names those that are.
pub fn check_vector(path: &Path, kinds: &str) -> Result<(), Failure> {
    VectorFormat::from_path(path).map_err(|_| Failure::Usage(format!("{}: {kinds}", path.display())))?;
    Ok(())
}

/// Refuses a file whose extension is not one of `known`. `what` names its contents.
pub fn check_extension(path: &Path, what: &str, known: &[&str]) -> Result<(), Failure> {
    if known.contains(&extension(path).as_str()) {
        return Ok(());
    }
    let known: Vec<String> = known.iter().map(|e| format!(".{e}")).collect();
    Err(Failure::Usage(format!("{}: {what} are written as {}", path.display(), known.join(", "))))
}

/// Opens the file of a raster.
pub fn open_raster(path: &Path) -> Result<StagedOutput, Failure> {
    check_extension(path, "height maps", &DEM_EXTENSIONS)?;
    Ok(StagedOutput::create(path)?)
}

fn is_tiff(path: &Path) -> bool {
    ["tif", "tiff"].contains(&extension(path).as_str())
}

/// Whether a file is a raster, by its extension.
pub fn is_raster(path: &Path) -> bool {
    DEM_EXTENSIONS.contains(&extension(path).as_str())
}

/// The extension of a file in small letters.
pub fn extension(path: &Path) -> String {
    path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase()
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
            let staged = super::tiles::open(path)?;
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
                    findings.extend(terrain_tiles::beyond_map(params, &written));
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
