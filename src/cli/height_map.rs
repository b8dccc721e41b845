//! The arguments about height maps: where their cells are, and how heights are stored.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use tokosen::GridSpec;
use tokosen::base::ElevationUnit;
use tokosen::crs::Crs;
use tokosen::io::raster::{PngEncoding, RasterParams, TiffLayout};
use tokosen::io::tiles::TerrainTiles;
use tokosen::surface::Uncertainty;

use super::extensions::is_tiff;
use super::failure::Failure;
use super::terrain_tiles::TerrainTileArgs;

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
    /// Use the grid of this height map (.tif, .asc, .exr, .png, .xyz, LandXML triangles): its extent, its cells, square or not, and its
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
    pub fn raster(&self, unit: ElevationUnit) -> RasterParams {
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
    pub fn encoding(self) -> PngEncoding {
        match self {
            Self::Gray16 => PngEncoding::Gray16,
            Self::Gsi => PngEncoding::Gsi,
            Self::Terrarium => PngEncoding::Terrarium,
            Self::Mapbox => PngEncoding::Mapbox,
        }
    }
}
