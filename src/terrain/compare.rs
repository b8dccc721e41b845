//! The two sides of a comparison, brought onto one grid.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use geo::MultiPolygon;
use glam::DVec2;
use serde::Serialize;

use super::facade::Terrain;
use tokosen_core::base::error::{Error, Finding, Result};
use tokosen_core::base::progress::{Progress, step};
use tokosen_core::base::{ElevationUnit, Grid, Units};
use tokosen_core::contour::{Interval, SpotHeights};
use tokosen_core::crs::{Crs, HeightSystem, Reprojection, Transform, converted};
use tokosen_core::dem::compare::{Resampled, heights_between};
use tokosen_core::raster::{Dem, RasterRows, ShiftGrid, ShiftWay, WithCrs, looks_like_degrees, mask, metres_per_unit};
use tokosen_core::surface::{InOther, Surface, SurfaceKind, height_map};

/// One side of a comparison.
#[derive(Debug)]
pub struct Side {
    /// Its description.
    pub source: SideSource,
    /// What its heights come from.
    pub kind: Kind,
    /// Stated accuracy of the product, as a standard deviation, metres.
    pub sigma: Option<f64>,
    /// The standard errors that a height map has beside its heights, metres, if they were read.
    pub errors: Option<Arc<Dem>>,
    /// The unit that the elevations of contours had. `None` for a height map.
    pub unit: Option<ElevationUnit>,
    /// The height system, if the file names one.
    pub height_system: Option<HeightSystem>,
    /// The part of the surface that is compared, if it is not the whole.
    pub(super) part: Option<MultiPolygon<f64>>,
    /// The conversion between the plane of the surface and the coordinates of its contours.
    pub(super) reprojection: Option<Reprojection>,
}

/// What the heights of a side come from.
#[derive(Debug)]
pub enum Kind {
    /// A height map.
    Dem(Arc<dyn RasterRows>),
    /// The surface between contours.
    Surface(Box<Surface>),
}

/// The description of a side, for reports and for JSON.
#[derive(Debug, Clone, Serialize)]
pub struct SideSource {
    /// The file.
    pub file: PathBuf,
    /// `dem` or `contours`.
    pub kind: &'static str,
    /// Name of the coordinate reference system.
    pub crs: Option<String>,
    /// Its contents, in words.
    pub about: String,
}

impl SideSource {
    /// The description in one line.
    pub fn title(&self) -> String {
        let crs = self.crs.as_deref().unwrap_or("unknown coordinate reference system");
        format!("{}: {}, {crs}", self.file.display(), self.about)
    }
}

/// Both sides with their heights on one grid.
#[derive(Debug)]
pub struct Pair {
    /// The side that is compared.
    pub a: Side,
    /// The reference.
    pub b: Side,
    /// The heights of A.
    pub a_heights: Arc<dyn RasterRows>,
    /// The heights of B, on the same grid.
    pub b_heights: Arc<dyn RasterRows>,
    /// How they were brought onto it, in sentences.
    pub notes: Vec<String>,
}

/// The cells that heights are compared at, and the system that they are in.
pub type Nodes = (Grid, Option<Crs>);

impl Pair {
    /// Refuses cells that look like degrees if neither side names a coordinate reference system.
    ///
    /// # Errors
    /// If the coordinates look like degrees and no system is named. The error names `path`.
    pub fn refuse_degrees((grid, crs): &Nodes, path: &Path) -> Result<()> {
        if !looks_like_degrees(grid, crs.as_ref()) {
            return Ok(());
        }
        let message = "the coordinates look like degrees, but no file names a system; name it first, for \
                       example with 'gdal_translate -a_srs EPSG:6668'";
        Err(Error::file(path, message))
    }

    /// Both at the cells of a grid in some system.
    ///
    /// # Errors
    /// If the grid's system cannot be converted to that of a side. The error names the side's file.
    pub fn on(a: Side, b: Side, (grid, crs): Nodes, progress: &dyn Progress) -> Result<Self> {
        // A height map without a system is in the coordinates of the contours.
        let crs =
            crs.or_else(|| [&b, &a].into_iter().find_map(|side| side.reprojection.as_ref()?.input_crs().cloned()));
        let mut notes = vec![note(&a, &b, &grid)];
        if let Some(name) = crs.as_ref().and_then(Crs::name) {
            let nameless = [("A", &a), ("B", &b)].into_iter().filter(|(_, side)| side.crs().is_none());
            notes.extend(nameless.map(|(letter, _)| {
                format!("{letter} names no coordinate reference system: it is taken to be in {name}.")
            }));
        }
        let a_heights = a.on(&grid, crs.as_ref(), progress)?;
        let b_heights = b.on(&grid, crs.as_ref(), progress)?;
        Ok(Self { a, b, a_heights, b_heights, notes })
    }

