//! The keyword arguments, and the library's options that they stand for.
//!
//! The package's Python files fill in the defaults, so every key is there.

use std::collections::HashMap;
use std::path::PathBuf;

use pyo3::prelude::*;
use tokosen::base::ElevationUnit;
use tokosen::cartography::{MapParams, MapPlan, MapRequest, Steep};
use tokosen::contour::Interval;
use tokosen::contour::Target;
use tokosen::crs::{Crs, FromWorking};
use tokosen::drain::Drain;
use tokosen::features::{Role, Serves};
use tokosen::io::tiles::{HIGHEST_ZOOM, pixel_size};
use tokosen::surface::{SurfaceKind, Triangles, Uncertainty};
use tokosen::terrain::{Preparation, Repair};
use tokosen::tiles::WEB_MERCATOR;
use tokosen::{GridSpec, Options};

use crate::error::{exception, parameter};
use crate::raster::Raster;
use crate::source::{Source, crs};
use crate::unit::{one_of, tile_side, unit};

/// How contours are read and a surface is made. The names are those of the program's flags.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Given {
    pub elevation: Option<String>,
    pub layer: Option<String>,
    pub unit: Option<String>,
    pub plane_unit: Option<String>,
    pub depths: bool,
    pub crs: Option<String>,
    pub work_crs: Option<String>,
    pub snap: f64,
    pub repair: Option<String>,
    pub strict: bool,
    pub fit: Option<f64>,
    pub sample: Option<f64>,
    pub points: Option<Py<Source>>,
    pub points_sigma: Option<f64>,
    /// The sources in each role, by its name.
    pub features: HashMap<String, Vec<Py<Source>>>,
    pub sea: Option<f64>,
    pub coast_level: Option<f64>,
    pub stream_tolerance: Option<f64>,
    pub drain: String,
    pub frame: Frame,
    pub extend: bool,
    pub base: Option<HeightMap>,
    pub base_fade: Option<f64>,
    pub extent: Option<[f64; 4]>,
    pub extent_crs: Option<String>,
    pub clip: Option<Py<Source>>,
    pub surface: String,
    pub resolution: f64,
    pub tension: Option<f64>,
    pub noise: Option<f64>,
    pub uncertainty: bool,
}

/// Where the ground ends.
#[derive(FromPyObject)]
pub enum Frame {
    Named(String),
    Area(Py<Source>),
}

/// A height map.
#[derive(FromPyObject)]
pub enum HeightMap {
    InMemory(Py<Raster>),
    File(PathBuf),
}

/// The cells of a height map.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Cells {
    pub cell: Option<f64>,
    pub cell_degrees: Option<f64>,
    pub like: Option<HeightMap>,
    pub to_crs: Option<String>,
    pub max_zoom: Option<u8>,
    pub tile_size: usize,
}

