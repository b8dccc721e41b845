//! Raster files: reads height maps ([`read_dem`]), writes them ([`write_dem`]), and reads the grid of an existing
//! raster ([`read_grid`]).
//!
//! The file's extension decides the format:
//!
//! | name | values | placement and coordinate reference system |
//! |---|---|---|
//! | `.tif`, `.tiff` | 32-bit floating point, lossless | in the file (GeoTIFF) |
//! | `.exr` | 32-bit floating point, lossless | in the file, as GDAL reads them; nodata in `.exr.aux.xml` |
//! | `.png` | 16-bit steps of a round size, or colours | in the file as text, in `.pgw` and in `.png.aux.xml` |
//! | `.asc` | text (ESRI ASCII grid), lossless | in the file; coordinate reference system in `.prj` |
//! | `.xyz` | text, a line `x y height` for every cell with data, lossless | in the file, as cell centres; no system |
//!
//! [`write_for_engine`] writes height maps for game engines and 3-D programs.
//!
//! Sidecar files are written beside the main file, in any directory.

mod asc;
mod chunks;
mod cog;
mod directory;
mod elevation_tile;
mod engine;
mod exr;
mod geokeys;
mod geotiff;
mod geotiff_read;
mod geotiff_rows;
mod height_unit;
mod heights;
mod like;
mod output;
mod overview;
mod pam;
mod picture;
mod placement;
mod png;
mod png_read;
mod quantity;
mod read;
mod shift_grid;
mod sidecar;
mod stac;
mod xyz;
mod xyz_read;
mod zstd;

use std::borrow::Cow;
use std::path::Path;

pub(crate) use elevation_tile::ColourCode;
use output::{check, check_grid};
use quantity::Values;
use tokosen_core::base::error::{Error, Result};
use tokosen_core::base::{ElevationUnit, Grid};
use tokosen_core::raster::{Dem, RasterRows};

pub use engine::{Engine, EngineFiles, write_for_engine};
pub use picture::{picture_bytes, write_picture, write_shade};
pub use quantity::{Quantity, STANDARD_ERROR};
pub use read::{DemFile, DemRows, READABLE_EXTENSIONS, open_dem, read_dem, read_grid, read_standard_errors};
pub use shift_grid::{SHIFT_EXTENSIONS, read_shift_grid};
pub use stac::write_stac_item;

/// The extensions that [`write_dem`] accepts, for messages and help texts.
pub const DEM_EXTENSIONS: [&str; 6] = ["tif", "tiff", "exr", "png", "asc", "xyz"];

/// How a PNG stores heights.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PngEncoding {
    /// 16-bit grey with a round step size. GDAL and QGIS read it as heights.
    #[default]
    Gray16,
    /// The colours of the elevation tiles of the Geospatial Information Authority of Japan, with steps of a centimetre.
    /// GDAL and QGIS read them as colours, as those of the other encodings below.
    Gsi,
    /// The colours of Terrarium tiles, with steps of 1/256 metre, for heights from -32768 to 32768 metres.
    Terrarium,
    /// The colours of Mapbox Terrain-RGB tiles, with steps of 0.1 metres, for heights from -10000 metres.
    Mapbox,
}

impl PngEncoding {
    /// The colours of heights; none for grey.
    pub(crate) fn colours(self) -> Option<ColourCode> {
        match self {
            Self::Gray16 => None,
            Self::Gsi => Some(ColourCode::Gsi),
            Self::Terrarium => Some(ColourCode::Terrarium),
            Self::Mapbox => Some(ColourCode::Mapbox),
        }
    }
}

/// How a GeoTIFF is laid out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TiffLayout {
    /// The map alone, in tiles. Other programs can change such a file, for example add overviews.
    #[default]
    Plain,
    /// A Cloud Optimized GeoTIFF, which is read in parts over a network. It has overviews: a cell of an overview is the
    /// mean of the cells with data among the two by two below it. The smallest overview is one tile.
    CloudOptimized,
}

/// How to write a raster.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct RasterParams {
    /// What the values are. The file states it.
    pub quantity: Quantity,
    /// How a PNG stores them. The other formats have only one way.
    pub png: PngEncoding,
    /// How a GeoTIFF is laid out.
    pub tiff: TiffLayout,
    /// The unit in which heights and differences of heights are written. In memory they are metres. The file states the
    /// unit, except `.xyz`, which has no place for it.
    pub unit: ElevationUnit,
}

