//! The two sides of a comparison: read, built, and brought onto one grid.

use std::path::{Path, PathBuf};

use glam::DVec2;
use serde::Serialize;
use tokosen::crs::Crs;
use tokosen::dem::compare::{height_at, heights_between};
use tokosen::dem::{Dem, Grid};
use tokosen::error::{Error, Finding};
use tokosen::io::raster::{READABLE_EXTENSIONS, read_dem};
use tokosen::io::{SpotHeights, VectorFormat};
use tokosen::surface::{Surface, Triangles, heights};

use super::CompareArgs;
use crate::cli::Failure;
use crate::cli::console::Console;
use crate::cli::output::{GridChoice, grid_for};
use crate::cli::surface::build_surface;

/// What a file holds, by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    Dem,
    Contours,
}

impl Format {
    pub fn of(path: &Path) -> Result<Self, Failure> {
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
        if READABLE_EXTENSIONS.contains(&extension.as_str()) {
            return Ok(Self::Dem);
        }
        match VectorFormat::from_path(path) {
            Ok(_) => Ok(Self::Contours),
            Err(_) => Err(Failure::Work(Error::file(
                path,
                format!(
                    "is neither a height map ({}) nor contour lines (.gpkg, .geojson, .json, .shp)",
                    READABLE_EXTENSIONS.map(|e| format!(".{e}")).join(", ")
                ),
            ))),
        }
    }
}

/// One side.
pub struct Side {
    pub source: Source,
    pub kind: Kind,
}

/// What the heights of a side come from.
pub enum Kind {
    Dem(Dem),
    Surface(Box<Surface>),
}

/// What a side is, for people and for `--json`.
#[derive(Debug, Clone, Serialize)]
pub struct Source {
    /// The file.
    pub file: PathBuf,
    /// `dem` or `contours`.
    pub kind: &'static str,
    /// Name of the coordinate reference system.
    pub crs: Option<String>,
    /// What it is made of.
    pub about: String,
}

impl Source {
    /// In one line.
    pub fn title(&self) -> String {
        let crs = self.crs.as_deref().unwrap_or("unknown coordinate reference system");
        format!("{}: {}, {crs}", self.file.display(), self.about)
    }
}

/// Both sides with their heights on one grid.
pub struct Pair {
    pub a: Side,
    pub b: Side,
    pub a_heights: Dem,
    pub b_heights: Dem,
    /// How they came onto it, in sentences.
    pub notes: Vec<String>,
}

/// Reads both sides and brings them onto one grid.
pub fn read(
    args: &CompareArgs,
    kinds: [Format; 2],
    findings: &mut Vec<Finding>,
    console: &Console,
) -> Result<Pair, Failure> {
    let (path_a, path_b) = (&args.input.contours, &args.b);
    // Height maps come first: the surface is drawn for their cells.
    let mut dem = |path: &Path, format: Format| -> Result<Option<Side>, Failure> {
        if format == Format::Contours {
            return Ok(None);
        }
        let read = console.step("reading", || read_dem(path))?;
        Ok(Some(side_of_dem(path, read.collect(findings).dem)))
    };
    let (dem_a, dem_b) = (dem(path_a, kinds[0])?, dem(path_b, kinds[1])?);
    let grid_of = |side: &Option<Side>| side.as_ref().and_then(Side::dem).map(|dem| (dem.grid, dem.crs.clone()));
    let asked = grid_of(&dem_b).or_else(|| grid_of(&dem_a));
    let b = match dem_b {
        Some(side) => side,
        None => side_of_contours(args, path_b, asked.as_ref(), findings, console)?,
    };
    let a = match dem_a {
        Some(side) => side,
        None => side_of_contours(args, path_a, asked.as_ref(), findings, console)?,
    };
    same_crs(path_a, a.crs(), b.crs())?;

    let mut notes = Vec::new();
    let grid = match &asked {
        Some((grid, _)) => *grid,
        None => {
            let surface = b.surface().or_else(|| a.surface());
            let choice = args.grid.choice(b.crs())?;
            surface.map(|surface| grid_for(&choice, surface)).transpose()?.unwrap_or(EMPTY)
        }
    };
    let on_grid = |side: &Side| match &side.kind {
        Kind::Dem(dem) if dem.grid == grid => dem.clone(),
        Kind::Dem(dem) => Dem { grid, values: heights_between(dem, &grid, &Some), crs: dem.crs.clone() },
        Kind::Surface(surface) => heights(surface, &grid, console),
    };
    let (a_heights, b_heights) = (on_grid(&a), on_grid(&b));
    notes.push(match (&a.kind, &b.kind) {
        (Kind::Surface(_), Kind::Dem(_)) => "The surface of A is evaluated at the cell centres of B.".into(),
        (Kind::Dem(_), Kind::Surface(_)) => "The surface of B is evaluated at the cell centres of A.".into(),
        (Kind::Surface(_), Kind::Surface(_)) => {
            format!("Both surfaces are evaluated at the centres of cells of {} x {}.", grid.cell.x, grid.cell.y)
        }
        (Kind::Dem(dem), Kind::Dem(_)) if dem.grid == grid => "Both have the same cells.".into(),
        (Kind::Dem(_), Kind::Dem(_)) => {
            "A is on another grid: it is interpolated (bilinear) at the cell centres of B, which stays as it is.".into()
        }
    });
    Ok(Pair { a, b, a_heights, b_heights, notes })
}

