//! The arguments about height maps, and the files that a run writes.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use glam::DVec2;
use tokosen::base::Grid;
use tokosen::base::error::Error;
use tokosen::contour::ContourMap;
use tokosen::crs::{Crs, Places, Transform};
use tokosen::dem::Dem;
use tokosen::io::StagedOutput;
use tokosen::io::raster::{
    DEM_EXTENSIONS, PngEncoding, RasterParams, TWO_BAND_EXTENSIONS, read_grid, write_raster, write_with_errors,
};
use tokosen::memory;
use tokosen::spline::Wanted;
use tokosen::subdomains::{Frame, FrameRing, frame_ring};
use tokosen::surface::{Surface, Uncertainty, heights, heights_on};
use tokosen::surface::{standard_errors, standard_errors_on};

use super::Failure;
use super::console::Console;
use super::input::first_given;

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

/// A grid that is asked for, before the extent of the surface is known.
pub enum GridChoice {
    /// Square cells in the working CRS.
    Cell(f64),
    /// Cells in the working CRS.
    Like(Grid),
    /// Cells in another system, at whose centres the surface is evaluated.
    Apart(Cells, Box<Apart>),
}

impl GridChoice {
    /// The surface on the grid.
    pub fn heights(&self, surface: &Surface, console: &Console) -> Result<Dem, Failure> {
        let grid = grid_for(self, surface)?;
        Ok(match self {
            Self::Apart(_, apart) => {
                let values = heights_on(surface, &grid, &|p| apart.way.forward(p), console);
                Dem { grid, values, crs: Some(apart.crs.clone()) }
            }
            Self::Cell(_) | Self::Like(_) => heights(surface, &grid, console),
        })
    }
}

impl GridChoice {
    /// The standard errors of the surface's height map on the grid; `None` if the surface does not know them.
    fn standard_errors(&self, surface: &Surface, dem: &Dem) -> Option<Vec<f32>> {
        match self {
            Self::Apart(_, apart) => standard_errors_on(surface, dem, &|p| apart.way.forward(p)),
            Self::Cell(_) | Self::Like(_) => standard_errors(surface, dem),
        }
    }
}

/// Cells in another system.
pub enum Cells {
    Size(f64),
    Like(Grid),
}

/// A system that is not the working CRS, and the way from it to that.
pub struct Apart {
    crs: Crs,
    way: Transform,
}

/// Cells that a height map may have, whatever the memory.
const MOST_CELLS: f64 = 4e9;
/// Bytes that a cell takes while it is found and written: its height, its triangle, its part of the file.
const BYTES_A_CELL: f64 = 12.0;

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
        for (name, cell) in [("cell", self.cell), ("cell-degrees", self.cell_degrees)] {
            if let Some(cell) = cell.filter(|cell| !(cell.is_finite() && *cell > 0.0)) {
                return Err(Failure::Usage(format!("--{name} is {cell}, it must be more than 0")));
            }
        }
        Ok(())
    }

    /// The grid that is asked for; reads that of `--like`.
    pub fn choice(&self, places: &Places) -> Result<GridChoice, Failure> {
        self.check()?;
        if let Some(path) = &self.like {
            let (grid, like_crs) = read_grid(path)?;
            // A raster that names no system is taken for one in that of the contours.
            let crs = like_crs.as_ref().or(places.input_crs());
            let (Some(crs), Some(working)) = (crs, places.working_crs()) else { return Ok(GridChoice::Like(grid)) };
            let way = Transform::between(crs, working).map_err(|e| Error::file(path, e.to_string()))?;
            if way.is_identity() {
                return Ok(GridChoice::Like(grid));
            }
            return Ok(GridChoice::Apart(Cells::Like(grid), Box::new(Apart { crs: crs.clone(), way })));
        }
        let Some(size) = self.cell_degrees else { return Ok(GridChoice::Cell(self.cell.unwrap_or_default())) };
        let known = places.input_crs().and_then(Crs::geographic).zip(places.working_crs());
        let Some((crs, working)) = known else {
            let message =
                "--cell-degrees needs contours whose coordinate reference system is known; name it with --crs";
            return Err(Failure::Usage(message.into()));
        };
        let way = Transform::between(&crs, working)?;
        Ok(GridChoice::Apart(Cells::Size(size), Box::new(Apart { crs, way })))
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

/// The grid of square cells on multiples of their size over a box.
fn grid_over(lo: DVec2, hi: DVec2, cell: f64, flag: &str) -> Result<Grid, Failure> {
    let count = ((hi - lo) / cell).ceil();
    if !count.is_finite() || count.x * count.y > MOST_CELLS {
        return Err(Failure::Usage(format!(
            "--{flag} {cell} gives {:.0} x {:.0} cells: choose a larger cell",
            count.x, count.y
        )));
    }
    Ok(Grid::on_multiples(lo, hi, cell))
}

/// The grid for a surface.
pub fn grid_for(choice: &GridChoice, surface: &Surface) -> Result<Grid, Failure> {
    grid_in(choice, &surface.frame)
}

fn grid_in(choice: &GridChoice, frame: &FrameRing) -> Result<Grid, Failure> {
    match choice {
        GridChoice::Like(grid) | GridChoice::Apart(Cells::Like(grid), _) => Ok(*grid),
        GridChoice::Cell(cell) => {
            let (lo, hi) = extent(frame);
            grid_over(lo, hi, *cell, "cell")
        }
        GridChoice::Apart(Cells::Size(cell), apart) => {
            let (lo, hi) = extent_in(frame, &apart.way);
            if !(lo.is_finite() && hi.is_finite()) {
                return Err(Failure::Work(Error::Data("the frame has no place in degrees".into())));
            }
            grid_over(lo, hi, *cell, "cell-degrees")
        }
    }
}

impl GridChoice {
    /// Refuses, before the surface is found, a height map that there is no room for.
    pub fn check_room(&self, map: &ContourMap, frame: &Frame) -> Result<(), Failure> {
        let Grid { cols, rows, .. } = grid_in(self, &frame_ring(map, frame))?;
        let what = format!("a height map of {cols} x {rows} cells");
        Ok(memory::check(BYTES_A_CELL * cols as f64 * rows as f64, &what, "choose a larger cell or a smaller frame")?)
    }

    /// The system that the cells are in, where `working` is that of the surface.
    pub fn crs<'a>(&'a self, working: Option<&'a Crs>) -> Option<&'a Crs> {
        match self {
            Self::Cell(_) | Self::Like(_) => working,
            Self::Apart(_, apart) => Some(&apart.crs),
        }
    }

    /// What the smooth surface needs to know about the cells: nothing if its nodes cannot be their centres.
    pub fn wanted(&self) -> Option<Wanted> {
        match self {
            Self::Cell(cell) => Some(Wanted::Cell(*cell)),
            Self::Like(grid) => Some(Wanted::Grid(*grid)),
            Self::Apart(..) => None,
        }
    }
}

/// Points on each edge of the frame whose places in another system are looked at: edges are curves there.
const POINTS_AN_EDGE: u32 = 16;

/// The corners of the box around the frame in the system that `way` comes from.
fn extent_in(frame: &FrameRing, way: &Transform) -> (DVec2, DVec2) {
    let along =
        |[a, b]: [DVec2; 2]| (0..POINTS_AN_EDGE).map(move |k| a.lerp(b, f64::from(k) / f64::from(POINTS_AN_EDGE)));
    let places = frame.edges().flat_map(along).filter_map(|p| way.inverse(p));
    places.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)))
}

