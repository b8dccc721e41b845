//! `tokosen dem`: contour lines in, a height map out.

use std::path::{Path, PathBuf};

use clap::Args;
use tokosen::Options;
use tokosen::base::error::Report;
use tokosen::draw::Scene;
use tokosen::surface::Triangles;

use super::base::{self, BaseArgs};
use super::console::Console;
use super::diagnostics::DiagnosticsArgs;
use super::engine::EngineArgs;
use super::failure::Failure;
use super::height_map::HeightMapArgs;
use super::input::{InputArgs, Scope};
use super::job::Job;
use super::output::DemOutput;
use super::part::PartArgs;
use super::picture::{Asked, Drawing, PictureArgs};
use super::plane::CellsCrsArgs;
use super::summary;
use super::surface::{ABOUT_PITS, SurfaceArgs};
use super::unit::ToUnitArgs;
use super::vertical_shift::ShiftArgs;
use super::viewer::ViewerArgs;

/// A height map (DEM) from contour lines
///
/// Heights are those of the surface at the cell centres. Cells outside the frame are nodata, or get their heights from
/// --base. The height map is in the working CRS, or in that of --to-crs; for a drawing in feet
/// without a CRS in the coordinates of the drawing; with --cell-degrees it is in degrees, with --like
/// in the CRS of that raster. Heights are in metres, or in the unit of --to-unit, which the file states (.xyz has no place
/// for it).
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct DemArgs {
    #[command(flatten)]
    input: InputArgs,
    /// Height map to write: GeoTIFF (.tif), OpenEXR (.exr), PNG (.png), ESRI ASCII grid (.asc) or text (.xyz). Or terrain
    /// tiles (with --max-zoom): .pmtiles, .mbtiles or 'FOLDER/{z}/{x}/{y}.png'. Give it again for the same heights in another
    /// format: -o dem.tif -o dem.exr
    #[arg(short, long, value_name = "FILE", help_heading = "Output", required = true)]
    output: Vec<PathBuf>,
    #[command(flatten, next_help_heading = "Output")]
    height_map: HeightMapArgs,
    #[command(flatten, next_help_heading = "Output")]
    engine: EngineArgs,
    #[command(flatten, next_help_heading = "Output")]
    base: BaseArgs,
    #[command(flatten, next_help_heading = "Output")]
    shift: ShiftArgs,
    #[command(flatten, next_help_heading = "Output")]
    to_crs: CellsCrsArgs,
    #[command(flatten, next_help_heading = "Output")]
    to_unit: ToUnitArgs,
    #[command(flatten, next_help_heading = "Output")]
    picture: PictureArgs,
    #[command(flatten, next_help_heading = "Output")]
    viewer: ViewerArgs,
    #[command(flatten, next_help_heading = "Part of the map")]
    part: PartArgs,
    #[command(flatten, next_help_heading = "Output")]
    diagnostics: DiagnosticsArgs,
    #[command(flatten)]
    surface: SurfaceArgs,
}

const EXAMPLES: &str = "\
Examples:
  tokosen dem contours.gpkg --cell 10 -o dem.tif
  tokosen dem contours.gpkg --cell-degrees 0.4s -o degrees.tif
  tokosen dem contours.gpkg --to-crs EPSG:3857 --cell 10 -o web_mercator.tif
  tokosen dem contours.shp -a ELEV --like published_dem.tif -o mine.tif
  tokosen dem contours.gpkg --base published_dem.tif --cell 10 -o whole_area.tif
  tokosen dem contours.gpkg --cell 10 --to-unit us-ft -o feet.tif
  tokosen dem contours.gpkg --cell 10 --uncertainty -o dem_and_error.tif
  tokosen dem contours.geojson --cell 5 -o heights.exr --preview look.png --frame bbox
  tokosen dem contours.gpkg --cell 10 -o dem.tif -o dem.exr -o dem.asc
  tokosen dem contours.gpkg --for unreal --size 1009 --frame bbox -o landscape.png
  tokosen dem contours.gpkg --max-zoom 13 -o terrain.pmtiles
  tokosen dem contours.gpkg --max-zoom 13 -o map/terrain.pmtiles --viewer map/index.html";

