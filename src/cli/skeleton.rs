//! `tokosen skeleton`: contour lines in, ridge and canyon lines out.

use std::path::{Path, PathBuf};

use clap::Args;
use tokosen::base::error::Error;
use tokosen::draw::preview::{Patch, PatchClass, Patches};
use tokosen::io::layer::{curve_mesh, skeleton_lines, skeleton_triangles};
use tokosen::io::{VectorFormat, contour_files, write_layers_back};
use tokosen::skeleton::{BreakKind, BreakLine, LineEnd, Skeleton, junction_edges, skeleton};
use tokosen::subdivision::subdivide_with_water;
use tokosen::tin::{Tin, TriangleKind};
use tokosen::tuning::SkeletonTuning;

use super::console::Console;
use super::input::InputArgs;
use super::plane::ToCrsArgs;
use super::surface::FrameArgs;
use super::water::WaterArgs;
use super::{Failure, output, preview, summary};

/// Ridge and canyon lines with heights
///
/// Lines along spurs, crests, gullies and valley floors, in the layer skeleton. Each runs downhill within one sub-domain
/// (the ground between neighbouring contours) and has the attributes kind (ridge or canyon), region (its sub-domain),
/// network (lines that meet have the same), length (in units of the working CRS), upper_end and lower_end (contour, junction, peak, bottom, saddle,
/// frame, spot), upper_z and lower_z. They are the lines that the surface of the other verbs is made with.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct SkeletonArgs {
    #[command(flatten)]
    input: InputArgs,
    /// Lines to write: .geojson, .gpkg, .fgb, .dxf or .shp. With several layers a GeoPackage holds them all, the other
    /// formats have a file each
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    output: PathBuf,
    /// Also write the layer triangles: the triangulation, with kind (terminal, sleeve, junction, eliminated), region, band
    #[arg(long, help_heading = "Output")]
    triangles: bool,
    /// Also write the layer curve_mesh: contours, edges of the junction triangles that were kept, ridge and canyon lines
    #[arg(long, help_heading = "Output")]
    curve_mesh: bool,
    #[command(flatten, next_help_heading = "Output")]
    to_crs: ToCrsArgs,
    /// Also draw a picture of ground and lines: .png
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    preview: Option<PathBuf>,
    #[command(flatten)]
    frame: FrameArgs,
    #[command(flatten, next_help_heading = "Surface")]
    water: WaterArgs,
    /// Resolution parameter w of the method: more of it, fewer ridge and canyon lines
    #[arg(long, value_name = "W", default_value_t = 1.0, allow_negative_numbers = true, help_heading = "Surface")]
    resolution: f64,
}

const EXAMPLES: &str = "\
Examples:
  tokosen skeleton contours.gpkg -o lines.gpkg
  tokosen skeleton contours.shp -a ELEV -o lines.shp --resolution 2 --preview look.png
  tokosen skeleton contours.geojson -o all.gpkg --triangles --curve-mesh";

