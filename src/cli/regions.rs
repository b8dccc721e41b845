//! `tokosen regions`: contour lines in, the sub-domains between them out.

use std::path::{Path, PathBuf};

use clap::Args;
use tokosen::draw::preview::{Patch, PatchClass, Patches};
use tokosen::io::layer::of_landforms;
use tokosen::io::{StagedOutput, VectorFormat, write_layers_back};
use tokosen::subdivision::{Subdivision, subdivide_with_water};
use tokosen::subdomains::{Landform, LandformClass, landforms};

use super::console::Console;
use super::input::InputArgs;
use super::plane::ToCrsArgs;
use super::surface::FrameArgs;
use super::water::WaterArgs;
use super::{Failure, output, preview, summary};

/// The areas between contour lines, with their landform and what encloses them
///
/// Each area has the attributes id, class (peak, bottom of a basin, tableland, basin, ridge-peak, valley, slope,
/// water or branching), is_open (cut by the frame), band_lo and band_hi (the levels that it lies between), n_ib (number of contours
/// inside), mixture (what a branching one consists of), parent (id of the area that encloses it), depth (how many do) and
/// area (in units of the working CRS). Depressions are found from the contours around them.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct RegionsArgs {
    #[command(flatten)]
    input: InputArgs,
    /// Areas to write: .geojson, .gpkg, .fgb, .dxf (outlines alone) or .shp
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    output: PathBuf,
    #[command(flatten, next_help_heading = "Output")]
    to_crs: ToCrsArgs,
    /// Also draw a picture of areas and lines: .png
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    preview: Option<PathBuf>,
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
    if VectorFormat::from_path(&args.output).is_err() {
        let message = format!("{}: areas are written as .geojson, .gpkg, .fgb, .dxf or .shp", args.output.display());
        return Err(Failure::Usage(message));
    }
    let inputs: Vec<&Path> = args.input.map.files().chain(args.frame.file()).chain(args.water.file()).collect();
    let outputs: Vec<&Path> = std::iter::once(args.output.as_path()).chain(args.preview.as_deref()).collect();
    output::check_paths(&inputs, &outputs)?;
    let staged = output::open(&args.output)?;
    let picture = preview::open(args.preview.as_deref())?;

    let mut input = args.input.read(console)?;
    let frame = args.frame.read(&input)?;
    let water = args.water.read(&mut input)?;
    let back = args.to_crs.way(&input.places)?;
    let subdivision = subdivide_with_water(input.map, &frame, &water, console);
    let subdivision = summary::found(subdivision, &input.path, &mut input.findings, console)?;
    args.input.map.check_strict(&input.findings, console)?;
    let forms = console.step("landforms", || landforms(&subdivision.tin, &subdivision.regions));
    let layer = of_landforms(&forms, &subdivision.tin, &subdivision.regions);
    console.step("writing", || write_layers_back(&staged, &[layer], &back))?;
    if let Some(picture) = &picture {
        draw(picture, &subdivision, &forms, console)?;
    }

    summary::findings(&input.findings, console);
    args.input.map.describe(&subdivision.map, console);
    describe(&forms, console);
    let path = staged.target().to_owned();
    staged.commit()?;
    console.say(&format!("written    {} ({} areas)", path.display(), forms.len()));
    preview::commit(picture, console)?;
    summary::close(input.findings.len(), console);
    Ok(())
}

/// Draws the picture: areas by class, the contours above them.
fn draw(
    staged: &StagedOutput,
    subdivision: &Subdivision,
    forms: &[Landform],
    console: &Console,
) -> Result<(), Failure> {
    let class = |class: LandformClass| PatchClass { name: class.name().to_owned(), color: color(class) };
    let rings = |form: &Landform| form.rings.iter().map(|ring| ring.points(&subdivision.tin)).collect();
    let number = |form: &Landform| LandformClass::ALL.iter().position(|class| *class == form.class);
    let areas = forms.iter().filter_map(|form| Some(Patch { class: number(form)?, rings: rings(form) }));
    let patches = Patches { classes: LandformClass::ALL.map(class).to_vec(), areas: areas.collect() };
    preview::write_tiling(staged, subdivision, &[], Some(&patches), console)
}

/// Warm for high ground, cool for low.
fn color(class: LandformClass) -> [u8; 3] {
    match class {
        LandformClass::Peak => [196, 52, 40],
        LandformClass::Bottom => [36, 58, 150],
        LandformClass::Tableland => [232, 148, 66],
        LandformClass::Basin => [72, 148, 206],
        LandformClass::RidgePeak => [156, 52, 128],
        LandformClass::Valley => [38, 150, 132],
        LandformClass::Slope => [176, 190, 110],
        LandformClass::Water => [150, 200, 235],
        LandformClass::Branching => [238, 212, 84],
    }
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
