//! Where the cells of a raster file are.

use glam::DVec2;

use tokosen_core::base::Grid;

/// The placement of a raster's cells, and the order of its rows in the file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Placement {
    pub grid: Grid,
    /// Whether the file begins with the southernmost row.
    pub south_up: bool,
}

impl Placement {
    /// The row of the grid for a row of the file.
    pub fn row(&self, stored: usize) -> usize {
        if self.south_up { self.grid.rows - 1 - stored } else { stored }
    }
}

/// The placement by an affine transform: the outer corner of the first stored cell, and the step per column and per
/// row.
///
/// `Err` states what is wrong. It is the rest of a sentence that begins with the file's name.
pub(super) fn north_up(
    origin: DVec2,
    across: DVec2,
    down: DVec2,
    (cols, rows): (usize, usize),
) -> std::result::Result<Placement, String> {
    if across.y != 0.0 || down.x != 0.0 {
        return Err("is rotated or sheared; warp it to a grid with north up first, for example with gdalwarp".into());
    }
    let cell = DVec2::new(across.x, down.y.abs());
    if across.x <= 0.0 {
        return Err("runs from east to west; rewrite it with north up first, for example with gdalwarp".into());
    }
    let south_up = down.y > 0.0;
    let corner = if south_up { origin + DVec2::new(0.0, rows as f64 * down.y) } else { origin };
    if !(corner.is_finite() && cell.is_finite() && cell.min_element() > 0.0) {
        return Err(format!(
            "has cells of {} x {} at {}, {}, which is not a valid grid",
            cell.x, cell.y, corner.x, corner.y
        ));
    }
    Ok(Placement { grid: Grid { corner, cell, cols, rows }, south_up })
}

/// The placement by GDAL's six numbers: x of the corner, cell width, shear, y of the corner, shear, cell height
/// (negative if north is up).
pub(super) fn by_transform(numbers: [f64; 6], size: (usize, usize)) -> std::result::Result<Placement, String> {
    let [x, a, b, y, d, e] = numbers;
    north_up(DVec2::new(x, y), DVec2::new(a, d), DVec2::new(b, e), size)
}