    /// The surface of a side, that of B first.
    pub fn surface(&self) -> Option<&Surface> {
        self.side_with_surface().map(|(_, surface)| surface)
    }

    /// The side that is a surface, B first.
    pub(super) fn side_with_surface(&self) -> Option<(&Side, &Surface)> {
        [&self.b, &self.a].into_iter().find_map(|side| Some((side, side.surface()?)))
    }

    /// Metres on the ground per unit of the grid's system, in x and y.
    pub fn metres_per_unit(&self) -> DVec2 {
        metres_per_unit(&self.b_heights.grid(), self.b_heights.crs()).unwrap_or(DVec2::ONE)
    }

    /// The unit that the elevations of contours had, those of B first; metres for two height maps.
    pub fn unit(&self) -> ElevationUnit {
        self.b.unit.or(self.a.unit).unwrap_or_default()
    }

    /// The vertical interval of the contours, if a side is made from contours.
    pub fn interval(&self) -> Option<Interval> {
        self.surface().map(|surface| surface.interval)
    }
}

fn note(a: &Side, b: &Side, grid: &Grid) -> String {
    match (&a.kind, &b.kind) {
        (Kind::Surface(_), Kind::Dem(_)) => "The surface of A is evaluated at the cell centres of B.".into(),
        (Kind::Dem(_), Kind::Surface(_)) => "The surface of B is evaluated at the cell centres of A.".into(),
        (Kind::Surface(_), Kind::Surface(_)) => {
            let [x, y] = [plain(grid.cell.x), plain(grid.cell.y)];
            format!("Both surfaces are evaluated at the centres of cells of {x} x {y}.")
        }
        (Kind::Dem(dem), Kind::Dem(_)) if dem.grid() == *grid => "Both have the same cells.".into(),
        (Kind::Dem(_), Kind::Dem(_)) => {
            "A is on another grid: it is interpolated (bilinear) at the cell centres of B, which stays as it is.".into()
        }
    }
}

impl Side {
    /// A height map from a file. `product` is the name of a known product and its stated accuracy (a standard
    /// deviation, metres).
    pub fn of_dem(path: &Path, dem: Arc<dyn RasterRows>, product: Option<(&str, f64)>) -> Self {
        let name = product.map_or("height map", |(name, _)| name);
        let Grid { cols, rows, cell, .. } = dem.grid();
        let is_degrees = dem.crs().is_some_and(Crs::is_geographic);
        let (factor, unit) = if is_degrees { (3600.0, " seconds of arc") } else { (1.0, "") };
        let [x, y] = [plain(cell.x * factor), plain(cell.y * factor)];
        let source = SideSource {
            file: path.to_owned(),
            kind: "dem",
            crs: dem.crs().and_then(Crs::name),
            about: format!("{name}, {cols} x {rows} cells of {x} x {y}{unit}"),
        };
        let dem_system = dem.crs().and_then(Crs::height_system);
        Self {
            source,
            kind: Kind::Dem(dem),
            sigma: product.map(|(_, sigma)| sigma),
            errors: None,
            unit: None,
            height_system: dem_system,
            part: None,
            reprojection: None,
        }
    }

    /// The surface of the contours in a file.
    pub fn of_terrain(path: &Path, kind: SurfaceKind, terrain: Terrain) -> Self {
        let Terrain { surface, reprojection, unit, part, .. } = terrain;
        let (count, interval) = (surface.map.contours.len(), surface.interval.step);
        let source = SideSource {
            file: path.to_owned(),
            kind: "contours",
            crs: reprojection.input_crs().and_then(Crs::name),
            about: format!(
                "surface ({}) of {count} contours, interval {}",
                kind.name(),
                Units::all(unit).height(interval)
            ),
        };
        let height_system = surface.map.height_system.clone();
        let (kind, reprojection) = (Kind::Surface(Box::new(surface)), Some(reprojection));
        Self { source, kind, sigma: None, errors: None, unit: Some(unit), height_system, part, reprojection }
    }

