//! Heights as the colours of a PNG, as the elevation tiles of three services have them.
//!
//! With x = 65536 red + 256 green + blue:
//!
//! | encoding | height in metres | no data |
//! |---|---|---|
//! | GSI | 0.01 x, where x is a signed 24-bit number | x = 8388608, the colour (128, 0, 0) |
//! | Terrarium | x / 256 - 32768 | a transparent pixel |
//! | Mapbox Terrain-RGB | 0.1 x - 10000 | a transparent pixel |
//!
//! GSI is the Geospatial Information Authority of Japan (標高タイル). A tile of its service has 256 x 256 cells in Web
//! Mercator (EPSG:3857). Its path gives its position: `…/zoom/column/row.png`. The other two encodings name no colour
//! for no data. Transparent pixels have the colour of the height 0, because some viewers ignore transparency.
//!
//! The colours alone do not tell which encoding they are. So files state it, as text and in the `.aux.xml` beside them.

use std::io::Write;
use std::path::Path;

use glam::DVec2;
use png::{BitDepth, ColorType, Encoder, EncodingError};

use super::output::create;
use super::pam;
use super::placement::Placement;
use super::png as grey;
use super::quantity::{Quantity, Values};
use tokosen_core::base::Grid;
use tokosen_core::base::error::{Error, Result};
use tokosen_core::raster::Dem;

/// Cells along a tile's side.
const SIDE: u32 = 256;

/// Half the width of the Web Mercator map, metres: half the equator of its sphere.
const HALF_WIDTH: f64 = 6_378_137.0 * std::f64::consts::PI;

/// The highest zoom level in a path. Beyond it cells are smaller than a centimetre.
const FINEST: u32 = 24;

/// The first negative number of GSI. This number itself means no data.
const NO_DATA: u32 = 1 << 23;

/// Numbers that three bytes can hold.
const NUMBERS: u32 = 1 << 24;

/// How heights become colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ColourCode {
    Gsi,
    Terrarium,
    Mapbox,
}

impl ColourCode {
    /// The encoding with this name in a file.
    pub fn named(name: &str) -> Option<Self> {
        [Self::Gsi, Self::Terrarium, Self::Mapbox].into_iter().find(|code| code.name() == name.trim())
    }

    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Gsi => "gsi",
            Self::Terrarium => "terrarium",
            Self::Mapbox => "mapbox",
        }
    }

    /// Steps per metre, and the height of the number 0 in metres.
    fn scale(self) -> (f64, f64) {
        match self {
            Self::Gsi => (100.0, 0.0),
            Self::Terrarium => (256.0, -32_768.0),
            Self::Mapbox => (10.0, -10_000.0),
        }
    }

    /// How colours become heights, in words.
    pub fn formula(self) -> &'static str {
        match self {
            Self::Gsi => {
                "x = 65536 red + 256 green + blue; height in metres = 0.01 x for x < 8388608, 0.01 (x - 16777216) for \
                 x > 8388608; no data for x = 8388608"
            }
            Self::Terrarium => "height in metres = 256 red + green + blue / 256 - 32768; no data where transparent",
            Self::Mapbox => "height in metres = 0.1 (65536 red + 256 green + blue) - 10000; no data where transparent",
        }
    }

    /// The height of a colour, metres; `None` is no data.
    pub fn height(self, [red, green, blue]: [u8; 3]) -> Option<f64> {
        let number = u32::from_be_bytes([0, red, green, blue]);
        let (per_metre, zero) = self.scale();
        let signed = match self {
            Self::Gsi if number == NO_DATA => return None,
            Self::Gsi if number > NO_DATA => f64::from(number) - f64::from(NUMBERS),
            _ => f64::from(number),
        };
        Some(signed / per_metre + zero)
    }

    /// The colour whose height is nearest; `None` if the height is beyond those of all colours.
    pub fn colour(self, height: f64) -> Option<[u8; 3]> {
        let (per_metre, zero) = self.scale();
        let steps = ((height - zero) * per_metre).round();
        let limit = f64::from(NO_DATA);
        // NaN fails the comparisons.
        let fits = match self {
            Self::Gsi => steps > -limit && steps < limit,
            _ => steps >= 0.0 && steps < 2.0 * limit,
        };
        fits.then(|| {
            let [_, red, green, blue] = (steps as i32).to_be_bytes();
            [red, green, blue]
        })
    }
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