/// Runs the verb.
pub fn run(args: &SkeletonArgs, console: &Console) -> Result<(), Failure> {
    if VectorFormat::from_path(&args.output).is_err() {
        let message = format!("{}: lines are written as .geojson, .gpkg, .fgb, .dxf or .shp", args.output.display());
        return Err(Failure::Usage(message));
    }
    if !args.resolution.is_finite() || args.resolution < 0.0 {
        return Err(Failure::Usage(format!("--resolution is {}, it must be 0 or more", args.resolution)));
    }
    let mut names = vec!["skeleton"];
    names.extend(args.triangles.then_some("triangles"));
    names.extend(args.curve_mesh.then_some("curve_mesh"));
    let files = contour_files(&args.output, &names)?;
    let inputs: Vec<&Path> = args.input.map.files().chain(args.frame.file()).chain(args.water.file()).collect();
    let outputs: Vec<&Path> = files.iter().map(PathBuf::as_path).chain(args.preview.as_deref()).collect();
    output::check_paths(&inputs, &outputs)?;
    let staged = output::open(&args.output)?;
    let picture = preview::open(args.preview.as_deref())?;

    let mut input = args.input.read(console)?;
    let back = args.to_crs.way(&input.places)?;
    let frame = args.frame.read(&input)?;
    let water = args.water.read(&mut input)?;
    let subdivision = subdivide_with_water(input.map, &frame, &water, console);
    let subdivision = summary::found(subdivision, &input.path, &mut input.findings, console)?;
    args.input.map.check_strict(&input.findings, console)?;
    let tuning = SkeletonTuning::default();
    let found = console
        .step("ridge and canyon lines", || skeleton(&subdivision.tin, &subdivision.regions, args.resolution, &tuning));
    let written = console.step("writing", || -> Result<Vec<PathBuf>, Error> {
        let mut layers = vec![skeleton_lines(&found)];
        if args.triangles {
            layers.push(skeleton_triangles(&subdivision, &found));
        }
        let edges;
        if args.curve_mesh {
            edges = junction_edges(&subdivision.tin, &subdivision.regions, &found);
            layers.push(curve_mesh(&subdivision, &found, &edges));
        }
        write_layers_back(&staged, &layers, &back)
    })?;
    if let Some(picture) = &picture {
        let patches = args.triangles.then(|| triangles_by_kind(&subdivision.tin, &found));
        preview::write_tiling(picture, &subdivision, &found.lines, patches.as_ref(), console)?;
    }

    summary::findings(&input.findings, console);
    args.input.map.describe(&subdivision.map, console);
    describe(&found, args.resolution, console);
    staged.commit()?;
    for (k, name) in names.iter().enumerate() {
        let path = written.get(k).or(written.first()).map(|p| p.display().to_string()).unwrap_or_default();
        console.say(&format!("written    {path}, layer {name}"));
    }
    preview::commit(picture, console)?;
    summary::close(input.findings.len(), console);
    Ok(())
}

/// The triangles for the picture, coloured by kind.
fn triangles_by_kind(tin: &Tin, skeleton: &Skeleton) -> Patches {
    let class = |(name, color): (&str, [u8; 3])| PatchClass { name: name.to_owned(), color };
    let classes = [
        ("terminal", [226, 124, 60]),
        ("sleeve", [240, 222, 130]),
        ("junction", [70, 110, 190]),
        ("eliminated", [150, 150, 150]),
    ];
    let number = |t: u32| match skeleton.kinds[t as usize] {
        TriangleKind::Terminal => Some(0),
        TriangleKind::Sleeve => Some(1),
        TriangleKind::Junction if skeleton.elimination.eliminated[t as usize] => Some(3),
        TriangleKind::Junction => Some(2),
        TriangleKind::Isolated | TriangleKind::Outside => None,
    };
    let ring = |t: u32| [0, 1, 2, 0].map(|i| tin.point(tin.triangles[t as usize][i]).truncate()).to_vec();
    let areas = (0..tin.len() as u32).filter_map(|t| Some(Patch { class: number(t)?, rings: vec![ring(t)] }));
    Patches { classes: classes.map(class).to_vec(), areas: areas.collect() }
}

/// The lines of the summary about ridge and canyon lines.
fn describe(skeleton: &Skeleton, resolution: f64, console: &Console) {
    for (name, kind) in [("ridges", BreakKind::Ridge), ("canyons", BreakKind::Canyon)] {
        let lines: Vec<&BreakLine> = skeleton.lines.iter().filter(|l| l.kind == kind).collect();
        let length = lines.iter().map(|l| l.length()).fold(0.0, |sum, length| sum + length);
        let ends = |wanted| lines.iter().flat_map(|l| l.ends).filter(|end| *end == wanted).count();
        console.say(&format!(
            "{name:<10} {} lines, length {length:.0}; ends: {} at contours, {} at junctions, {} at the frame",
            lines.len(),
            ends(LineEnd::Contour),
            ends(LineEnd::Junction),
            ends(LineEnd::Frame),
        ));
    }
    let networks = skeleton.lines.iter().map(|l| l.network + 1).max().unwrap_or(0);
    let eliminated = skeleton.elimination.eliminated.iter().filter(|e| **e).count();
    console.say(&format!("skeleton   {networks} networks, {eliminated} junctions eliminated at w = {resolution}"));
    if skeleton.elimination.limited > 0 {
        console.say(&format!(
            "note       w = {resolution} is below the method's lower limit at {} junctions; there the limit was used",
            skeleton.elimination.limited
        ));
    }
    if skeleton.flow.moved > 0 {
        console.say(&format!(
            "heights    {} points were moved, by {:.2} m at most, so that lines fall steadily",
            skeleton.flow.moved, skeleton.flow.most_moved
        ));
    }
}
