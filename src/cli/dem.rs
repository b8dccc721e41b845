//! `tokosen dem`: contour lines in, a height map out.

use std::path::{Path, PathBuf};

use clap::Args;
use tokosen::slice::{LayerParams, Target, contour_layers};
use tokosen::surface::Triangles;

use super::console::Console;
use super::input::InputArgs;
use super::output::{self, DemOutput, HeightMapArgs};
use super::preview;
use super::surface::{SurfaceArgs, build_surface};
use super::{Failure, summary};

/// A height map (DEM) from contour lines
///
/// Heights are those of the surface at the cell centres; cells outside the frame are nodata. The map is in the working CRS,
/// with --cell-degrees in degrees, with --like in the CRS of that raster.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct DemArgs {
    #[command(flatten)]
    input: InputArgs,
    /// Height map to write: GeoTIFF (.tif), OpenEXR (.exr), PNG (.png), ESRI ASCII grid (.asc) or text (.xyz)
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    output: PathBuf,
    #[command(flatten, next_help_heading = "Output")]
    height_map: HeightMapArgs,
    /// Also draw a picture of surface and contours: .png
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    preview: Option<PathBuf>,
    #[command(flatten)]
    surface: SurfaceArgs,
}

const EXAMPLES: &str = "\
Examples:
  tokosen dem contours.gpkg --cell 10 -o dem.tif
  tokosen dem contours.gpkg --cell-degrees 0.4s -o degrees.tif
  tokosen dem contours.shp -a ELEV --like published_dem.tif -o mine.tif
  tokosen dem contours.gpkg --cell 10 --uncertainty -o dem_and_error.tif
  tokosen dem contours.geojson --cell 5 -o heights.exr --preview look.png --frame bbox";

/// Runs the verb.
pub fn run(args: &DemArgs, console: &Console) -> Result<(), Failure> {
    args.height_map.grid.check()?;
    let inputs: Vec<&Path> =
        args.input.map.files().chain(args.height_map.grid.like.as_deref()).chain(args.surface.files()).collect();
    let outputs: Vec<&Path> = std::iter::once(args.output.as_path()).chain(args.preview.as_deref()).collect();
    output::check_paths(&inputs, &outputs)?;
    let staged = output::open_dem(&args.output, &args.height_map)?;
    let picture = preview::open(args.preview.as_deref())?;

    let mut input = args.input.read(console)?;
    let output = DemOutput::new(staged, &args.height_map, &input.places)?;
    let mut params = args.surface.params(&mut input, Some(&output.choice), Triangles::Guide)?;
    params.uncertainty = args.height_map.uncertainty();
    output.choice.check_room(&input.map, &params.frame)?;
    let surface = build_surface(&mut input, &params, console)?;
    args.input.map.check_strict(&input.findings, console)?;
    let dem = output.write(&surface, console)?;
    if let Some(picture) = &picture {
        let params = LayerParams { targets: vec![Target::Levels(Vec::new())], index_every: 5 };
        let layers = contour_layers(&surface, &params, &())?;
        preview::write(picture, &surface, &layers[0].lines, console)?;
    }

    summary::findings(&input.findings, console);
    args.input.map.describe(&surface.map, console);
    summary::surface(&surface, console);
    let path = output.staged.target().to_owned();
    output.staged.commit()?;
    output::describe(&path, &dem, console);
    preview::commit(picture, console)?;
    summary::close(input.findings.len(), console);
    Ok(())
}