/// Writes `dem` to `path` as colours. The placement goes into `.pgw` and `.png.aux.xml` beside it.
pub(super) fn write(path: &Path, dem: &Dem, values: Values, code: ColourCode) -> Result<()> {
    if values.quantity != Quantity::Height {
        return Err(Error::Parameter(format!("elevation tiles hold heights, not {}", values.name())));
    }
    if values.factor().is_some() {
        let unit = values.heights.name();
        return Err(Error::Parameter(format!("elevation tiles hold heights in metres, not in {unit}")));
    }
    for (index, height) in dem.values.iter().enumerate() {
        if height.is_finite() && code.colour(f64::from(*height)).is_none() {
            let place = dem.grid.center(index % dem.grid.cols, index / dem.grid.cols);
            let message = format!(
                "the height {height} m at {} {} is beyond those of the encoding {}",
                place.x,
                place.y,
                code.name()
            );
            return Err(Error::file(path, message));
        }
    }
    create(path, |out| encode(out, dem, code).map_err(grey::filled))?;
    pam::write_aux_placement(path, dem, &[(pam::ENCODING, code.name())])?;
    pam::write_world(path, "pgw", dem)
}

fn encode(out: impl Write, dem: &Dem, code: ColourCode) -> std::result::Result<(), EncodingError> {
    // The caller has checked that both fit into 31 bits.
    let mut encoder = Encoder::new(out, dem.grid.cols as u32, dem.grid.rows as u32);
    let is_transparent = code != ColourCode::Gsi && dem.values.iter().any(|height| !height.is_finite());
    encoder.set_color(if is_transparent { ColorType::Rgba } else { ColorType::Rgb });
    encoder.set_depth(BitDepth::Eight);
    grey::describe(&mut encoder, dem, code.formula().into())?;
    encoder.add_text_chunk(pam::ENCODING.to_owned(), code.name().to_owned())?;
    let none = if code == ColourCode::Gsi { [128, 0, 0] } else { code.colour(0.0).unwrap_or_default() };
    let mut writer = encoder.write_header()?;
    let mut stream = writer.stream_writer()?;
    let mut line = Vec::with_capacity(dem.grid.cols * 4);
    for row in dem.values.chunks_exact(dem.grid.cols) {
        line.clear();
        for height in row {
            let colour = code.colour(f64::from(*height));
            line.extend(colour.unwrap_or(none));
            line.extend(is_transparent.then_some(if colour.is_some() { u8::MAX } else { 0 }));
        }
        stream.write_all(&line)?;
    }
    stream.finish()?;
    writer.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gsi_colours_and_heights_are_each_others_inverse() {
        let code = ColourCode::Gsi;
        for steps in [-8_388_607, -65_536, -257, -1, 0, 1, 255, 256, 377_624, 8_388_607] {
            let metres = f64::from(steps) / 100.0;
            assert_eq!(code.height(code.colour(metres).unwrap()), Some(metres), "{steps}");
        }
        assert_eq!(code.colour(3776.24), Some([5, 195, 24]));
        assert_eq!(code.height([128, 0, 0]), None);
        for none in [f64::NAN, f64::INFINITY, 83_887.0, -83_887.0] {
            assert_eq!(code.colour(none), None);
        }
    }

    #[test]
    fn the_other_codes_are_those_of_their_definitions() {
        // Terrarium: z + 32768 = 256 red + green + blue / 256. Mapbox: 10 (z + 10000) = 65536 red + 256 green + blue.
        for (code, height, colour) in [
            (ColourCode::Terrarium, 0.0, [128, 0, 0]),
            (ColourCode::Terrarium, 3776.25, [142, 192, 64]),
            (ColourCode::Terrarium, -32_768.0, [0, 0, 0]),
            (ColourCode::Terrarium, -0.001, [128, 0, 0]),
            (ColourCode::Terrarium, -0.003, [127, 255, 255]),
            (ColourCode::Terrarium, 32_767.996, [255, 255, 255]),
            (ColourCode::Mapbox, 0.0, [1, 134, 160]),
            (ColourCode::Mapbox, 3776.24, [2, 26, 34]),
            (ColourCode::Mapbox, -10_000.0, [0, 0, 0]),
            (ColourCode::Mapbox, 1_667_721.5, [255, 255, 255]),
        ] {
            assert_eq!(code.colour(height), Some(colour), "{code:?} {height}");
            let back = code.height(colour).unwrap();
            assert!((back - height).abs() <= 0.5 / code.scale().0 + 1e-9, "{code:?} {height} {back}");
        }
        for (code, beyond) in [
            (ColourCode::Terrarium, 32_768.0),
            (ColourCode::Terrarium, -32_768.01),
            (ColourCode::Mapbox, -10_000.06),
            (ColourCode::Mapbox, 1_667_721.6),
            (ColourCode::Mapbox, f64::NAN),
        ] {
            assert_eq!(code.colour(beyond), None, "{code:?} {beyond}");
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