const EMPTY: Grid = Grid { corner: DVec2::ZERO, cell: DVec2::ONE, cols: 0, rows: 0 };

impl Side {
    pub fn surface(&self) -> Option<&Surface> {
        match &self.kind {
            Kind::Surface(surface) => Some(surface),
            Kind::Dem(_) => None,
        }
    }

    fn dem(&self) -> Option<&Dem> {
        match &self.kind {
            Kind::Dem(dem) => Some(dem),
            Kind::Surface(_) => None,
        }
    }

    fn crs(&self) -> Option<&Crs> {
        match &self.kind {
            Kind::Dem(dem) => dem.crs.as_ref(),
            Kind::Surface(surface) => surface.map.crs.as_ref(),
        }
    }

    /// Heights at check points, NaN where there are none.
    pub fn at(&self, checks: &SpotHeights) -> Vec<f64> {
        let height = |p: DVec2| match &self.kind {
            Kind::Dem(dem) => height_at(dem, p),
            Kind::Surface(surface) => {
                let grid = Grid { corner: p + DVec2::new(-0.5, 0.5), cell: DVec2::ONE, cols: 1, rows: 1 };
                heights(surface, &grid, &()).values[0].into()
            }
        };
        checks.points.iter().map(|p| height(p.truncate())).collect()
    }
}

fn side_of_dem(path: &Path, dem: Dem) -> Side {
    let Grid { cols, rows, cell, .. } = dem.grid;
    let source = Source {
        file: path.to_owned(),
        kind: "dem",
        crs: dem.crs.as_ref().and_then(Crs::name),
        about: format!("height map, {cols} x {rows} cells of {} x {}", plain(cell.x), plain(cell.y)),
    };
    Side { source, kind: Kind::Dem(dem) }
}

/// A size to twelve digits, which is more than it means.
fn plain(size: f64) -> f64 {
    format!("{size:.11e}").parse().unwrap_or(size)
}

fn side_of_contours(
    args: &CompareArgs,
    path: &Path,
    asked: Option<&(Grid, Option<Crs>)>,
    findings: &mut Vec<Finding>,
    console: &Console,
) -> Result<Side, Failure> {
    // Check points must not be known to the surface that they check.
    let reading = crate::cli::input::InputArgs { contours: path.to_owned(), points: None, ..args.input.clone() };
    let mut input = reading.read(console)?;
    let choice = match asked {
        Some((grid, crs)) => {
            same_crs(path, input.map.crs.as_ref(), crs.as_ref())?;
            GridChoice::Like(*grid)
        }
        None => args.grid.choice(input.map.crs.as_ref())?,
    };
    let params = args.surface.params(&input.map, Some(&choice), Triangles::Guide)?;
    let surface = build_surface(input.map, &params, &mut input.findings, console)?;
    reading.check_strict(&input.findings, console)?;
    findings.append(&mut input.findings);
    let source = Source {
        file: path.to_owned(),
        kind: "contours",
        crs: surface.map.crs.as_ref().and_then(Crs::name),
        about: format!(
            "surface ({}) of {} contours, interval {} m",
            args.surface.surface.name(),
            surface.map.contours.len(),
            surface.interval.step
        ),
    };
    Ok(Side { source, kind: Kind::Surface(Box::new(surface)) })
}

fn same_crs(path: &Path, a: Option<&Crs>, b: Option<&Crs>) -> Result<(), Failure> {
    if let (Some(a), Some(b)) = (a, b)
        && !a.matches(b)
    {
        let message = "is in another coordinate reference system than what it is compared with; reproject one of them";
        return Err(Failure::Work(Error::file(path, message)));
    }
    Ok(())
}