/// The lower left and the upper right corner of the frame.
pub fn extent(frame: &FrameRing) -> (DVec2, DVec2) {
    frame.rings().flatten().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)))
}

/// A height map on its way: the file was opened before the work, the grid chosen.
pub struct DemOutput {
    pub staged: StagedOutput,
    pub choice: GridChoice,
    /// The raster whose cells they are, if there is one.
    like: Option<PathBuf>,
    raster: RasterParams,
}

/// Opens the file of a height map.
pub fn open_dem(path: &Path, wanted: &HeightMapArgs) -> Result<StagedOutput, Failure> {
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
    open_raster(path)
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
    open(path)
}

/// The extension of a file in small letters.
pub fn extension(path: &Path) -> String {
    path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase()
}

impl DemOutput {
    /// A height map of the grid that is asked for, over contours whose places are these.
    pub fn new(staged: StagedOutput, wanted: &HeightMapArgs, places: &Places) -> Result<Self, Failure> {
        let grid = &wanted.grid;
        Ok(Self { choice: grid.choice(places)?, like: grid.like.clone(), staged, raster: wanted.raster() })
    }

    /// Rasterises the surface and writes the file, still under its temporary name.
    pub fn write(&self, surface: &Surface, console: &Console) -> Result<Dem, Failure> {
        let dem = self.choice.heights(surface, console)?;
        if let Some(like) = self.like.as_deref().filter(|_| dem.values.iter().all(|height| height.is_nan())) {
            let message = "none of its cells lies on the ground of the contours: do they overlap, and are the coordinate \
                           reference systems those that the files name?";
            return Err(Failure::Work(Error::file(like, message)));
        }
        let errors = self.choice.standard_errors(surface, &dem);
        let written = console.step("writing", || match &errors {
            Some(errors) => write_with_errors(&self.staged.path(), &dem, errors),
            None => write_raster(&self.staged.path(), &dem, &self.raster),
        });
        written.map_err(|e| self.staged.with_final_name(e))?;
        Ok(dem)
    }
}

/// Opens an output before the work starts, so that a missing folder is told at once.
pub fn open(path: &Path) -> Result<StagedOutput, Failure> {
    Ok(StagedOutput::create(path)?)
}

/// Refuses to write over an input or to write two outputs into one file.
pub fn check_paths(inputs: &[&Path], outputs: &[&Path]) -> Result<(), Failure> {
    let inputs: Vec<PathBuf> = inputs.iter().map(|path| identity(path)).collect();
    let mut taken = Vec::new();
    for path in outputs {
        let file = identity(path);
        if inputs.contains(&file) {
            return Err(Failure::Usage(format!("{} is an input: choose another name for the output", path.display())));
        }
        if taken.contains(&file) {
            return Err(Failure::Usage(format!("{} is named for two outputs", path.display())));
        }
        taken.push(file);
    }
    Ok(())
}

/// What two paths of one file have in common, whether it is there yet or not.
fn identity(path: &Path) -> PathBuf {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let made = || Some(folder.canonicalize().ok()?.join(path.file_name()?));
    path.canonicalize().ok().or_else(made).unwrap_or_else(|| path.to_owned())
}

/// One line of the summary about a height map.
pub fn describe(path: &Path, dem: &Dem, console: &Console) {
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
