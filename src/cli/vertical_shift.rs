//! `--vertical-shift`: heights in another height system.

use std::path::{Path, PathBuf};

use clap::Args;
use tokosen::base::error::{Error, Finding};
use tokosen::io::raster::{SHIFT_EXTENSIONS, read_shift_grid};
use tokosen::raster::{Dem, ShiftGrid, ShiftWay};
use tokosen::terrain::Side;

use super::extensions::extension;
use super::failure::Failure;

#[derive(Debug, Clone, Args)]
pub struct ShiftArgs {
    /// Add the values of this grid to the heights of the height map (of two, of A), to bring them to another height system: .gtx,
    /// .tif (as in PROJ-data), .isg or .par (parameters of the Geospatial Information Authority of Japan). Bilinear, as PROJ
    /// does. Cells outside of the grid lose their heights
    #[arg(long, value_name = "GRID")]
    pub vertical_shift: Option<PathBuf>,
    /// Take the values of --vertical-shift off the heights instead. With heights of the geoid, heights above the ellipsoid become
    /// heights above the sea
    #[arg(long, requires = "vertical_shift", hide_short_help = true)]
    pub vertical_shift_inverse: bool,
}

/// A grid of shifts that was read, and what is done with it.
pub struct Shift {
    grid: ShiftGrid,
    way: ShiftWay,
}

impl ShiftArgs {
    /// The file that is read.
    pub fn file(&self) -> Option<&Path> {
        self.vertical_shift.as_deref()
    }

    /// Checks what can be checked before anything is read. `has_heights` says whether a height map is read or made.
    pub fn check(&self, has_heights: bool) -> Result<(), Failure> {
        let Some(path) = self.file() else { return Ok(()) };
        if !has_heights {
            let message = "--vertical-shift is for height maps: make one of the contours first, with 'tokosen dem'";
            return Err(Failure::Usage(message.into()));
        }
        if !SHIFT_EXTENSIONS.contains(&extension(path).as_str()) {
            let known = SHIFT_EXTENSIONS.join(", .");
            return Err(Failure::Usage(format!("{}: grids of shifts are read as .{known}", path.display())));
        }
        Ok(())
    }

    /// Reads the grid, if there is one.
    pub fn read(&self) -> Result<Option<Shift>, Failure> {
        let way = if self.vertical_shift_inverse { ShiftWay::Subtract } else { ShiftWay::Add };
        Ok(self.file().map(|path| read_shift_grid(path).map(|grid| Shift { grid, way })).transpose()?)
    }
}

impl Shift {
    /// Shifts the heights of a height map, and tells what is to be said about it.
    pub fn apply(&self, dem: &mut Dem) -> Result<Vec<Finding>, Error> {
        self.grid.shift(dem, self.way)
    }

    /// Shifts the heights of a side of a comparison, which is a height map.
    pub fn apply_to_side(&self, side: &mut Side) -> Result<Vec<Finding>, Error> {
        side.shift(&self.grid, self.way)
    }
}