impl Cells {
    /// The library's cells, if any are asked for.
    pub fn spec(&self, py: Python<'_>) -> PyResult<Option<GridSpec>> {
        let to_crs = crs(py, self.to_crs.as_deref())?;
        let given = [self.cell.is_some(), self.cell_degrees.is_some(), self.like.is_some(), self.max_zoom.is_some()];
        if given.iter().filter(|is_given| **is_given).count() > 1 {
            return Err(parameter(py, "give one of cell, cell_degrees, like and max_zoom"));
        }
        if let Some(zoom) = self.max_zoom {
            if zoom > HIGHEST_ZOOM {
                return Err(parameter(py, format!("max_zoom is {zoom}; it must be 0 to {HIGHEST_ZOOM}")));
            }
            if to_crs.is_some_and(|crs| crs.epsg != Some(WEB_MERCATOR)) {
                return Err(parameter(py, "with max_zoom, the height map is in Web Mercator (EPSG:3857)"));
            }
            let size = pixel_size(zoom, tile_side(py, self.tile_size)?);
            return Ok(Some(GridSpec::CellIn { size, crs: Crs::from_epsg(WEB_MERCATOR) }));
        }
        let name = || self.to_crs.as_deref().unwrap_or_default();
        let spec = match (self.cell, self.cell_degrees, &self.like, to_crs) {
            (_, _, Some(_), Some(_)) => return Err(parameter(py, "give either like or to_crs: the raster has a CRS")),
            (_, _, Some(HeightMap::InMemory(raster)), None) => {
                let (grid, crs) = raster.get().grid();
                GridSpec::Cells { grid, crs, file: None }
            }
            (_, _, Some(HeightMap::File(path)), None) => GridSpec::like(path).map_err(|error| exception(py, &error))?,
            (Some(_), _, _, Some(crs)) if crs.is_geographic() => {
                return Err(parameter(py, format!("{} is in degrees: give the size of cells as cell_degrees", name())));
            }
            (None, Some(_), _, Some(crs)) if !crs.is_geographic() => {
                return Err(parameter(py, format!("{} is not in degrees: give the size of cells as cell", name())));
            }
            (Some(size), _, _, Some(crs)) | (None, Some(size), _, Some(crs)) => GridSpec::CellIn { size, crs },
            (Some(size), _, _, None) => GridSpec::Cell(size),
            (None, Some(size), _, None) => GridSpec::Degrees(size),
            (None, None, None, _) => return Ok(None),
        };
        spec.check().map_err(|error| exception(py, &error))?;
        Ok(Some(spec))
    }

    /// The cells, which must be given.
    pub fn needed(&self, py: Python<'_>) -> PyResult<GridSpec> {
        self.spec(py)?.ok_or_else(|| parameter(py, "a height map needs cell, cell_degrees, like or max_zoom"))
    }
}

impl Given {
    /// The sources in a role.
    pub fn in_role(&self, role: Role) -> &[Py<Source>] {
        self.features.get(role.name()).map_or(&[], Vec::as_slice)
    }

    /// How the lines are prepared.
    pub fn preparation(&self, py: Python<'_>) -> PyResult<Preparation> {
        let repair = match self.repair.as_deref() {
            None | Some("safe") => Repair::Safe,
            Some("none") => Repair::None,
            Some("all") => Repair::All,
            Some(other) => return Err(one_of(py, "repair", other, "none, safe or all")),
        };
        Ok(Preparation { snap: self.snap, repair, strict: self.strict, fit: self.fit, sample: self.sample })
    }

    /// The kind of the surface.
    pub fn kind(&self, py: Python<'_>) -> PyResult<SurfaceKind> {
        let kinds = [SurfaceKind::Linear, SurfaceKind::Skeleton, SurfaceKind::Spline];
        let found = kinds.into_iter().find(|kind| kind.name() == self.surface);
        let found = found.ok_or_else(|| one_of(py, "surface", &self.surface, "linear, skeleton or spline"))?;
        let at_most = match found {
            SurfaceKind::Linear => Serves::Surface,
            SurfaceKind::Skeleton => Serves::Skeleton,
            SurfaceKind::Spline => Serves::Spline,
        };
        let numbers = [
            (self.resolution != 1.0, Serves::Skeleton, "resolution"),
            (self.tension.is_some(), Serves::Spline, "tension"),
            (self.noise.is_some(), Serves::Spline, "noise"),
            (self.drain != "safe", Serves::Spline, "drain"),
        ];
        let roles = Role::all().map(|role| (!self.in_role(role).is_empty(), role.serves(), role.name()));
        match numbers.into_iter().chain(roles).find(|(is_given, serves, _)| *is_given && *serves > at_most) {
            Some((_, _, name)) => Err(parameter(py, format!("{name} has no meaning for surface={:?}", self.surface))),
            None => Ok(found),
        }
    }

