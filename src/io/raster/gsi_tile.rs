//! Elevation tiles of the Geospatial Information Authority of Japan (標高タイル): heights as the colours of a PNG.
//!
//! With x = 65536 red + 256 green + blue, a height is 0.01 x metres, x being counted as a signed number of 24 bits;
//! x = 8388608, the colour (128, 0, 0), is no data. A tile of the service has 256 x 256 cells in Web Mercator
//! (EPSG:3857), and its path tells where it is: `…/zoom/column/row.png`.

use std::path::Path;

use glam::DVec2;

use super::sidecar::Placement;
use crate::dem::Grid;

/// Cells along a tile's side.
const SIDE: u32 = 256;

/// Half the width of the Web Mercator map, metres: half the equator of the sphere that it is drawn on.
const HALF_WIDTH: f64 = 6_378_137.0 * std::f64::consts::PI;

/// Finest zoom level that a path may name; cells are smaller than a centimetre beyond.
const FINEST: u32 = 24;

/// The first code that is negative; itself it means no data.
const NO_DATA: u32 = 1 << 23;

/// The height of a colour, metres; `None` is no data.
pub(super) fn height(rgb: [u8; 3]) -> Option<f64> {
    let code = u32::from_be_bytes([0, rgb[0], rgb[1], rgb[2]]);
    let steps = if code < NO_DATA { f64::from(code) } else { f64::from(code) - f64::from(NO_DATA) * 2.0 };
    (code != NO_DATA).then_some(steps / 100.0)
}

/// The place of the tile whose path ends in `zoom/column/row.png`.
pub(super) fn placement(path: &Path, size: (u32, u32)) -> Option<Placement> {
    let number = |text: Option<&std::ffi::OsStr>| text?.to_str()?.parse::<u32>().ok();
    let row = number(path.file_stem())?;
    let folder = path.parent()?;
    let column = number(folder.file_name())?;
    let zoom = number(folder.parent()?.file_name())?;
    let tiles = 1_u32.checked_shl(zoom).filter(|_| zoom <= FINEST)?;
    if size != (SIDE, SIDE) || column >= tiles || row >= tiles {
        return None;
    }
    let width = 2.0 * HALF_WIDTH / f64::from(tiles);
    let corner = DVec2::new(f64::from(column) * width - HALF_WIDTH, HALF_WIDTH - f64::from(row) * width);
    let side = SIDE as usize;
    let grid = Grid { corner, cell: DVec2::splat(width / f64::from(SIDE)), cols: side, rows: side };
    Some(Placement { grid, south_up: false })
}
