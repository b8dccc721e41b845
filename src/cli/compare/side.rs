//! The two sides of a comparison: read, built, and brought onto one grid.

use std::path::{Path, PathBuf};

use glam::DVec2;
use serde::Serialize;
use tokosen::base::Grid;
use tokosen::base::error::{Error, Finding};
use tokosen::crs::{Crs, Transform};
use tokosen::dem::compare::{height_at, heights_between};
use tokosen::dem::{Dem, looks_like_degrees};
use tokosen::io::raster::{DemFile, read_dem};
use tokosen::io::{Content, SpotHeights};
use tokosen::surface::{Surface, Triangles, heights, heights_on};

use super::CompareArgs;
use crate::cli::Failure;
use crate::cli::console::Console;
use crate::cli::input::InputArgs;
use crate::cli::map::MapArgs;
use crate::cli::output::{GridChoice, grid_for};
use crate::cli::surface::{KindArg, build_surface};

/// One side.
pub struct Side {
    pub source: Source,
    pub kind: Kind,
    /// Stated accuracy of the product, as a standard deviation, metres.
    pub sigma: Option<f64>,
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

/// The cells that heights are compared at, and the system that they are in.
pub type Nodes = (Grid, Option<Crs>);

/// Reads both sides and brings them onto one grid.
pub fn read(
    args: &CompareArgs,
    contents: [Content; 2],
    findings: &mut Vec<Finding>,
    console: &Console,
) -> Result<Pair, Failure> {
    let (path_a, path_b) = (&args.input.map.contours, &args.b);
    // Height maps come first: the surface is drawn for their cells.
    let dem = |path: &Path, content: Content, findings: &mut Vec<Finding>| -> Result<Option<Side>, Failure> {
        if content == Content::Contours {
            return Ok(None);
        }
        Side::of_height_map(path, findings, console).map(Some)
    };
    let mut known = 0;
    let mut label = |side: &str, findings: &mut Vec<Finding>| {
        findings[known..].iter_mut().for_each(|finding| finding.message = format!("{side}: {}", finding.message));
        known = findings.len();
    };
    let dem_a = dem(path_a, contents[0], findings)?;
    label("A", findings);
    let dem_b = dem(path_b, contents[1], findings)?;
    label("B", findings);
    let crs_of = |side: &Option<Side>| side.as_ref().and_then(Side::crs).cloned();
    let nodes_of = |side: &Option<Side>| side.as_ref().and_then(Side::nodes).map(|(grid, _)| grid);
    // A height map that names no system is taken for one in that of the other side.
    let crs = crs_of(&dem_b).or_else(|| crs_of(&dem_a));
    let mut nodes = nodes_of(&dem_b).or_else(|| nodes_of(&dem_a)).map(|grid| (grid, crs));
    let b = match dem_b {
        Some(side) => side,
        None => side_of_contours(args, path_b, &mut nodes, findings, console)?,
    };
    label("B", findings);
    let a = match dem_a {
        Some(side) => side,
        None => side_of_contours(args, path_a, &mut nodes, findings, console)?,
    };
    label("A", findings);
    let Some((grid, crs)) = nodes else {
        return Err(Failure::Usage("two surfaces are compared on a grid: give --cell SIZE or --like RASTER".into()));
    };
    if looks_like_degrees(&grid, crs.as_ref()) {
        let message = "the coordinates look like degrees, and neither A nor B says so; name the system first, for example \
                       with 'gdal_translate -a_srs EPSG:6668'";
        return Err(Failure::Work(Error::file(path_b, message)));
    }
    Pair::on(a, b, (grid, crs), console)
}

impl Pair {
    /// Both at the cells of a grid in some system.
    pub fn on(a: Side, b: Side, (grid, crs): Nodes, console: &Console) -> Result<Self, Failure> {
        let mut notes = vec![note(&a, &b, &grid)];
        if let Some(name) = crs.as_ref().and_then(Crs::name) {
            let nameless = [("A", &a), ("B", &b)].into_iter().filter(|(_, side)| side.crs().is_none());
            notes.extend(nameless.map(|(letter, _)| {
                format!("{letter} names no coordinate reference system: it is taken to be in {name}.")
            }));
        }
        let a_heights = a.on(&grid, crs.as_ref(), console)?;
        let b_heights = b.on(&grid, crs.as_ref(), console)?;
        Ok(Self { a, b, a_heights, b_heights, notes })
    }
}

fn note(a: &Side, b: &Side, grid: &Grid) -> String {
    match (&a.kind, &b.kind) {
        (Kind::Surface(_), Kind::Dem(_)) => "The surface of A is evaluated at the cell centres of B.".into(),
        (Kind::Dem(_), Kind::Surface(_)) => "The surface of B is evaluated at the cell centres of A.".into(),
        (Kind::Surface(_), Kind::Surface(_)) => {
            format!(
                "Both surfaces are evaluated at the centres of cells of {} x {}.",
                plain(grid.cell.x),
                plain(grid.cell.y)
            )
        }
        (Kind::Dem(dem), Kind::Dem(_)) if dem.grid == *grid => "Both have the same cells.".into(),
        (Kind::Dem(_), Kind::Dem(_)) => {
            "A is on another grid: it is interpolated (bilinear) at the cell centres of B, which stays as it is.".into()
        }
    }
}

/// Findings as they are told, with places in the coordinates of their file.
pub fn told(findings: &[Finding]) -> Vec<Finding> {
    let told = |finding: &Finding| match finding.place {
        Some(p) => {
            // Seven decimals of what may be degrees are a centimetre.
            let decimals = if p.x.abs() <= 360.0 && p.y.abs() <= 90.0 { 7 } else { 3 };
            Finding::general(finding.kind, format!("{} at {:.decimals$} {:.decimals$}", finding.message, p.x, p.y))
        }
        None => finding.clone(),
    };
    findings.iter().map(told).collect()
}

/// The way from one system to another; none if a place is the same in both, or if one of them is not known.
pub fn way(path: &Path, from: Option<&Crs>, to: Option<&Crs>) -> Result<Option<Transform>, Failure> {
    let Some((from, to)) = from.zip(to) else { return Ok(None) };
    let way = Transform::between(from, to).map_err(|e| Error::file(path, e.to_string()))?;
    Ok(Some(way).filter(|way| !way.is_identity()))
}

/// A place after a way.
pub fn along(way: Option<&Transform>, p: DVec2) -> Option<DVec2> {
    way.map_or(Some(p), |way| way.forward(p))
}

impl Side {
    /// Reads a height map.
    pub fn of_height_map(path: &Path, findings: &mut Vec<Finding>, console: &Console) -> Result<Self, Failure> {
        let read = console.step("reading", || read_dem(path))?;
        Ok(side_of_dem(path, read.collect(findings)))
    }

