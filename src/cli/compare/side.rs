//! Reading the two sides of a comparison.

use std::path::Path;

use tokosen::GridSpec;
use tokosen::base::ElevationUnit;
use tokosen::base::error::Finding;
use tokosen::io::{Content, VectorSource};
use tokosen::surface::Triangles;
use tokosen::terrain::{Nodes, Pair, Side};

use super::args::CompareArgs;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::input::{InputArgs, Scope};
use crate::cli::job::build;
use crate::cli::map::MapArgs;

/// Reads both sides and brings them onto one grid.
pub fn read(
    args: &CompareArgs,
    contents: [Content; 2],
    findings: &mut Vec<Finding>,
    console: &Console,
) -> Result<Pair, Failure> {
    let (path_a, path_b) = (args.input.map.file(), args.b.path.as_path());
    // Height maps come first, because the surface is built for their cells.
    let dem = |path: &Path, content: Content, findings: &mut Vec<Finding>| -> Result<Option<Side>, Failure> {
        match content {
            Content::Contours => Ok(None),
            Content::HeightMap => Ok(Some(Side::read_height_map(path, console)?.collect(findings))),
        }
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
    // A height map without a coordinate reference system is assumed to be in that of the other side.
    let crs = crs_of(&dem_b).or_else(|| crs_of(&dem_a));
    let mut nodes = nodes_of(&dem_b).or_else(|| nodes_of(&dem_a)).map(|grid| (grid, crs));
    let b = match dem_b {
        Some(side) => side,
        None => side_of_contours(args, args.b.clone(), &mut nodes, findings, console)?,
    };
    label("B", findings);
    let a = match dem_a {
        Some(side) => side,
        None => side_of_contours(args, args.input.map.contours[0].clone(), &mut nodes, findings, console)?,
    };
    label("A", findings);
    let Some(nodes) = nodes else {
        return Err(Failure::Usage("two surfaces need a common grid: give --cell SIZE or --like RASTER".into()));
    };
    Pair::refuse_degrees(&nodes, path_b)?;
    Ok(Pair::on(a, b, nodes, console)?)
}

/// Reads contours and builds their surface for `nodes`, the cells that heights are compared at. If these are not known
/// yet, they become the cells that the arguments ask for.
fn side_of_contours(
    args: &CompareArgs,
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
        Some((grid, crs)) => GridSpec::Cells { grid: *grid, crs: crs.clone(), file: Some(path.clone()) },
        None => args.grid.spec(None)?,
    };
    let options = args.surface.options(Some(&grid), Triangles::Reference, ElevationUnit::Metre)?;
    let mut terrain = build(&mut input, &args.surface, &options, console)?;
    // Each side may have a working plane of its own.
    for finding in &mut terrain.findings {
        finding.place = finding.place.and_then(|p| terrain.reprojection.in_input(p));
    }
    findings.append(&mut terrain.findings);
    if nodes.is_none() {
        *nodes = Some(terrain.cells(&grid)?);
    }
    Ok(Side::of_terrain(&path, args.surface.surface.kind(), terrain))
}
