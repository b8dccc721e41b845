//! `tokosen skeleton`: contour lines in, ridge and canyon lines out.

use std::path::PathBuf;

use clap::Args;
use tokosen::draw::Scene;
use tokosen::draw::preview::triangle_patches;
use tokosen::io::layer::{curve_mesh, skeleton_lines, skeleton_triangles};
use tokosen::io::{PlannedOutput, StagedOutput, contour_files, write_layers_back};
use tokosen::skeleton::{LineEnd, Skeleton, SkeletonKind, SkeletonLine, junction_edges, skeleton};
use tokosen::terrain::{clip_edges, clip_skeleton, clip_streams, clip_subdivision};
use tokosen::tuning::SkeletonTuning;

use super::console::Console;
use super::extensions::check_vector;
use super::failure::Failure;
use super::features::{self, StreamArgs, WaterArgs, paths};
use super::input::{InputArgs, Scope};
use super::job::Job;
use super::part::PartArgs;
use super::picture::{Asked, Drawing, PictureArgs};
use super::plane::ToCrsArgs;
use super::summary;
use super::surface::FrameArgs;
use super::unit::{ToUnitArgs, in_units};

/// Ridge and canyon lines with heights
///
/// Lines along spurs, crests, gullies and valley floors, in the layer skeleton. Each runs downhill within one
/// sub-domain (the ground between neighbouring contours) and has the attributes kind (ridge or canyon), given (whether it
/// is a stream of --streams; these run through several sub-domains), region (its
/// sub-domain), network (the same for lines that meet), length (in units of the working CRS), upper_end and lower_end
/// (contour, junction, peak, bottom, saddle, frame, spot), upper_z and lower_z (heights in metres, or in the unit of
/// --to-unit, as the z of the vertices). The surface contains these lines.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct SkeletonArgs {
    #[command(flatten)]
    input: InputArgs,
    /// Lines to write: .geojson, .gpkg, .fgb, .parquet, .dxf, .shp, .kml or .kmz. With several layers, a GeoPackage holds all of them;
    /// other formats get one file per layer
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    output: PathBuf,
    /// Also write the layer triangles: triangles with kind (terminal, sleeve, junction, eliminated), region, band
    #[arg(long, help_heading = "Output")]
    triangles: bool,
    /// Also write the layer curve_mesh: contours, edges of kept junction triangles, ridge and canyon lines
    #[arg(long, help_heading = "Output")]
    curve_mesh: bool,
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
    #[command(flatten, next_help_heading = "Surface")]
    streams: StreamArgs,
    /// Resolution parameter w of the method: larger values give fewer ridge and canyon lines
    #[arg(long, value_name = "W", default_value_t = 1.0, help_heading = "Surface")]
    resolution: f64,
}

const EXAMPLES: &str = "\
Examples:
  tokosen skeleton contours.gpkg -o lines.gpkg
  tokosen skeleton contours.shp -a ELEV -o lines.shp --resolution 2 --preview look.png
  tokosen skeleton contours.geojson -o all.gpkg --triangles --curve-mesh";

/// Runs the verb.
pub fn run(args: &SkeletonArgs, console: &Console) -> Result<(), Failure> {
    check_vector(&args.output, "lines are written as .geojson, .gpkg, .fgb, .parquet, .dxf, .shp, .kml or .kmz")?;
    args.to_crs.check(&args.output)?;
    if !args.resolution.is_finite() || args.resolution < 0.0 {
        return Err(Failure::Usage(format!("--resolution is {}, it must be 0 or more", args.resolution)));
    }
    let mut names = vec!["skeleton"];
    names.extend(args.triangles.then_some("triangles"));
    names.extend(args.curve_mesh.then_some("curve_mesh"));
    let files = contour_files(&args.output, &names)?;
    let lines = [args.water.sources(), args.streams.sources()].concat();
    let inputs = args.frame.file().into_iter().chain(args.part.file()).chain(paths(lines.clone()));
    let outputs = files.iter().map(|path| PlannedOutput { path, layers: &names });
    let mut job = Job::start(&args.input, inputs, outputs, Asked::Map(&args.picture), console)?;
    let staged = StagedOutput::create(&args.output)?;

    let unit = args.to_unit.unit();
    let sea = args.water.sea_in_metres(unit);
    let mut input = job.read(Scope { part: Some(&args.part), sea, ..Scope::of(&args.frame) })?;
    let back = args.to_crs.way(Some(&args.output), &input.reprojection, unit)?;
    args.water.check()?;
    features::add(lines, &mut input)?;
    let (mut subdivision, part) = job.subdivide(&mut input, &args.water, unit)?;
    let mut streams = input.settle_streams(&subdivision, args.streams.stream_tolerance, console)?;
    let tuning = SkeletonTuning::default();
    let mut found = console
        .step("ridge and canyon lines", || skeleton(&subdivision.tin, &subdivision.regions, args.resolution, &tuning));
    let mut edges =
        if args.curve_mesh { junction_edges(&subdivision.tin, &subdivision.regions, &found) } else { Vec::new() };
    if let Some(area) = &part {
        clip_skeleton(&mut found, area);
        clip_streams(&mut streams, area);
        clip_edges(&mut edges, area);
        subdivision = clip_subdivision(subdivision, area);
    }
    let written = console.step("writing", || {
        let mut layers = vec![skeleton_lines(&found, &streams)];
        if args.triangles {
            layers.push(skeleton_triangles(&subdivision, &found));
        }
        if args.curve_mesh {
            layers.push(curve_mesh(&subdivision, &found, &edges));
        }
        write_layers_back(&staged, &layers, &back)
    })?;
    let units = args.to_unit.drawn(console.units());
    if job.draws() {
        let patches = args.triangles.then(|| triangle_patches(&subdivision.tin, &found));
        let scene = Scene::of_subdivision(&subdivision, &found.lines, patches.as_ref(), &input.reprojection, units);
        job.draw(&Drawing::Map(scene.within(part.as_ref())))?;
    }

    job.report(&input.findings, &subdivision.map);
    describe(&found, args.resolution, console);
    summary::streams(&streams, console);
    staged.commit()?;
    for (k, name) in names.iter().enumerate() {
        let path = written.get(k).or(written.first()).map(|p| p.display().to_string()).unwrap_or_default();
        console.say(&format!("written    {path}, layer {name}{}", in_units(&back)));
    }
    job.close_part(input.findings.len(), input.findings_outside)
}

/// The lines of the summary about ridge and canyon lines.
fn describe(skeleton: &Skeleton, resolution: f64, console: &Console) {
    for (name, kind) in [("ridges", SkeletonKind::Ridge), ("canyons", SkeletonKind::Canyon)] {
        let lines: Vec<&SkeletonLine> = skeleton.lines.iter().filter(|l| l.kind == kind).collect();
        let length = lines.iter().map(|l| l.length()).fold(0.0, |sum, length| sum + length);
        let ends = |wanted| lines.iter().flat_map(|l| l.ends).filter(|end| *end == wanted).count();
        console.say(&format!(
            "{name:<10} {} lines, length {}; ends: {} at contours, {} at junctions, {} at the frame",
            lines.len(),
            console.units().length(length),
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
            "heights    {} points of lines changed, by {} at most, because lines must fall steadily",
            skeleton.flow.moved,
            console.units().rough_height(skeleton.flow.most_moved)
        ));
    }
}