/// Writes a height map in the format of the extension of `path`, with its sidecar files beside it.
///
/// # Errors
/// As [`write_raster`].
pub fn write_dem(path: &Path, dem: &Dem) -> Result<()> {
    write_raster(path, dem, &RasterParams::default())
}

/// Writes values on a grid in the format of the extension of `path`, with its sidecar files beside it.
///
/// # Errors
/// One of these is the case:
/// - The extension is not in [`DEM_EXTENSIONS`].
/// - The grid has no cells or an invalid placement.
/// - The grid or a value does not fit the format. Elevation tiles hold heights in metres only.
/// - The operating system reports an error.
pub fn write_raster(path: &Path, dem: &Dem, params: &RasterParams) -> Result<()> {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    let write: &dyn Fn(&Path, &Dem, Values) -> Result<()> = match extension.as_str() {
        "tif" | "tiff" => &|path, dem, values| geotiff::write(path, dem, values, params.tiff, None),
        "exr" => &|path, dem, values| exr::write(path, dem, values, None),
        "png" => &|path, dem, values| match params.png {
            PngEncoding::Gray16 => png::write(path, dem, values),
            PngEncoding::Gsi => elevation_tile::write(path, dem, values, ColourCode::Gsi),
            PngEncoding::Terrarium => elevation_tile::write(path, dem, values, ColourCode::Terrarium),
            PngEncoding::Mapbox => elevation_tile::write(path, dem, values, ColourCode::Mapbox),
        },
        "asc" => &asc::write,
        "xyz" => &xyz::write,
        _ => {
            return Err(Error::file(
                path,
                format!(
                    "no height map format has this extension; heights are written as {}",
                    DEM_EXTENSIONS.map(|e| format!(".{e}")).join(", ")
                ),
            ));
        }
    };
    check(path, dem)?;
    let values = Values { quantity: params.quantity, heights: params.unit };
    write(path, &in_file(dem, values), values)
}

/// Writes values that are computed or read row by row, as [`write_raster`]. A plain GeoTIFF in metres takes a few rows of
/// memory; in other formats all values are in memory.
///
/// # Errors
/// As [`write_raster`] and [`RasterRows::read`].
pub fn write_rows(path: &Path, rows: &dyn RasterRows, params: &RasterParams) -> Result<()> {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    let values = Values { quantity: params.quantity, heights: params.unit };
    let is_plain = params.tiff == TiffLayout::Plain && values.factor().is_none();
    if !is_plain || !matches!(extension.as_str(), "tif" | "tiff") {
        return write_raster(path, &*rows.whole()?, params);
    }
    check_grid(path, &rows.grid())?;
    let crs = rows.crs().map(|crs| crs.with_heights_in(values.heights));
    geotiff::write_rows(path, rows, crs.as_ref(), values)
}

/// What a file says in texts that many programs drop, as sentences for people: how numbers become heights, and where the cells
/// are. None for formats whose numbers are the heights and whose place programs read.
pub fn reading(path: &Path, dem: &Dem, params: &RasterParams) -> Vec<String> {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    let values = Values { quantity: params.quantity, heights: params.unit };
    let formula = match (extension.as_str(), params.png) {
        ("png", PngEncoding::Gray16) => png::formula(&in_file(dem, values), values),
        ("png", PngEncoding::Gsi) => ColourCode::Gsi.formula().to_owned(),
        ("png", PngEncoding::Terrarium) => ColourCode::Terrarium.formula().to_owned(),
        ("png", PngEncoding::Mapbox) => ColourCode::Mapbox.formula().to_owned(),
        ("exr", _) => format!("{} = value of the first channel", values.words()),
        _ => return Vec::new(),
    };
    let Grid { corner, cell, .. } = dem.grid;
    let place = format!("upper left corner {} {}, cells of {} x {}", corner.x, corner.y, cell.x, cell.y);
    vec![formula, place]
}

/// A raster as a file holds it: values in their unit there, a system that does not contradict it.
fn in_file(dem: &Dem, values: Values) -> Cow<'_, Dem> {
    let crs = dem.crs.as_ref().map(|crs| crs.with_heights_in(values.heights));
    match values.factor() {
        None if crs == dem.crs => Cow::Borrowed(dem),
        None => Cow::Owned(Dem { crs, ..dem.clone() }),
        Some(factor) => Cow::Owned(Dem { values: times(&dem.values, factor), grid: dem.grid, crs }),
    }
}

