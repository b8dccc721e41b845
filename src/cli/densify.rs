//! `tokosen densify`: contour lines in, denser contour lines out.

use std::path::{Path, PathBuf};

use clap::Args;
use tokosen::base::error::Error;
use tokosen::contour::{ContourLayer, Source};
use tokosen::crs::Crs;
use tokosen::io::layer::{Layer, of_contours};
use tokosen::io::{Content, VectorFormat, content, contour_files, write_layers_back};
use tokosen::slice::{LayerParams, Target, contour_layers};
use tokosen::surface::Triangles;

use super::compare::{Options, Pair, Side, draw, measure, open_page, tell};
use super::console::Console;
use super::input::InputArgs;
use super::output::{self, DemOutput, HeightMapArgs};
use super::plane::ToCrsArgs;
use super::preview;
use super::surface::{SurfaceArgs, build_surface};
use super::{Failure, summary};

/// Contour lines at a finer interval
///
/// All contours of the input come out unchanged, vertex for vertex, with new lines between them. Each line has the
/// attributes elev, source (input or interpolated), is_index, depression (lower inside) and closed; higher ground is on
/// the right of its direction. With --uncertainty also err_v and err_h (expected error of its height and of its course,
/// metres and units of the working CRS) and inferred (the input hardly tells what lies there: a top, a pit, a wide flat,
/// the strip along the frame). A DXF tells source and index contours by its layers (CONTOUR-INPUT-INDEX), and neither the
/// other attributes nor the coordinate reference system.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct DensifyArgs {
    #[command(flatten)]
    input: InputArgs,
    /// Contour lines to write: .geojson, .gpkg, .fgb, .dxf or .shp. With several intervals a GeoPackage gets a layer each,
    /// the other formats a file each
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    output: PathBuf,
    /// Interval of the new contours [metres], or several: 5,2,1
    #[arg(
        short,
        long,
        value_name = "STEP",
        value_delimiter = ',',
        allow_negative_numbers = true,
        required_unless_present = "levels",
        help_heading = "Output"
    )]
    interval: Vec<f64>,
    /// Elevations of the new contours [metres] instead of an interval: 12.5,13
    #[arg(
        long,
        value_name = "Z",
        value_delimiter = ',',
        allow_negative_numbers = true,
        conflicts_with_all = ["interval", "base"],
        help_heading = "Output"
    )]
    levels: Vec<f64>,
    /// Levels lie at BASE plus whole intervals [metres]
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true, help_heading = "Output")]
    base: f64,
    /// Every so many levels one is an index contour; 0 for none
    #[arg(long, value_name = "N", default_value_t = 5, help_heading = "Output")]
    index: u32,
    #[command(flatten, next_help_heading = "Output")]
    to_crs: ToCrsArgs,
    /// Also write a height map: .tif, .exr, .png, .asc or .xyz (needs --cell, --cell-degrees or --like)
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    dem: Option<PathBuf>,
    #[command(flatten, next_help_heading = "Output")]
    height_map: HeightMapArgs,
    /// Also compare the surface with this height map, at the centres of its cells; 'tokosen compare' has more on it
    #[arg(long, value_name = "RASTER", help_heading = "Output")]
    compare: Option<PathBuf>,
    /// Page with maps, charts and tables of that comparison: .html
    #[arg(long, value_name = "FILE", requires = "compare", help_heading = "Output")]
    report: Option<PathBuf>,
    /// Also draw a picture of surface and lines: .png
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    preview: Option<PathBuf>,
    #[command(flatten)]
    surface: SurfaceArgs,
}

const EXAMPLES: &str = "\
Examples:
  tokosen densify contours.gpkg -i 2 -o contours_2m.gpkg
  tokosen densify contours.shp -a ELEV -i 5,2,1 -o dense.gpkg
  tokosen densify contours.geojson -i 2 -o dense.shp --dem dem.tif --cell 5 --preview look.png
  tokosen densify contours.gpkg -i 2 --uncertainty -o contours_2m.gpkg --preview look.png
  tokosen densify degrees.geojson -i 2 -o metric.gpkg --to-crs EPSG:6677
  tokosen densify feet.gpkg --unit ft -i 5 -o dense.gpkg
  tokosen densify contours.zip -i 1 -o dense.gpkg --compare published_dem.zip --report compared.html
  tokosen densify contours.gpkg --levels 12.5,13,13.5 -o flood.geojson --points spots.gpkg";

