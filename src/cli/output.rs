//! The arguments about height maps, and the files that a run writes.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use tokosen::dem::Dem;
use tokosen::io::raster::{
    DEM_EXTENSIONS, PngEncoding, RasterParams, TWO_BAND_EXTENSIONS, write_raster, write_with_errors,
};
use tokosen::io::{StagedOutput, VectorFormat};
use tokosen::surface::Uncertainty;
use tokosen::{GridSpec, Terrain};

use super::console::Console;
use super::failure::Failure;
use super::flags::first_given;

/// Where the cells of a height map are.
#[derive(Debug, Clone, Args)]
pub struct GridArgs {
    /// Cell size of the height map [units of the working CRS]; cells lie on multiples of it
    #[arg(long, value_name = "SIZE", allow_negative_numbers = true)]
    pub cell: Option<f64>,
    /// Make the height map in degrees, with cells of this size [degrees; seconds with an s: 0.4s]
    #[arg(long, value_name = "SIZE", value_parser = degrees, allow_negative_numbers = true, conflicts_with = "cell")]
    pub cell_degrees: Option<f64>,
    /// Take the grid of this height map (.tif, .asc, .exr, .png): size, place and cells, square or not, in any coordinate
    /// reference system
    #[arg(long, value_name = "RASTER", conflicts_with_all = ["cell", "cell_degrees"])]
    pub like: Option<PathBuf>,
}

/// A height map that is written: where its cells are, and how they are kept.
#[derive(Debug, Clone, Args)]
pub struct HeightMapArgs {
    #[command(flatten)]
    pub grid: GridArgs,
    /// How a .png keeps heights
    #[arg(long, value_enum, default_value_t = PngArg::Gray16)]
    pub png_encoding: PngArg,
    /// Also tell how far heights are expected to be off: a second band 'standard error' (.tif) or channel (.exr), in metres,
    /// learnt by hiding contours. New contours get the attributes err_v and err_h [metres] and inferred
    #[arg(long)]
    pub uncertainty: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum PngArg {
    /// 16-bit grey with scale and offset beside it, which GDAL and QGIS read as heights
    Gray16,
    /// Colours of GSI elevation tiles (地理院 標高タイル), steps of 1 cm; QGIS shows these as colours, not as heights
    Gsi,
}

/// An angle in degrees or, with an s behind it, in seconds.
fn degrees(text: &str) -> Result<f64, String> {
    let (number, parts) = text.strip_suffix('s').map_or((text, 1.0), |number| (number, 3600.0));
    number.parse().map(|angle: f64| angle / parts).map_err(|e| e.to_string())
}

impl GridArgs {
    /// Whether a grid is asked for.
    pub fn is_given(&self) -> bool {
        self.given().is_some()
    }

    /// The flag that asks for a grid.
    pub fn given(&self) -> Option<&'static str> {
        let given = [
            (self.cell.is_some(), "--cell"),
            (self.cell_degrees.is_some(), "--cell-degrees"),
            (self.like.is_some(), "--like"),
        ];
        first_given(given)
    }

    /// Checks what can be checked before anything is read.
    pub fn check(&self) -> Result<(), Failure> {
        if !self.is_given() {
            let message = "a height map needs --cell SIZE, --cell-degrees SIZE or --like RASTER";
            return Err(Failure::Usage(message.into()));
        }
        let sizes = self.cell.map(GridSpec::Cell).into_iter().chain(self.cell_degrees.map(GridSpec::Degrees));
        Ok(sizes.into_iter().try_for_each(|size| size.check())?)
    }

    /// The grid that is asked for; reads that of `--like`.
    pub fn spec(&self) -> Result<GridSpec, Failure> {
        self.check()?;
        Ok(match (&self.like, self.cell_degrees) {
            (Some(path), _) => GridSpec::like(path)?,
            (None, Some(size)) => GridSpec::Degrees(size),
            (None, None) => GridSpec::Cell(self.cell.unwrap_or_default()),
        })
    }
}