    /// Shifts the heights of a height map by a grid. A surface stays as it is.
    ///
    /// # Errors
    /// As [`ShiftGrid::shift`]. If the file cannot be read.
    pub fn shift(&mut self, grid: &ShiftGrid, way: ShiftWay) -> Result<Vec<Finding>> {
        let Kind::Dem(rows) = &self.kind else { return Ok(Vec::new()) };
        let mut dem = rows.whole()?.into_owned();
        let mut findings = rows.findings();
        findings.extend(grid.shift(&mut dem, way).map_err(|error| error.in_file(&self.source.file))?);
        self.height_system = dem.crs.as_ref().and_then(Crs::height_system);
        self.source.crs = dem.crs.as_ref().and_then(Crs::name);
        self.kind = Kind::Dem(Arc::new(dem));
        Ok(findings)
    }

    /// The surface, if the side is one.
    pub fn surface(&self) -> Option<&Surface> {
        match &self.kind {
            Kind::Surface(surface) => Some(surface),
            Kind::Dem(_) => None,
        }
    }

    /// The cells of a height map.
    pub fn nodes(&self) -> Option<Nodes> {
        match &self.kind {
            Kind::Dem(dem) => Some((dem.grid(), dem.crs().cloned())),
            Kind::Surface(_) => None,
        }
    }

    /// The system that the heights are in: for contours the working one.
    pub fn crs(&self) -> Option<&Crs> {
        match &self.kind {
            Kind::Dem(dem) => dem.crs(),
            Kind::Surface(surface) => surface.map.crs.as_ref(),
        }
    }

    /// The conversion from some system to that of the heights; `None` if coordinates are the same in both, or if one is not
    /// known. `path` is named in the error.
    pub(super) fn transform_from(&self, crs: Option<&Crs>, path: &Path) -> Result<Option<Transform>> {
        let crs = self.reprojection.as_ref().map_or(crs, |reprojection| reprojection.of_side(crs));
        Transform::between_known(crs, self.crs()).map_err(|error| error.in_file(path))
    }

    /// Heights at the cell centres of a grid in some system. Those of a height map are computed when they are read, as far as no
    /// coordinates have to be transformed.
    pub(super) fn on(&self, grid: &Grid, crs: Option<&Crs>, progress: &dyn Progress) -> Result<Arc<dyn RasterRows>> {
        let transform = self.transform_from(crs, &self.source.file)?;
        let surface = match &self.kind {
            Kind::Surface(surface) => surface,
            Kind::Dem(dem) if transform.is_none() && dem.grid() == *grid && dem.crs() == crs => return Ok(dem.clone()),
            Kind::Dem(dem) if transform.is_none() && dem.grid() == *grid => {
                return Ok(Arc::new(WithCrs { rows: dem.clone(), crs: crs.cloned() }));
            }
            Kind::Dem(dem) if transform.is_none() => {
                return Ok(Arc::new(Resampled { source: dem.clone(), grid: *grid, crs: crs.cloned() }));
            }
            Kind::Dem(dem) => {
                let dem = dem.whole()?;
                let to_side = |p: DVec2| converted(transform.as_ref(), p);
                let values = step(progress, "interpolating", || heights_between(&dem, grid, &to_side));
                return Ok(Arc::new(Dem { grid: *grid, values, crs: crs.cloned() }));
            }
        };
        let to_side = |p: DVec2| converted(transform.as_ref(), p);
        let from_side = |p: DVec2| transform.as_ref().map_or(Some(p), |transform| transform.inverse(p));
        let other = InOther { to_surface: &to_side, from_surface: &from_side };
        let mut dem = height_map(surface, grid, crs, transform.is_some().then_some(other), progress);
        if let Some(area) = &self.part {
            mask(&mut dem, area, &to_side);
        }
        Ok(Arc::new(dem))
    }

    /// Heights at check points, NaN where there are none. `path` is the file of the points, for the error.
    pub(super) fn at(&self, path: &Path, checks: &SpotHeights) -> Result<Vec<f64>> {
        let places: Vec<DVec2> = checks.points.iter().map(|point| point.truncate()).collect();
        Ok(self.sample(&places, checks.crs.as_ref(), path)?.into_iter().map(|sample| sample.height).collect())
    }
}

/// A size to nine digits, because later digits are rounding errors of a division.
fn plain(size: f64) -> f64 {
    format!("{size:.8e}").parse().unwrap_or(size)
}