/// Runs the verb.
pub fn run(args: &DensifyArgs, console: &Console) -> Result<(), Failure> {
    if args.dem.is_none() && args.height_map.given().is_some() {
        return Err(Failure::Usage(
            "--cell, --cell-degrees, --like and --png-encoding are about a height map: add --dem FILE".into(),
        ));
    }
    if VectorFormat::from_path(&args.output).is_err() {
        let message = format!("{}: contours are written as .geojson, .gpkg, .fgb, .dxf or .shp", args.output.display());
        return Err(Failure::Usage(message));
    }
    let targets = args.targets()?;
    let names: Vec<String> = targets.iter().map(Target::layer_name).collect();
    let files = contour_files(&args.output, &names.iter().map(String::as_str).collect::<Vec<_>>())?;
    let others = [&args.height_map.grid.like, &args.compare].into_iter().flatten().map(PathBuf::as_path);
    let inputs: Vec<&Path> = args.input.map.files().chain(others).chain(args.surface.files()).collect();
    let others = [&args.dem, &args.report, &args.preview].into_iter().flatten();
    let outputs: Vec<&Path> = files.iter().chain(others).map(PathBuf::as_path).collect();
    output::check_paths(&inputs, &outputs)?;
    let staged = output::open(&args.output)?;
    let dem_file = match &args.dem {
        Some(path) => {
            args.height_map.grid.check()?;
            Some(output::open_dem(path, &args.height_map)?)
        }
        None => None,
    };
    let picture = preview::open(args.preview.as_deref())?;
    if let Some(path) = &args.compare
        && content(path)? == Content::Contours
    {
        let message = "holds contours; --compare takes a height map, and 'tokosen compare' two maps";
        return Err(Failure::Work(Error::file(path, message)));
    }
    let page = args.report.as_deref().map(open_page).transpose()?;
    let mut findings = Vec::new();
    let reference =
        args.compare.as_deref().map(|path| Side::of_height_map(path, &mut findings, console)).transpose()?;

    let mut input = args.input.read(console)?;
    input.findings.append(&mut findings);
    let back = args.to_crs.way(&input.places)?;
    let dem_output = dem_file.map(|staged| DemOutput::new(staged, &args.height_map, &input.places)).transpose()?;
    let mut params =
        args.surface.params(&mut input, dem_output.as_ref().map(|output| &output.choice), Triangles::Smooth)?;
    params.uncertainty = args.height_map.uncertainty();
    if let Some(output) = &dem_output {
        output.choice.check_room(&input.map, &params.frame)?;
    }
    let crs = input.places.input_crs().and_then(Crs::name);
    let surface = build_surface(&mut input, &params, console)?;
    args.input.map.check_strict(&input.findings, console)?;
    let layers = contour_layers(&surface, &LayerParams { targets, index_every: args.index }, console)?;
    let written = console.step("writing", || {
        let layers: Vec<Layer<'_>> = layers.iter().map(of_contours).collect();
        write_layers_back(&staged, &layers, &back)
    })?;
    let dem = match &dem_output {
        Some(output) => Some(output.write(&surface, console)?),
        None => None,
    };
    if let Some(picture) = &picture {
        preview::write(picture, &surface, finest(&layers), console)?;
    }

    summary::findings(&input.findings, console);
    args.input.map.describe(&surface.map, console);
    summary::surface(&surface, console);
    staged.commit()?;
    for (k, layer) in layers.iter().enumerate() {
        describe(written.get(k).or(written.first()), layer, console);
    }
    if let (Some(output), Some(dem)) = (dem_output, &dem) {
        let path = output.staged.target().to_owned();
        output.staged.commit()?;
        output::describe(&path, dem, console);
    }
    preview::commit(picture, console)?;
    if let Some((reference, nodes)) = reference.and_then(|side| side.nodes().map(|nodes| (side, nodes))) {
        console.say("");
        let side = Side::of_surface(&args.input.map.contours, crs, args.surface.surface, surface);
        let pair = Pair::on(side, reference, nodes, console)?;
        let found = measure(&pair, &Options::default(), &mut input.findings, console)?;
        if let Some(page) = page {
            draw(&page, &pair, &found, console)?;
            let path = page.target().to_owned();
            page.commit()?;
            console.say(&format!("written    {}", path.display()));
        }
        tell(&pair, &found, console);
    }
    summary::close(input.findings.len(), console);
    Ok(())
}

impl DensifyArgs {
    fn targets(&self) -> Result<Vec<Target>, Failure> {
        if let Some(bad) = self.levels.iter().chain([&self.base]).find(|level| !level.is_finite()) {
            return Err(Failure::Usage(format!("{bad} is no elevation")));
        }
        if !self.levels.is_empty() {
            return Ok(vec![Target::Levels(self.levels.clone())]);
        }
        if let Some(bad) = self.interval.iter().find(|i| !(i.is_finite() && **i > 0.0)) {
            return Err(Failure::Usage(format!("the interval is {bad}, it must be more than 0")));
        }
        Ok(self.interval.iter().map(|&step| Target::Interval { step, base: self.base }).collect())
    }
}

/// The layer with the most lines, for the picture.
fn finest(layers: &[ContourLayer]) -> &[tokosen::contour::ContourLine] {
    layers.iter().max_by_key(|l| l.lines.len()).map_or(&[], |l| &l.lines)
}

fn describe(path: Option<&PathBuf>, layer: &ContourLayer, console: &Console) {
    let new = layer.lines.iter().filter(|l| l.source == Source::Interpolated).count();
    let vertices: usize = layer.lines.iter().map(|l| l.points.len()).sum();
    let beads = match layer.beads {
        0 => String::new(),
        n => format!("; {n} rings around single computed points left out"),
    };
    let stubs = match layer.stubs {
        0 => String::new(),
        n => format!(
            "; {n} lines left out that ran into a contour of their own level, where contours are missing around it"
        ),
    };
    let path = path.map(|p| p.display().to_string()).unwrap_or_default();
    console.say(&format!(
        "written    {path}, layer {} ({} input lines, {new} new lines, {vertices} vertices{beads}{stubs})",
        layer.name,
        layer.lines.len() - new
    ));
}
