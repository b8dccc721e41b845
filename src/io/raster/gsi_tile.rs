//! Elevation tiles of the Geospatial Information Authority of Japan (標高タイル): heights as the colours of a PNG.
//!
//! With x = 65536 red + 256 green + blue, a height is 0.01 x metres, where x is a signed 24-bit number. x = 8388608,
//! the colour (128, 0, 0), means no data. A tile of the service has 256 x 256 cells in Web Mercator (EPSG:3857). Its
//! path gives its position: `…/zoom/column/row.png`.

use std::io::Write;
use std::path::Path;

use glam::DVec2;
use png::{BitDepth, ColorType, Encoder, EncodingError};

use super::output::create;
use super::pam;
use super::png as grey;
use super::quantity::{Quantity, Values};
use super::sidecar::Placement;
use crate::base::Grid;
use crate::base::error::{Error, Result};
use crate::dem::Dem;

/// Cells along a tile's side.
const SIDE: u32 = 256;

/// Half the width of the Web Mercator map, metres: half the equator of its sphere.
const HALF_WIDTH: f64 = 6_378_137.0 * std::f64::consts::PI;

/// The highest zoom level in a path. Beyond it cells are smaller than a centimetre.
const FINEST: u32 = 24;

/// The first negative code. This code itself means no data.
const NO_DATA: u32 = 1 << 23;

/// The height of a colour, metres; `None` is no data.
pub(super) fn height(rgb: [u8; 3]) -> Option<f64> {
    let code = u32::from_be_bytes([0, rgb[0], rgb[1], rgb[2]]);
    let steps = if code < NO_DATA { f64::from(code) } else { f64::from(code) - f64::from(NO_DATA) * 2.0 };
    (code != NO_DATA).then_some(steps / 100.0)
}

/// The placement of a tile whose path ends in `zoom/column/row.png`.
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

/// Writes `dem` to `path` in the colours of elevation tiles. The placement goes into `.pgw` and `.png.aux.xml` beside
/// it.
pub(super) fn write(path: &Path, dem: &Dem, values: Values) -> Result<()> {
    if values.quantity != Quantity::Height {
        return Err(Error::Parameter(format!("elevation tiles hold heights, not {}", values.name())));
    }
    if values.factor().is_some() {
        let unit = values.heights.name();
        return Err(Error::Parameter(format!("elevation tiles hold heights in metres, not in {unit}")));
    }
    for (index, height) in dem.values.iter().enumerate() {
        if height.is_finite() && color(*height).is_none() {
            let place = dem.grid.center(index % dem.grid.cols, index / dem.grid.cols);
            let message =
                format!("the height {height} m at {} {} does not fit into an elevation tile", place.x, place.y);
            return Err(Error::file(path, message));
        }
    }
    create(path, |out| encode(out, dem).map_err(grey::filled))?;
    pam::write_aux_placement(path, dem)?;
    pam::write_world(path, "pgw", dem)
}

fn encode(out: impl Write, dem: &Dem) -> std::result::Result<(), EncodingError> {
    // The caller has checked that both fit into 31 bits.
    let mut encoder = Encoder::new(out, dem.grid.cols as u32, dem.grid.rows as u32);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    let formula = "x = 65536 red + 256 green + blue; height in metres = 0.01 x for x < 8388608, 0.01 (x - 16777216) for \
                   x > 8388608; no data for x = 8388608";
    grey::describe(&mut encoder, dem, formula.into())?;
    let mut writer = encoder.write_header()?;
    let mut stream = writer.stream_writer()?;
    let mut line = Vec::with_capacity(dem.grid.cols * 3);
    for row in dem.values.chunks_exact(dem.grid.cols) {
        line.clear();
        line.extend(row.iter().flat_map(|&height| color(height).unwrap_or([128, 0, 0])));
        stream.write_all(&line)?;
    }
    stream.finish()?;
    writer.finish()
}

/// The colour of a height; `None` if it has none.
fn color(height: f32) -> Option<[u8; 3]> {
    let steps = (f64::from(height) * 100.0).round();
    let limit = f64::from(NO_DATA);
    // NaN fails the comparison.
    let fits = steps > -limit && steps < limit;
    fits.then(|| {
        let [_, red, green, blue] = (steps as i32).to_be_bytes();
        [red, green, blue]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_and_heights_are_each_others_inverse() {
        for steps in [-8_388_607, -65_536, -257, -1, 0, 1, 255, 256, 377_624, 8_388_607] {
            let metres = f64::from(steps) / 100.0;
            let rgb = color(metres as f32).unwrap();
            let step = if metres.abs() > 10_000.0 { 1.0 } else { 0.0 };
            assert!((height(rgb).unwrap() - metres).abs() <= 0.01 * step, "{steps}");
        }
        assert_eq!(color(3776.24), Some([5, 195, 24]));
        assert_eq!(height([128, 0, 0]), None);
        for none in [f32::NAN, f32::INFINITY, 83_887.0, -83_887.0] {
            assert_eq!(color(none), None);
        }
    }

    #[test]
    fn only_paths_of_tiles_are_places() {
        let place = |path: &str| placement(Path::new(path), (256, 256)).map(|placement| placement.grid.corner);
        assert!(place("a/14/14549/6452.png").is_some());
        for path in ["6452.png", "14549/6452.png", "a/b/6452.png", "3/8/0.png", "3/0/8.png", "25/0/0.png", "/0.png"] {
            assert_eq!(place(path), None, "{path}");
        }
        assert_eq!(placement(Path::new("14/14549/6452.png"), (512, 512)), None);
        assert_eq!(place("0/0/0.png"), Some(DVec2::new(-HALF_WIDTH, HALF_WIDTH)));
    }
}
