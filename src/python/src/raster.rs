//! Values on a grid of cells, as a numpy array with its place.

use std::path::{Path, PathBuf};

use glam::DVec2;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use tokosen::Interval;
use tokosen::base::Grid;
use tokosen::base::Units;
use tokosen::base::error::Finding;
use tokosen::cli::available_memory;
use tokosen::dem::volume::Heights;
use tokosen::draw::Scene;
use tokosen::io::raster::{
    DEM_EXTENSIONS, PngEncoding, Quantity, RasterParams, TWO_BAND_EXTENSIONS, TiffLayout, picture_bytes, read_dem,
    read_shift_grid, write_raster, write_shade, write_with_errors,
};
use tokosen::io::tiles::{TileFormat, TileImage};
use tokosen::io::{StagedOutput, check_paths};
use tokosen::raster::{Dem, ShiftWay};
use tokosen::terrain::{DemModel, HtmlParams};

use crate::error::Warned;
use crate::error::{exception, parameter};
use crate::layer::crs_text;
use crate::model::Model;
use crate::source::crs;
use crate::tiles::{Tiling, terrain_tiles};
use crate::unit::{one_of, tile_side, unit};
use crate::work::work;

/// How a raster is written.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Format {
    to_unit: String,
    cog: bool,
    png_encoding: Option<String>,
    tile_size: usize,
    tile_image: String,
}

/// Values on a grid.
#[pyclass(frozen, module = "tokosen._tokosen")]
pub struct Raster {
    grid: Grid,
    crs: Option<tokosen::crs::Crs>,
    quantity: Quantity,
    #[pyo3(get)]
    values: Py<PyArray2<f32>>,
    #[pyo3(get)]
    error: Option<Py<PyArray2<f32>>>,
    /// What was noticed when it was read or made.
    #[pyo3(get)]
    notes: Vec<String>,
}

impl Raster {
    /// A raster; its values are moved into an array of numpy.
    pub fn new(
        py: Python<'_>,
        dem: Dem,
        errors: Option<Vec<f32>>,
        quantity: Quantity,
        findings: &[Finding],
    ) -> PyResult<Self> {
        let Dem { grid, values, crs } = dem;
        let array = |values: Vec<f32>| -> PyResult<Py<PyArray2<f32>>> {
            Ok(PyArray1::from_vec(py, values).reshape([grid.rows, grid.cols])?.unbind())
        };
        let notes = findings.iter().map(|finding| finding.with_place_in_words().message).collect();
        Ok(Self { grid, crs, quantity, values: array(values)?, error: errors.map(array).transpose()?, notes })
    }

    /// The cells.
    pub fn grid(&self) -> (Grid, Option<tokosen::crs::Crs>) {
        (self.grid, self.crs.clone())
    }

    /// The heights in the library's form, for models. Other values are refused.
    fn heights(&self, py: Python<'_>) -> PyResult<Dem> {
        match self.quantity {
            Quantity::Height => self.dem(py),
            other => Err(parameter(py, format!("the values are {}; models are made of heights", other.name()))),
        }
    }

    /// The values in the library's form. They are copied.
    pub fn dem(&self, py: Python<'_>) -> PyResult<Dem> {
        Ok(Dem { grid: self.grid, values: copied(py, &self.values)?, crs: self.crs.clone() })
    }
}

/// The values of an array, row by row.
fn copied(py: Python<'_>, array: &Py<PyArray2<f32>>) -> PyResult<Vec<f32>> {
    Ok(array.bind(py).try_readonly()?.as_array().iter().copied().collect())
}

#[pymethods]
impl Raster {
    /// A height map from an array (rows, columns), metres, north up; the transform is that of rasterio: (a, b, c, d, e, f).
    #[staticmethod]
    #[pyo3(signature = (values, transform, crs))]
    fn from_array(
        py: Python<'_>,
        values: Bound<'_, PyArray2<f32>>,
        transform: [f64; 6],
        crs: Option<&str>,
    ) -> PyResult<Self> {
        let [width, skew_x, west, skew_y, height, north] = transform;
        if !transform.iter().all(|v| v.is_finite()) || skew_x != 0.0 || skew_y != 0.0 || width <= 0.0 || height >= 0.0 {
            let shown = transform.map(|v| v.to_string()).join(", ");
            return Err(parameter(py, format!("the transform ({shown}) is not that of a grid with north up")));
        }
        let crs = self::crs(py, crs)?;
        let values = values.try_readonly()?;
        let values = values.as_array();
        let (rows, cols) = values.dim();
        if rows == 0 || cols == 0 {
            return Err(parameter(py, "the height map has no cells"));
        }
        let grid = Grid { corner: DVec2::new(west, north), cell: DVec2::new(width, -height), cols, rows };
        let values = values.iter().map(|v| if v.is_finite() { *v } else { f32::NAN }).collect();
        Self::new(py, Dem { grid, values, crs }, None, Quantity::Height, &[])
    }