    /// The surface of a file of contours; `crs` is the name of the file's system.
    pub fn of_surface(path: &Path, crs: Option<String>, kind: KindArg, surface: Surface) -> Self {
        let about = format!(
            "surface ({}) of {} contours, interval {} m",
            kind.name(),
            surface.map.contours.len(),
            surface.interval.step
        );
        let source = Source { file: path.to_owned(), kind: "contours", crs, about };
        Self { source, kind: Kind::Surface(Box::new(surface)), sigma: None }
    }

    pub fn surface(&self) -> Option<&Surface> {
        match &self.kind {
            Kind::Surface(surface) => Some(surface),
            Kind::Dem(_) => None,
        }
    }

    /// The cells of a height map.
    pub fn nodes(&self) -> Option<Nodes> {
        match &self.kind {
            Kind::Dem(dem) => Some((dem.grid, dem.crs.clone())),
            Kind::Surface(_) => None,
        }
    }

    /// The system that the heights are in: for contours the one that they were worked on in.
    pub fn crs(&self) -> Option<&Crs> {
        match &self.kind {
            Kind::Dem(dem) => dem.crs.as_ref(),
            Kind::Surface(surface) => surface.map.crs.as_ref(),
        }
    }

    /// Heights at the cell centres of a grid in some system.
    fn on(&self, grid: &Grid, crs: Option<&Crs>, console: &Console) -> Result<Dem, Failure> {
        let way = way(&self.source.file, crs, self.crs())?;
        let to_side = |p: DVec2| along(way.as_ref(), p);
        let values = match &self.kind {
            Kind::Dem(dem) if dem.grid == *grid && way.is_none() => dem.values.clone(),
            Kind::Dem(dem) => console.step("interpolating", || heights_between(dem, grid, &to_side)),
            Kind::Surface(surface) if way.is_none() => heights(surface, grid, console).values,
            Kind::Surface(surface) => heights_on(surface, grid, &to_side, console),
        };
        Ok(Dem { grid: *grid, values, crs: crs.cloned() })
    }