impl HeightMapArgs {
    /// The first flag that is given; a run without a height map must not pass over it.
    pub fn given(&self) -> Option<&'static str> {
        self.grid.given().or((self.png_encoding != PngArg::Gray16).then_some("--png-encoding"))
    }

    /// Whether the expected errors are to be found.
    pub fn uncertainty(&self) -> Uncertainty {
        if self.uncertainty { Uncertainty::Learnt } else { Uncertainty::Unknown }
    }

    /// How to write the height map.
    fn raster(&self) -> RasterParams {
        let png = match self.png_encoding {
            PngArg::Gray16 => PngEncoding::Gray16,
            PngArg::Gsi => PngEncoding::Gsi,
        };
        RasterParams { png, ..RasterParams::default() }
    }
}

/// A height map on its way: the file was opened before the work.
pub struct DemOutput {
    staged: StagedOutput,
    pub grid: GridSpec,
    raster: RasterParams,
}

/// Refuses a file whose extension is that of no vector format; `kinds` says which are.
pub fn check_vector(path: &Path, kinds: &str) -> Result<(), Failure> {
    VectorFormat::from_path(path).map_err(|_| Failure::Usage(format!("{}: {kinds}", path.display())))?;
    Ok(())
}

/// Opens the file of a raster.
pub fn open_raster(path: &Path) -> Result<StagedOutput, Failure> {
    let extension = extension(path);
    if !DEM_EXTENSIONS.contains(&extension.as_str()) {
        return Err(Failure::Usage(format!(
            "{}: height maps are written as {}",
            path.display(),
            DEM_EXTENSIONS.map(|e| format!(".{e}")).join(", ")
        )));
    }
    Ok(StagedOutput::create(path)?)
}

/// The extension of a file in small letters.
pub fn extension(path: &Path) -> String {
    path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase()
}

impl DemOutput {
    /// Opens the file, and reads the raster whose cells are asked for.
    pub fn open(path: &Path, wanted: &HeightMapArgs) -> Result<Self, Failure> {
        wanted.grid.check()?;
        if wanted.png_encoding == PngArg::Gsi && extension(path) != "png" {
            let message = format!("{}: --png-encoding is about height maps in .png", path.display());
            return Err(Failure::Usage(message));
        }
        if wanted.uncertainty && !TWO_BAND_EXTENSIONS.contains(&extension(path).as_str()) {
            let message = format!(
                "{}: this format has no room for --uncertainty; write {}",
                path.display(),
                TWO_BAND_EXTENSIONS.map(|e| format!(".{e}")).join(", ")
            );
            return Err(Failure::Usage(message));
        }
        let staged = open_raster(path)?;
        Ok(Self { staged, grid: wanted.grid.spec()?, raster: wanted.raster() })
    }

    /// Rasterises the surface and writes the file, still under its temporary name.
    pub fn write(&self, terrain: &Terrain, console: &Console) -> Result<Dem, Failure> {
        let dem = terrain.dem_with(&self.grid, console)?;
        let errors = terrain.errors_of(&dem, &self.grid)?;
        let written = console.step("writing", || match &errors {
            Some(errors) => write_with_errors(&self.staged.path(), &dem, errors),
            None => write_raster(&self.staged.path(), &dem, &self.raster),
        });
        written.map_err(|e| self.staged.with_final_name(e))?;
        Ok(dem)
    }

    /// Puts the file in its place, and tells what is in it.
    pub fn commit(self, dem: &Dem, console: &Console) -> Result<(), Failure> {
        describe(&self.staged.commit()?, dem, console);
        Ok(())
    }
}

/// One line of the summary about a height map.
fn describe(path: &Path, dem: &Dem, console: &Console) {
    let valid = dem.values.iter().filter(|v| !v.is_nan());
    let (low, high) = valid.clone().fold((f32::INFINITY, f32::NEG_INFINITY), |m, &v| (m.0.min(v), m.1.max(v)));
    let count = valid.count();
    let range = if count == 0 { "no data".into() } else { format!("heights {low:.2} to {high:.2} m") };
    console.say(&format!(
        "written    {} ({} x {} cells, {:.1} % with data, {range})",
        path.display(),
        dem.grid.cols,
        dem.grid.rows,
        100.0 * count as f64 / dem.grid.len().max(1) as f64,
    ));
}