/// Runs the verb.
pub fn run(args: &DemArgs, console: &Console) -> Result<(), Failure> {
    let crs = args.to_crs.to_crs.as_ref();
    let engine = args.engine.wanted(&args.output, args.height_map.grid.cell, &console.flags)?;
    if engine.is_none() {
        args.output.iter().try_for_each(|path| args.height_map.check(path, crs, args.to_unit.unit()))?;
    }
    args.surface.check(&console.flags)?;
    args.shift.check(true)?;
    let paths: Vec<&Path> = args.output.iter().map(PathBuf::as_path).collect();
    args.viewer.check(&paths)?;
    let beside: Vec<PathBuf> = match &engine {
        Some(_) => args.output.iter().map(|path| path.with_extension("json")).collect(),
        None => args.output.iter().filter_map(|path| args.height_map.stac_item(path)).collect(),
    };
    let others = [args.height_map.grid.like.as_deref(), args.base.file(), args.part.file(), args.shift.file()];
    let inputs = others.into_iter().flatten().chain(args.surface.files());
    let outputs = args.output.iter().chain(&args.viewer.viewer).chain(&beside).map(|path| path.as_path().into());
    let outputs = outputs.chain(args.diagnostics.planned());
    let mut job = Job::start(&args.input, inputs, outputs, Asked::Map(&args.picture), console)?;
    console.plan(["writing"]);
    let shift = args.shift.read()?;
    let diagnostics = args.diagnostics.open()?;
    let viewer = args.viewer.open(&paths, &args.input.map.title())?;
    let attribution = args.viewer.attribution.as_deref();
    let open = |path: &PathBuf| match &engine {
        Some(engine) => DemOutput::for_engine(path, engine),
        None => DemOutput::open(path, &args.height_map, crs, args.to_unit.unit(), attribution),
    };
    let outputs: Vec<DemOutput> = args.output.iter().map(open).collect::<Result<_, _>>()?;
    // All of them have the same cells.
    let grid = outputs.first().map(|output| &output.grid);

    let sea = args.surface.water.sea_in_metres(args.to_unit.unit());
    let scope = Scope { part: Some(&args.part), sea, grid, ..Scope::of(&args.surface.frame) };
    let mut input = job.read(scope)?;
    args.base.add_to(&mut input, console)?;
    let options = Options {
        uncertainty: args.height_map.uncertainty(),
        base_fade: args.base.base_fade,
        ..args.surface.options(grid, Triangles::Reference, args.to_unit.unit())?
    };
    let mut terrain = job.build(&mut input, &args.surface, options)?;
    let mut maps = Vec::new();
    for output in &outputs {
        let Report { value, findings } = output.write(&terrain, shift.as_ref(), console)?;
        // The findings are about the heights, which are the same in each file.
        if maps.is_empty() {
            terrain.findings.extend(findings);
        }
        maps.push(value);
    }
    job.check_strict(&terrain.findings)?;
    let wants_pits = diagnostics.is_some() || console.flags.first(&ABOUT_PITS).is_some();
    let first = maps.first().zip(grid).filter(|_| wants_pits);
    let pits = first.map(|(map, grid)| terrain.pits_of(&map.map.dem, grid)).transpose()?;
    diagnostics.iter().zip(&pits).try_for_each(|(file, pits)| file.write(&terrain, pits, args.to_unit.unit()))?;
    let units = args.to_unit.drawn(console.units());
    if job.draws() {
        let lines = terrain.input_contours()?.lines;
        let scene = Scene::of_surface(&terrain.surface, &lines, &terrain.reprojection, units);
        job.draw(&Drawing::Map(scene.within(terrain.part())))?;
    }

    job.report(&terrain.findings, &terrain.surface.map);
    summary::surface(&terrain.surface, &terrain.findings, console);
    pits.iter().for_each(|pits| summary::pits(pits, "height map", console));
    maps.iter().take(1).filter_map(|map| map.map.base.as_ref()).for_each(|base| base::describe(base, console));
    outputs.into_iter().zip(&maps).try_for_each(|(output, map)| output.commit(map, console))?;
    viewer.map(|viewer| viewer.commit(console)).transpose()?;
    diagnostics.map(|file| file.commit(console)).transpose()?;
    job.close_part(terrain.findings.len(), terrain.findings_outside)
}