    /// The options of a terrain. `to_unit` is the unit of heights in them.
    pub fn options(
        &self,
        py: Python<'_>,
        grid: Option<GridSpec>,
        triangles: Triangles,
        to_unit: ElevationUnit,
    ) -> PyResult<Options> {
        let drain = match self.drain.as_str() {
            "none" => Drain::None,
            "safe" => Drain::Safe,
            "all" => Drain::All,
            other => return Err(one_of(py, "drain", other, "none, safe or all")),
        };
        if let Some(sea) = self.sea.filter(|sea| !sea.is_finite()) {
            return Err(parameter(py, format!("sea is {sea}, which is no elevation")));
        }
        let preparation = self.preparation(py)?;
        preparation.check().map_err(|error| exception(py, &error))?;
        Ok(Options {
            preparation,
            kind: self.kind(py)?,
            resolution: self.resolution,
            tension: self.tension,
            noise: self.noise,
            sea: self.sea.map(|level| to_unit.metres(level)),
            stream_tolerance: self.stream_tolerance,
            base_fade: self.base_fade,
            drain,
            grid,
            triangles,
            uncertainty: if self.uncertainty { Uncertainty::Learnt } else { Uncertainty::Unknown },
            memory: tokosen::cli::available_memory(),
            ..Options::default()
        })
    }
}

/// The levels of lines and of the areas between them, the coordinates and the unit that these are given in, and what is asked of
/// a map: the steps of supplementary contours, their spacing, the number of the scale, and whether lines are left out on steep
/// slopes.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Levels {
    intervals: Vec<f64>,
    levels: Option<Vec<f64>>,
    pub base_level: f64,
    to_crs: Option<String>,
    to_unit: String,
    to_depths: bool,
    pub index: u32,
    supplementary: Vec<f64>,
    supplementary_spacing: Option<f64>,
    scale: Option<f64>,
    thin: bool,
    /// The height of labels, if they are wanted; 0 for the usual one.
    pub labels: Option<f64>,
}

impl Levels {
    /// The levels: at each interval, or those that are given.
    pub fn targets(&self, py: Python<'_>) -> PyResult<Vec<Target>> {
        let base = self.base_level;
        if let Some(bad) = self.intervals.iter().find(|step| !(step.is_finite() && **step > 0.0)) {
            return Err(parameter(py, format!("the interval is {bad}, it must be more than 0")));
        }
        Ok(match &self.levels {
            Some(levels) => vec![Target::Levels(levels.clone())],
            None => self.intervals.iter().map(|&step| Interval { step, base, rounding: 0.0 }.into()).collect(),
        })
    }

    /// The unit of levels and heights.
    pub fn unit(&self, py: Python<'_>) -> PyResult<ElevationUnit> {
        unit(py, &self.to_unit)
    }

    /// The system of the coordinates, if it is named.
    pub fn crs(&self, py: Python<'_>) -> PyResult<Option<Crs>> {
        crs(py, self.to_crs.as_deref())
    }

    /// The conversion with the unit of heights, and with depths if they are wanted.
    pub fn heights_of(&self, py: Python<'_>, back: FromWorking) -> PyResult<FromWorking> {
        let back = back.with_heights_in(self.unit(py)?);
        Ok(if self.to_depths { back.with_depths() } else { back })
    }

    /// The plan for contours of a map, if one is asked for.
    pub fn map_plan(&self, py: Python<'_>) -> PyResult<Option<MapPlan>> {
        let request = MapRequest {
            targets: self.targets(py)?,
            unit: self.unit(py)?,
            index_every: self.index,
            supplementary: self.supplementary.clone(),
            spacing: self.supplementary_spacing,
            scale: self.scale,
            steep: if self.thin { Steep::Thin } else { Steep::Keep },
        };
        request.plan().map_err(|error| exception(py, &error))
    }
}

/// The parameters of a map. If its scale chooses the interval, the levels count from a base.
pub fn settled(plan: Option<MapPlan>, base: f64, slope: impl FnOnce() -> f64) -> Option<MapParams> {
    let mut params = plan?.settle(slope);
    if plan?.is_open() {
        params.kinds.interval.base = base;
    }
    Some(params)
}
