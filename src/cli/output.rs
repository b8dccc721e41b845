//! The arguments about height maps, and the files that a run writes.

use std::path::{Path, PathBuf};

use clap::Args;
use glam::DVec2;
use tokosen::crs::Crs;
use tokosen::dem::{Dem, Grid};
use tokosen::error::Error;
use tokosen::io::StagedOutput;
use tokosen::io::raster::{DEM_EXTENSIONS, read_grid, write_dem};
use tokosen::surface::{Surface, Wanted, heights};
use tokosen::tin::FrameRing;

use super::Failure;
use super::console::Console;

/// Where the cells of a height map are.
#[derive(Debug, Clone, Args)]
pub struct GridArgs {
    /// Cell size of the height map [map units]; cells lie on multiples of it
    #[arg(long, value_name = "SIZE", allow_negative_numbers = true)]
    pub cell: Option<f64>,
    /// Take the grid of this GeoTIFF: size, place and cells, square or not
    #[arg(long, value_name = "RASTER", conflicts_with = "cell")]
    pub like: Option<PathBuf>,
}

/// A grid that is asked for, before the extent of the surface is known.
pub enum GridChoice {
    Cell(f64),
    Like(Grid),
}

/// Cells that a height map may have; the memory it takes is four bytes each.
const MOST_CELLS: f64 = 4e9;

impl GridArgs {
    /// Checks what can be checked before anything is read.
    pub fn check(&self) -> Result<(), Failure> {
        match (self.cell, &self.like) {
            (Some(cell), _) if !(cell.is_finite() && cell > 0.0) => {
                Err(Failure::Usage(format!("--cell is {cell}, it must be more than 0")))
            }
            (None, None) => Err(Failure::Usage("a height map needs --cell SIZE or --like RASTER".into())),
            _ => Ok(()),
        }
    }

    /// The grid that is asked for; reads that of `--like`.
    pub fn choice(&self, crs: Option<&Crs>) -> Result<GridChoice, Failure> {
        self.check()?;
        match &self.like {
            None => Ok(GridChoice::Cell(self.cell.unwrap_or_default())),
            Some(path) => {
                let (grid, like_crs) = read_grid(path)?;
                if let (Some(a), Some(b)) = (crs, &like_crs)
                    && !a.matches(b)
                {
                    return Err(Failure::Work(Error::file(
                        path,
                        "is in another coordinate reference system than the contours; reproject one of them first",
                    )));
                }
                Ok(GridChoice::Like(grid))
            }
        }
    }
}

/// The grid for a surface.
pub fn grid_for(choice: &GridChoice, surface: &Surface) -> Result<Grid, Failure> {
    match choice {
        GridChoice::Like(grid) => Ok(*grid),
        GridChoice::Cell(cell) => {
            let (lo, hi) = extent(&surface.frame);
            let count = ((hi - lo) / *cell).ceil();
            if count.x * count.y > MOST_CELLS {
                return Err(Failure::Usage(format!(
                    "--cell {cell} gives {:.0} x {:.0} cells: choose a larger cell",
                    count.x, count.y
                )));
            }
            Ok(Grid::on_multiples(lo, hi, *cell))
        }
    }
}

impl GridChoice {
    /// What the smooth surface needs to know about the cells.
    pub fn wanted(&self) -> Wanted {
        match self {
            Self::Cell(cell) => Wanted::Cell(*cell),
            Self::Like(grid) => Wanted::Grid(*grid),
        }
    }
}

/// The lower left and the upper right corner of the frame.
pub fn extent(frame: &FrameRing) -> (DVec2, DVec2) {
    frame.rings().flatten().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)))
}

/// A height map on its way: the file was opened before the work, the grid chosen.
pub struct DemOutput {
    pub staged: StagedOutput,
    pub choice: GridChoice,
}

/// Opens the file of a height map.
pub fn open_dem(path: &Path) -> Result<StagedOutput, Failure> {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    if !DEM_EXTENSIONS.contains(&extension.as_str()) {
        return Err(Failure::Usage(format!(
            "{}: height maps are written as {}",
            path.display(),
            DEM_EXTENSIONS.map(|e| format!(".{e}")).join(", ")
        )));
    }
    open(path)
}

impl DemOutput {
    /// A height map of the grid that is asked for. `crs` is that of the contours.
    pub fn new(staged: StagedOutput, grid: &GridArgs, crs: Option<&Crs>) -> Result<Self, Failure> {
        Ok(Self { choice: grid.choice(crs)?, staged })
    }

    /// Rasterises the surface and writes the file, still under its temporary name.
    pub fn write(&self, surface: &Surface, console: &Console) -> Result<Dem, Failure> {
        let grid = grid_for(&self.choice, surface)?;
        let dem = heights(surface, &grid, console);
        let written = console.step("writing", || write_dem(&self.staged.path(), &dem));
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