/// Values in another unit.
fn times(values: &[f32], factor: f64) -> Vec<f32> {
    values.iter().map(|&value| (f64::from(value) * factor) as f32).collect()
}

/// The extensions of the formats that hold a second value per cell, for messages.
pub const TWO_BAND_EXTENSIONS: [&str; 3] = ["tif", "tiff", "exr"];

/// Writes a height map with the standard error of every cell. Both are in metres in memory, and in the unit of the
/// parameters in the file. The errors are the second band of a GeoTIFF or a second channel of an OpenEXR file. An error
/// of NaN means no data.
///
/// # Errors
/// As [`write_raster`]. Also if the format is another one, or if there is not one error per cell.
pub fn write_with_errors(path: &Path, dem: &Dem, errors: &[f32], params: &RasterParams) -> Result<()> {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    check(path, dem)?;
    if errors.len() != dem.values.len() {
        let message = format!("{}: {} errors for {} cells", path.display(), errors.len(), dem.values.len());
        return Err(Error::Parameter(message));
    }
    let values = Values { quantity: Quantity::Height, heights: params.unit };
    let dem = &in_file(dem, values);
    let errors = &values.factor().map_or(Cow::Borrowed(errors), |factor| Cow::Owned(times(errors, factor)));
    match extension.as_str() {
        "tif" | "tiff" => geotiff::write(path, dem, values, params.tiff, Some(errors)),
        "exr" => exr::write(path, dem, values, Some(errors)),
        _ => {
            let known = TWO_BAND_EXTENSIONS.map(|e| format!(".{e}")).join(", ");
            Err(Error::file(
                path,
                format!("this format has one value per cell; heights with errors are written as {known}"),
            ))
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use tokosen_core::base::Grid;
    use tokosen_core::base::error::FindingKind;
    use tokosen_core::crs::Crs;

    /// A small tilted surface with a hole.
    pub(super) fn sample(cols: usize, rows: usize) -> Dem {
        let mut values: Vec<f32> =
            (0..cols * rows).map(|i| 900.0 + (i % cols) as f32 * 1.25 + (i / cols) as f32 * 0.0625).collect();
        values[cols + 1] = f32::NAN;
        let grid =
            Grid { corner: DVec2::new(735_598.739_979_694_4, 4_033_368.5), cell: DVec2::new(10.0, 12.5), cols, rows };
        Dem { grid, values, crs: Some(Crs { epsg: Some(6690), wkt: None }) }
    }

    #[test]
    fn an_unknown_extension_names_the_known_ones() {
        let dir = tempfile::tempdir().unwrap();
        for name in ["dem.txt", "dem", "dem.TIF.gz"] {
            let path = dir.path().join(name);
            let error = write_dem(&path, &sample(4, 4)).unwrap_err().to_string();
            assert!(error.contains(".tif, .tiff, .exr, .png, .asc, .xyz"), "{error}");
            assert!(!path.exists());
        }
    }

    #[test]
    fn errors_come_back_bit_for_bit_beside_the_heights() {
        let dir = tempfile::tempdir().unwrap();
        let mut dem = sample(300, 270);
        dem.crs = None;
        let errors: Vec<f32> =
            dem.values.iter().enumerate().map(|(i, v)| if v.is_nan() { *v } else { i as f32 * 1e-3 }).collect();
        for extension in TWO_BAND_EXTENSIONS {
            let path = dir.path().join("dem").with_extension(extension);
            write_with_errors(&path, &dem, &errors, &RasterParams::default()).unwrap();
            let report = read_dem(&path).unwrap();
            let kinds: Vec<_> = report.findings.iter().map(|f| f.kind).collect();
            assert_eq!(kinds, [FindingKind::UnknownCrs], "nothing is left out of {extension}");
            let bits = |values: &[f32]| values.iter().map(|v| v.to_bits()).collect::<Vec<u32>>();
            assert!(bits(&report.value.dem.values) == bits(&dem.values), "{extension}");
            let read = read_standard_errors(&path).unwrap().unwrap();
            assert_eq!(read.grid, dem.grid);
            assert!(bits(&read.values) == bits(&errors), "{extension}");
            write_dem(&path, &dem).unwrap();
            assert_eq!(read_standard_errors(&path).unwrap(), None);
        }
        for extension in ["png", "asc", "xyz"] {
            let path = dir.path().join("dem").with_extension(extension);
            let error = write_with_errors(&path, &dem, &errors, &RasterParams::default()).unwrap_err().to_string();
            assert!(error.contains(".tif, .tiff, .exr") && !path.exists(), "{error}");
        }
        let short = write_with_errors(&dir.path().join("dem.tif"), &dem, &errors[1..], &RasterParams::default());
        assert!(matches!(short, Err(Error::Parameter(_))));
    }

    #[test]
    fn heights_in_feet_come_back_as_metres_from_every_format_that_states_them() {
        let dir = tempfile::tempdir().unwrap();
        // NAD83 / Arizona East (ft) + NAVD88 height (ft): a system that contradicts US survey feet.
        let dem = Dem { crs: Some(Crs::from_epsg(8700)), ..sample(20, 20) };
        for unit in [ElevationUnit::Foot, ElevationUnit::UsSurveyFoot] {
            let params = RasterParams { unit, ..RasterParams::default() };
            // XYZ has no place for the unit.
            for extension in READABLE_EXTENSIONS.into_iter().filter(|extension| *extension != "xyz") {
                let path = dir.path().join(format!("{}.{extension}", unit.symbol()));
                write_raster(&path, &dem, &params).unwrap();
                let read = read_dem(&path).unwrap();
                let kinds: Vec<FindingKind> = read.findings.iter().map(|finding| finding.kind).collect();
                assert_eq!(kinds, [FindingKind::HeightUnit], "{unit:?} {extension}");
                let close = |(a, b): (&f32, &f32)| (a.is_nan() && b.is_nan()) || (a - b).abs() <= 5e-3;
                assert!(read.value.dem.values.iter().zip(&dem.values).all(close), "{unit:?} {extension}");
                assert_eq!(read.value.dem.crs.and_then(|crs| crs.epsg), Some(2222), "{unit:?} {extension}");
                // Metres are nothing to tell of.
                let path = dir.path().join(format!("metres.{extension}"));
                write_dem(&path, &dem).unwrap();
                let read = read_dem(&path).unwrap();
                assert_eq!(read.value.dem.values.len(), 400);
                let told = read.findings.iter().find(|finding| finding.kind == FindingKind::HeightUnit);
                assert_eq!(told, None, "{unit:?} {extension}");
            }
        }
        for png in [PngEncoding::Gsi, PngEncoding::Terrarium, PngEncoding::Mapbox] {
            let params = RasterParams { unit: ElevationUnit::Foot, png, ..RasterParams::default() };
            assert!(write_raster(&dir.path().join("tile.png"), &dem, &params).is_err());
        }
    }

    #[test]
    fn a_missing_directory_and_a_full_disk_are_errors_with_the_path() {
        let dir = tempfile::tempdir().unwrap();
        for extension in DEM_EXTENSIONS {
            let path = dir.path().join("nowhere").join("dem").with_extension(extension);
            let error = write_dem(&path, &sample(4, 4)).unwrap_err();
            assert!(matches!(&error, Error::Io { action: "create", path: p, .. } if *p == path), "{error:?}");
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_the_systems_error() {
        let dir = tempfile::tempdir().unwrap();
        for extension in DEM_EXTENSIONS {
            let path = dir.path().join("dem").with_extension(extension);
            std::os::unix::fs::symlink("/dev/full", &path).unwrap();
            let error = write_dem(&path, &sample(300, 300)).unwrap_err();
            assert!(matches!(&error, Error::Io { action: "write", path: p, .. } if *p == path), "{error:?}");
        }
    }

    #[test]
    fn impossible_height_maps_are_refused() {
        let path = Path::new("dem.tif");
        let mut short = sample(4, 4);
        short.values.pop();
        let mut empty = sample(4, 4);
        (empty.grid.cols, empty.values) = (0, Vec::new());
        let mut flat = sample(4, 4);
        flat.grid.cell.y = 0.0;
        let mut lost = sample(4, 4);
        lost.grid.corner.x = f64::NAN;
        for dem in [short, empty, flat, lost] {
            assert!(matches!(write_dem(path, &dem), Err(Error::Parameter(_))));
        }
    }

    #[test]
    fn the_same_bytes_come_out_for_any_number_of_threads() {
        let dir = tempfile::tempdir().unwrap();
        let dem = sample(700, 600);
        for extension in DEM_EXTENSIONS {
            let bytes = [1, 4].map(|threads| {
                let path = dir.path().join(format!("{threads}.{extension}"));
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                pool.install(|| write_dem(&path, &dem)).unwrap();
                std::fs::read(path).unwrap()
            });
            assert!(bytes[0] == bytes[1], "{extension}");
        }
    }
}