    /// A raster from what [`Raster::state`] gave.
    #[staticmethod]
    fn restore(
        py: Python<'_>,
        arrays: (Bound<'_, PyArray2<f32>>, Option<Bound<'_, PyArray2<f32>>>),
        transform: [f64; 6],
        crs: Option<&str>,
        quantity: &str,
        notes: Vec<String>,
    ) -> PyResult<Self> {
        let (values, error) = arrays;
        let quantity = Quantity::ALL.into_iter().find(|known| known.name() == quantity);
        let quantity = quantity.ok_or_else(|| parameter(py, "the raster holds an unknown quantity"))?;
        let crs = self::crs(py, crs)?;
        let [rows, cols] = [values.shape()[0], values.shape()[1]];
        let [width, _, west, _, height, north] = transform;
        let grid = Grid { corner: DVec2::new(west, north), cell: DVec2::new(width, -height), cols, rows };
        Ok(Self { grid, crs, quantity, values: values.unbind(), error: error.map(Bound::unbind), notes })
    }

    /// What the raster consists of, for pickle.
    #[allow(clippy::type_complexity, reason = "a tuple of what Python gets")]
    fn state(
        &self,
        py: Python<'_>,
    ) -> ((Py<PyArray2<f32>>, Option<Py<PyArray2<f32>>>), [f64; 6], Option<String>, &'static str, Vec<String>) {
        let error = self.error.as_ref().map(|error| error.clone_ref(py));
        let arrays = (self.values.clone_ref(py), error);
        (arrays, self.transform(), self.crs(), self.quantity.name(), self.notes.clone())
    }

