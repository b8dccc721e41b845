//! `tokosen regions`: contour lines in, the sub-domains between them out.

use std::path::PathBuf;

use clap::Args;
use tokosen::draw::Scene;
use tokosen::draw::preview::landform_patches;
use tokosen::io::layer::{REGIONS_LAYER, of_landforms};
use tokosen::io::{PlannedOutput, StagedOutput, write_layers_back};
use tokosen::subdomains::{Landform, LandformClass, landforms};
use tokosen::terrain::clip_areas;

use super::console::Console;
use super::extensions::check_vector;
use super::failure::Failure;
use super::features::{self, WaterArgs, paths};
use super::input::{InputArgs, Scope};
use super::job::Job;
use super::part::PartArgs;
use super::picture::{Asked, Drawing, PictureArgs};
use super::plane::ToCrsArgs;
use super::surface::FrameArgs;
use super::unit::{ToUnitArgs, in_units};

/// The areas between contour lines, with their landforms and nesting
///
/// Each area has the attributes id, class (peak, bottom of a basin, tableland, basin, ridge-peak, valley, slope, water
/// or branching), is_open (cut by the frame), band_lo and band_hi (the levels below and above it; metres, or the unit
/// of --to-unit), n_ib (number of contours inside), mixture (the landforms of a branching one), parent (id of the
/// enclosing area), depth (number of enclosing areas) and area (in units of the working CRS). Depressions are found
/// from the contours around them.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct RegionsArgs {
    #[command(flatten)]
    input: InputArgs,
    /// Areas to write: .geojson, .gpkg, .fgb, .parquet, .dxf (outlines alone) or .shp
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    output: PathBuf,
    #[command(flatten, next_help_heading = "Output")]
    to_crs: ToCrsArgs,
    #[command(flatten, next_help_heading = "Output")]
    to_unit: ToUnitArgs,
    #[command(flatten, next_help_heading = "Output")]
    picture: PictureArgs,
    #[command(flatten, next_help_heading = "Part of the map")]
    part: PartArgs,
    #[command(flatten, next_help_heading = "Surface")]
    frame: FrameArgs,
    #[command(flatten, next_help_heading = "Surface")]
    water: WaterArgs,
}

const EXAMPLES: &str = "\
Examples:
  tokosen regions contours.gpkg -o regions.gpkg
  tokosen regions contours.shp -a ELEV -o regions.shp --preview regions.png
  tokosen regions contours.geojson -o regions.geojson --frame sheet.geojson";

/// Runs the verb.
pub fn run(args: &RegionsArgs, console: &Console) -> Result<(), Failure> {
    check_vector(&args.output, "areas are written as .geojson, .gpkg, .fgb, .parquet, .dxf, .shp, .kml or .kmz")?;
    args.to_crs.check(&args.output)?;
    let inputs = args.frame.file().into_iter().chain(args.part.file()).chain(paths(args.water.sources()));
    let output = PlannedOutput { path: &args.output, layers: &[REGIONS_LAYER] };
    let mut job = Job::start(&args.input, inputs, [output], Asked::Map(&args.picture), console)?;
    let staged = StagedOutput::create(&args.output)?;

    let unit = args.to_unit.unit();
    let sea = args.water.sea_in_metres(unit);
    let mut input = job.read(Scope { part: Some(&args.part), sea, ..Scope::of(&args.frame) })?;
    args.water.check()?;
    features::add(args.water.sources(), &mut input)?;
    let back = args.to_crs.way(Some(&args.output), &input.reprojection, unit)?;
    let (subdivision, part) = job.subdivide(&mut input, &args.water, unit)?;
    let forms = console.step("landforms", || landforms(&subdivision.tin, &subdivision.regions));
    let mut layer = of_landforms(&forms, &subdivision.tin, &subdivision.regions);
    layer = part.iter().fold(layer, clip_areas);
    let written = layer.rows.len();
    console.step("writing", || write_layers_back(&staged, &[layer], &back))?;
    let units = args.to_unit.drawn(console.units());
    if job.draws() {
        let patches = landform_patches(&forms, &subdivision.tin);
        let scene = Scene::of_subdivision(&subdivision, &[], Some(&patches), &input.reprojection, units);
        job.draw(&Drawing::Map(scene.within(part.as_ref())))?;
    }

    job.report(&input.findings, &subdivision.map);
    describe(&forms, console);
    let path = staged.commit()?;
    console.say(&format!("written    {} ({} areas{})", path.display(), written, in_units(&back)));
    job.close_part(input.findings.len(), input.findings_outside)
}

/// The lines of the summary about sub-domains.
fn describe(forms: &[Landform], console: &Console) {
    let count = |class| forms.iter().filter(|form| form.class == class).count();
    let classes: Vec<String> = LandformClass::ALL
        .into_iter()
        .map(|class| (class, count(class)))
        .filter(|(_, count)| *count > 0)
        .map(|(class, count)| format!("{count} {}", class.name()))
        .collect();
    console.say(&format!("regions    {} sub-domains: {}", forms.len(), classes.join(", ")));
    let open = forms.iter().filter(|form| form.is_open).count();
    let deepest = forms.iter().map(|form| form.depth).max().unwrap_or(0);
    console.say(&format!("nesting    {deepest} deep at most; {open} sub-domains are open at the frame or at a gap"));
}
