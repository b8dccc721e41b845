//! Reading the sides of a comparison, a profile or a volume.

use std::path::Path;

use tokosen::base::ElevationUnit;
use tokosen::base::error::Finding;
use tokosen::io::{Content, VectorSource, content};
use tokosen::surface::{Triangles, Uncertainty};
use tokosen::terrain::{Nodes, Side, height_systems_differ};
use tokosen::{GridSpec, Options};

use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::height_map::GridArgs;
use crate::cli::input::{InputArgs, Scope};
use crate::cli::job::build;
use crate::cli::map::MapArgs;
use crate::cli::surface::{SurfaceArgs, about_surface};
use crate::cli::vertical_shift::ShiftArgs;

/// The arguments about the sides.
#[derive(Clone, Copy)]
pub struct Sides<'a> {
    pub input: &'a InputArgs,
    /// The second side, if there is one.
    pub b: Option<&'a VectorSource>,
    /// The cells at which contours are evaluated, if heights are not those of single places.
    pub grid: Option<&'a GridArgs>,
    pub surface: &'a SurfaceArgs,
    /// The shift of the heights of a height map; of two, of the first one.
    pub shift: &'a ShiftArgs,
    pub uncertainty: Uncertainty,
}

/// The sides as they were read.
pub struct ReadSides {
    pub a: Side,
    pub b: Option<Side>,
    /// The cells of the height map, or those that the arguments ask for.
    pub nodes: Option<Nodes>,
}

/// Reads the sides.
pub fn read(
    args: Sides<'_>,
    contents: &[Content],
    findings: &mut Vec<Finding>,
    console: &Console,
) -> Result<ReadSides, Failure> {
    let path_a = args.input.map.file();
    // Height maps come first, because the surface is built for their cells.
    let mut shift = args.shift.read()?;
    let mut dem = |path: &Path, content: Content, findings: &mut Vec<Finding>| -> Result<Option<Side>, Failure> {
        if content == Content::Contours {
            return Ok(None);
        }
        let mut side = Side::read_height_map(path, console)?.collect(findings);
        if let Some(shift) = shift.take() {
            findings.extend(shift.apply_to_side(&mut side)?);
        }
        Ok(Some(side))
    };
    let mut known = 0;
    let mut label = |side: &str, findings: &mut Vec<Finding>| {
        findings[known..].iter_mut().for_each(|finding| finding.message = format!("{side}: {}", finding.message));
        known = findings.len();
    };
    let (content_a, content_b) = (contents.first().copied().unwrap_or(Content::Contours), contents.get(1).copied());
    let dem_a = dem(path_a, content_a, findings)?;
    label("A", findings);
    let dem_b = match (args.b, content_b) {
        (Some(b), Some(content)) => dem(&b.path, content, findings)?,
        _ => None,
    };
    label("B", findings);
    let crs_of = |side: &Option<Side>| side.as_ref().and_then(Side::crs).cloned();
    let nodes_of = |side: &Option<Side>| side.as_ref().and_then(Side::nodes).map(|(grid, _)| grid);
    // A height map without a coordinate reference system is assumed to be in that of the other side.
    let crs = crs_of(&dem_b).or_else(|| crs_of(&dem_a));
    let mut nodes = nodes_of(&dem_b).or_else(|| nodes_of(&dem_a)).map(|grid| (grid, crs));
    let b = match (dem_b, args.b) {
        (None, Some(b)) => Some(side_of_contours(args, b.clone(), &mut nodes, findings, console)?),
        (side, _) => side,
    };
    label("B", findings);
    let a = match dem_a {
        Some(side) => side,
        None => side_of_contours(args, args.input.map.contours[0].clone(), &mut nodes, findings, console)?,
    };
    label("A", findings);
    if let Some(b) = &b {
        let [of_a, of_b] = [&a, b].map(|side| (side.source.file.display(), side.height_system.as_ref()));
        findings.extend(height_systems_differ((&of_a.0, of_a.1), (&of_b.0, of_b.1)));
    }
    Ok(ReadSides { a, b, nodes })
}

/// Reads contours and builds their surface for `nodes`, the cells that heights are compared at. If these are not known
/// yet, they become the cells that the arguments ask for.
fn side_of_contours(
    args: Sides<'_>,
    source: VectorSource,
    nodes: &mut Option<Nodes>,
    findings: &mut Vec<Finding>,
    console: &Console,
) -> Result<Side, Failure> {
    // The surface must not be built with the points that check it.
    let path = source.path.clone();
    let map = MapArgs { contours: vec![source], points: None, ..args.input.map.clone() };
    let scope = Scope { sea: args.surface.water.sea, ..Scope::of(&args.surface.frame) };
    let mut input = InputArgs { map, ..args.input.clone() }.read(scope, console)?;
    if let Some((_, crs @ None)) = nodes {
        *crs = input.reprojection.input_crs().cloned();
    }
    let grid = match nodes {
        Some((grid, crs)) => Some(GridSpec::Cells { grid: *grid, crs: crs.clone(), file: Some(path.clone()) }),
        None => args.grid.map(|grid| grid.spec(None)).transpose()?,
    };
    // Single places may lie beside the cells of the other side.
    let grid = grid.filter(|_| args.grid.is_some());
    let options = Options {
        uncertainty: args.uncertainty,
        ..args.surface.options(grid.as_ref(), Triangles::Reference, ElevationUnit::Metre)?
    };
    let mut terrain = build(&mut input, args.surface, &options, console)?;
    // Each side may have a working plane of its own.
    for finding in &mut terrain.findings {
        finding.place = finding.place.and_then(|p| terrain.reprojection.in_input(p));
    }
    findings.append(&mut terrain.findings);
    if let (None, Some(grid)) = (&nodes, &grid) {
        *nodes = Some(terrain.cells(grid)?);
    }
    Ok(Side::of_terrain(&path, args.surface.surface.kind(), terrain))
}

/// What the sides are.
pub fn contents(input: &InputArgs, b: Option<&VectorSource>) -> Result<Vec<Content>, Failure> {
    let b = b.map(|b| content(&b.path)).transpose()?;
    Ok([Some(input.map.content()?), b].into_iter().flatten().collect())
}

/// Refuses flags about contours if there are none, and flags that do not fit the kind of the surface.
pub fn check(
    input: &InputArgs,
    b: Option<&VectorSource>,
    (surface, shift): (&SurfaceArgs, &ShiftArgs),
    console: &Console,
) -> Result<(), Failure> {
    let flags = &console.flags;
    let contents = contents(input, b)?;
    shift.check(contents.contains(&Content::HeightMap))?;
    if contents.contains(&Content::Contours) {
        return surface.check(flags);
    }
    match InputArgs::about_contours(flags, &[]).or_else(|| about_surface(flags)) {
        Some(flag) => Err(Failure::Usage(format!("{flag} applies to contours, but the input is a height map"))),
        None => Ok(()),
    }
}

/// States the standard error of the heights of height maps, metres, if it is given; otherwise reads those that the files have.
pub fn state_sigma(sigma: Option<f64>, sides: [Option<&mut Side>; 2]) -> Result<(), Failure> {
    for side in sides.into_iter().flatten().filter(|side| side.surface().is_none()) {
        side.sigma = sigma.or(side.sigma);
        side.read_errors()?;
    }
    Ok(())
}