    /// A height map from a file.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let read = py.detach(|| read_dem(&path)).map_err(|error| exception(py, &error))?;
        Self::new(py, read.value.dem, None, Quantity::Height, &read.findings)
    }

    #[getter]
    fn transform(&self) -> [f64; 6] {
        let Grid { corner, cell, .. } = self.grid;
        [cell.x, 0.0, corner.x, 0.0, -cell.y, corner.y]
    }

    #[getter]
    fn crs(&self) -> Option<String> {
        self.crs.as_ref().and_then(crs_text)
    }

    #[getter]
    fn quantity(&self) -> &'static str {
        self.quantity.name()
    }

    /// The heights with the values of a grid of shifts added, or taken off.
    fn shifted(&self, py: Python<'_>, grid: PathBuf, inverse: bool) -> PyResult<Self> {
        if self.quantity != Quantity::Height {
            return Err(parameter(py, format!("the values are {}; heights can be shifted", self.quantity.name())));
        }
        let (mut dem, way) = (self.dem(py)?, if inverse { ShiftWay::Subtract } else { ShiftWay::Add });
        let errors = self.error.as_ref().map(|error| copied(py, error)).transpose()?;
        let findings = work(py, None, |_| read_shift_grid(&grid)?.shift(&mut dem, way));
        let findings = findings?;
        Self::new(py, dem, errors, Quantity::Height, &findings)
    }

    /// Volumes above and below levels, or those between this height map and another one on the same cells: for each, the level,
    /// cut, fill, their areas, and the greatest error of the net volume.
    #[pyo3(signature = (levels, other, sigma))]
    fn volume(
        &self,
        py: Python<'_>,
        levels: Vec<f64>,
        other: Option<PyRef<'_, Raster>>,
        sigma: Option<f64>,
    ) -> PyResult<Vec<[f64; 6]>> {
        let dem = self.dem(py)?;
        let other = other.map(|other| other.dem(py)).transpose()?;
        let own = self.error.as_ref().map(|error| copied(py, error)).transpose()?;
        let errors = sigma.map(|sigma| vec![sigma as f32; dem.values.len()]).or(own);
        work(py, None, |_| {
            let heights = match &other {
                Some(other) => Heights::between(&dem, other, errors.as_deref(), None)?,
                None => Heights::of(&dem, errors.as_deref(), None)?,
            };
            let row = |level: &f64| {
                let found = heights.at(*level);
                let most = found.errors.map_or(f64::NAN, |errors| errors[2].most);
                [found.level, found.cut, found.fill, found.cut_area, found.fill_area, most]
            };
            Ok(levels.iter().map(row).collect())
        })
    }

    /// A 3-D model; a solid if the height of its bottom is given.
    #[pyo3(signature = (base, tolerance, progress))]
    fn mesh(
        &self,
        py: Python<'_>,
        base: Option<f64>,
        tolerance: Option<f64>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Model> {
        let dem = self.heights(py)?;
        work(py, progress, |_| {
            let model = DemModel::new(dem, None, available_memory())?;
            let shell = model.mesh(tolerance)?;
            let mesh = if let Some(base) = base { shell.closed(base)? } else { shell };
            Ok(mesh.in_drawing(&model.reprojection).unwrap_or(mesh))
        })
        .map(Model)
    }

    /// A page that shows the heights in 3-D.
    #[pyo3(signature = (title, interval, tolerance, cell, progress))]
    fn html(
        &self,
        py: Python<'_>,
        title: String,
        interval: Option<f64>,
        tolerance: Option<f64>,
        cell: Option<f64>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<String> {
        let target = interval.map(|step| Interval::every(step).into());
        let params = HtmlParams { title, target, tolerance, cell, ..HtmlParams::default() };
        let dem = self.heights(py)?;
        work(py, progress, |progress| DemModel::new(dem, None, available_memory())?.to_html(&params, progress))
    }

    /// A picture of a height map, as PNG.
    fn picture(&self, py: Python<'_>) -> PyResult<Vec<u8>> {
        let dem = self.dem(py)?;
        work(py, None, |_| picture_bytes(&Scene::of_height_map(&dem, &[], Units::METRES).image()?))
    }

    /// Writes the raster. Gives what to warn of.
    fn write(&self, py: Python<'_>, path: PathBuf, format: Format, tiling: Tiling) -> PyResult<Option<Warned>> {
        let is_tiles = TileFormat::of(&path).is_some();
        let png = match format.png_encoding.as_deref() {
            None if is_tiles => PngEncoding::Terrarium,
            None | Some("gray16") => PngEncoding::Gray16,
            Some("gsi") => PngEncoding::Gsi,
            Some("terrarium") => PngEncoding::Terrarium,
            Some("mapbox") => PngEncoding::Mapbox,
            Some(other) => return Err(one_of(py, "png_encoding", other, "gray16, gsi, terrarium or mapbox")),
        };
        let heights_in = unit(py, &format.to_unit)?;
        if is_tiles {
            let image = match format.tile_image.as_str() {
                "png" => TileImage::Png,
                "webp" => TileImage::Webp,
                other => return Err(one_of(py, "tile_image", other, "png or webp")),
            };
            if self.quantity != Quantity::Height || heights_in.is_foot() {
                return Err(parameter(py, "terrain tiles hold heights in metres only"));
            }
            let (dem, layout) = (self.dem(py)?, (tile_side(py, format.tile_size)?, image));
            return work(py, None, |progress| terrain_tiles(&dem, &path, layout, png, tiling, progress));
        }
        tiling.check_no_tiles(&path).map_err(|error| exception(py, &error))?;
        let overwrite = tiling.overwrite;
        let tiff = if format.cog { TiffLayout::CloudOptimized } else { TiffLayout::Plain };
        let params = RasterParams { quantity: self.quantity, png, tiff, unit: heights_in };
        let dem = self.dem(py)?;
        let errors = self.error.as_ref().map(|error| copied(py, error)).transpose()?;
        let known = if errors.is_some() { TWO_BAND_EXTENSIONS.as_slice() } else { DEM_EXTENSIONS.as_slice() };
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
        if !known.contains(&extension.as_str()) {
            let known: Vec<String> = known.iter().map(|e| format!(".{e}")).collect();
            let what = if errors.is_some() { "height maps with standard errors" } else { "height maps" };
            return Err(parameter(py, format!("{}: {what} are written as {}", path.display(), known.join(", "))));
        }
        let written = py.detach(|| write(&path, &dem, errors.as_deref(), &params, overwrite));
        written.map(|()| None).map_err(|error| exception(py, &error))
    }
}

fn write(
    path: &Path,
    dem: &Dem,
    errors: Option<&[f32]>,
    params: &RasterParams,
    overwrite: bool,
) -> tokosen::Result<()> {
    check_paths(&[], &[path.into()], overwrite)?;
    let staged = StagedOutput::create(path)?;
    let is_picture = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("png"));
    let written = match (errors, params.quantity) {
        (Some(errors), _) => write_with_errors(&staged.path(), dem, errors, params),
        (None, Quantity::Shade) if is_picture => write_shade(&staged.path(), dem),
        (None, _) => write_raster(&staged.path(), dem, params),
    };
    written.map_err(|error| staged.with_final_name(error))?;
    staged.commit()?;
    Ok(())
}