    /// Heights at check points, NaN where there are none.
    pub fn at(&self, path: &Path, checks: &SpotHeights) -> Result<Vec<f64>, Failure> {
        let way = way(path, checks.crs.as_ref(), self.crs())?;
        let place = |k: usize| checks.points.get(k).and_then(|p| along(way.as_ref(), p.truncate()));
        Ok(match &self.kind {
            Kind::Dem(dem) => {
                (0..checks.points.len()).map(|k| place(k).map_or(f64::NAN, |p| height_at(dem, p))).collect()
            }
            Kind::Surface(surface) => {
                // The points one after the other are the cells of a row.
                let row = Grid { corner: DVec2::ZERO, cell: DVec2::ONE, cols: checks.points.len(), rows: 1 };
                let heights = heights_on(surface, &row, &|p: DVec2| place(p.x as usize), &());
                heights.into_iter().map(f64::from).collect()
            }
        })
    }
}

fn side_of_dem(path: &Path, DemFile { dem, product }: DemFile) -> Side {
    let name = product.map_or("height map", |product| product.name());
    let Grid { cols, rows, cell, .. } = dem.grid;
    let is_degrees = dem.crs.as_ref().is_some_and(Crs::is_geographic);
    let (factor, unit) = if is_degrees { (3600.0, " seconds of arc") } else { (1.0, "") };
    let source = Source {
        file: path.to_owned(),
        kind: "dem",
        crs: dem.crs.as_ref().and_then(Crs::name),
        about: format!(
            "{name}, {cols} x {rows} cells of {} x {}{unit}",
            plain(cell.x * factor),
            plain(cell.y * factor)
        ),
    };
    Side { source, kind: Kind::Dem(dem), sigma: product.map(|product| product.sigma()) }
}

/// A size to nine digits: what dividing left behind them says nothing.
fn plain(size: f64) -> f64 {
    format!("{size:.8e}").parse().unwrap_or(size)
}

/// Reads contours and builds their surface: for the cells that heights are compared at or, if these are not known yet, for
/// those that are asked for, which are then the ones.
fn side_of_contours(
    args: &CompareArgs,
    path: &Path,
    nodes: &mut Option<Nodes>,
    findings: &mut Vec<Finding>,
    console: &Console,
) -> Result<Side, Failure> {
    // Check points must not be known to the surface that they check.
    let map = MapArgs { contours: path.to_owned(), points: None, ..args.input.map.clone() };
    let reading = InputArgs { map, ..args.input.clone() };
    let mut input = reading.read(console)?;
    let working = input.map.crs.clone();
    if let Some((_, crs @ None)) = nodes {
        *crs = input.places.input_crs().cloned();
    }
    let choice = match nodes {
        Some((grid, crs)) => way(path, crs.as_ref(), working.as_ref())?.is_none().then_some(GridChoice::Like(*grid)),
        None => Some(args.grid.choice(&input.places)?),
    };
    let params = args.surface.params(&mut input, choice.as_ref(), Triangles::Guide)?;
    if let Some(choice) = &choice {
        choice.check_room(&input.map, &params.frame)?;
    }
    let crs = input.places.input_crs().and_then(Crs::name);
    let surface = build_surface(&mut input, &params, console)?;
    reading.map.check_strict(&input.findings, console)?;
    // Each side may have been worked on in a plane of its own.
    for finding in &mut input.findings {
        finding.place = finding.place.and_then(|p| input.places.in_input(p));
    }
    findings.append(&mut input.findings);
    if let (None, Some(choice)) = (&nodes, &choice) {
        *nodes = Some((grid_for(choice, &surface)?, choice.crs(working.as_ref()).cloned()));
    }
    Ok(Side::of_surface(path, crs, args.surface.surface, surface))
}
