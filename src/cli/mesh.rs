//! `tokosen mesh`: contour lines in, a 3-D model of the terrain out.

use std::path::{Path, PathBuf};

use clap::Args;
use tokosen::base::ElevationUnit;
use tokosen::draw::preview::{Model, render_model};
use tokosen::io::StagedOutput;
use tokosen::io::mesh::{MESH_EXTENSIONS, SURFACE_EXTENSIONS, flattened, placement, write_mesh};
use tokosen::mesh::{Mesh, MeshParams};
use tokosen::surface::Triangles;

use super::console::Console;
use super::failure::Failure;
use super::input::{InputArgs, Scope};
use super::job::Job;
use super::part::PartArgs;
use super::picture::{Asked, Drawing};
use super::surface::SurfaceArgs;
use super::{output, summary};

/// A 3-D model (triangle mesh) from contour lines
///
/// The model holds the triangles of the surface inside the frame; the contours are among their edges. Coordinates are
/// relative to an offset, which is recorded in the file and printed; heights are not changed. The model is in the working
/// CRS, in metres, whatever the CRS of the contours and the unit of their elevations: the three axes of a model have
/// one unit. The model of a drawing in feet without a CRS is in feet, on all three axes; a .glb is always in metres.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct MeshArgs {
    #[command(flatten)]
    input: InputArgs,
    /// Model to write: PLY (.ply), Wavefront OBJ (.obj) or binary glTF (.glb); or a surface of triangles in map coordinates:
    /// LandXML 1.2 (.xml), or DXF with a 3DFACE for each triangle (.dxf)
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    output: PathBuf,
    /// Close the model to a solid, with walls and a flat bottom at this height, as 3-D printing needs [m]
    #[arg(long, alias = "base", value_name = "HEIGHT", help_heading = "Output")]
    base_height: Option<f64>,
    /// Also draw an oblique view of the model with its contours, ridge and canyon lines: .png
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    preview: Option<PathBuf>,
    #[command(flatten, next_help_heading = "Part of the map")]
    part: PartArgs,
    #[command(flatten)]
    surface: SurfaceArgs,
}

const EXAMPLES: &str = "\
Examples:
  tokosen mesh contours.gpkg -o terrain.glb
  tokosen mesh contours.shp -a ELEV -o print.ply --base-height 0
  tokosen mesh contours.gpkg --clip site.gpkg -o surface.xml
  tokosen mesh contours.geojson -o terrain.obj --frame bbox --preview look.png";

/// Runs the verb.
pub fn run(args: &MeshArgs, console: &Console) -> Result<(), Failure> {
    output::check_extension(&args.output, "models", &[MESH_EXTENSIONS.as_slice(), &SURFACE_EXTENSIONS].concat())?;
    let is_surface = output::check_extension(&args.output, "surfaces", &SURFACE_EXTENSIONS).is_ok();
    if args.base_height.is_some() && is_surface {
        return Err(Failure::Usage(
            "--base-height makes a solid, which .xml and .dxf cannot hold: write .ply, .obj or .glb".into(),
        ));
    }
    args.surface.check(&console.flags)?;
    let mut job = Job::start(
        &args.input,
        args.surface.files().chain(args.part.file()),
        [args.output.as_path()],
        Asked::Model(args.preview.as_deref()),
        console,
    )?;
    let staged = StagedOutput::create(&args.output)?;

    let mut input =
        job.read(Scope { part: Some(&args.part), sea: args.surface.water.sea, ..Scope::of(&args.surface.frame) })?;
    let terrain =
        job.build(&mut input, &args.surface, args.surface.options(None, Triangles::Smooth, ElevationUnit::Metre)?)?;
    let model = terrain.mesh(&MeshParams { base: args.base_height })?;
    // The picture is drawn in metres.
    let of_drawing = model.in_drawing(&terrain.reprojection);
    let written = of_drawing.as_ref().unwrap_or(&model);
    console.step("writing", || write_mesh(&staged.path(), written)).map_err(|e| staged.with_final_name(e))?;
    if job.draws() {
        let contours = &terrain.input_contours()?.lines;
        let break_lines = &terrain.surface.break_lines;
        let shown = Model { mesh: &model, contours, break_lines, units: console.units(), title: None };
        job.draw(&Drawing::Image(render_model(&shown)?))?;
    }

    job.report(&terrain.findings, &terrain.surface.map);
    summary::surface(&terrain.surface, console);
    describe(&staged.commit()?, written, console);
    job.close_part(terrain.findings.len(), terrain.findings_outside)
}

/// The lines of the summary about a model.
fn describe(path: &Path, mesh: &Mesh, console: &Console) {
    let (lo, hi) = mesh.extent();
    let unit = mesh.unit.as_ref().map_or("m".to_owned(), |unit| match ElevationUnit::of_size(unit.metres) {
        Some(known) => known.name().to_owned(),
        None => unit.name.clone(),
    });
    let size = hi - lo;
    let is_surface = output::check_extension(path, "surfaces", &SURFACE_EXTENSIONS).is_ok();
    let offset = match is_surface {
        true => String::new(),
        false => format!(", offset {} {} {}", mesh.origin.x, mesh.origin.y, mesh.origin.z),
    };
    let kind = if mesh.base.is_some() { "solid" } else { "shell" };
    console.say(&format!(
        "written    {} ({kind}, {} vertices, {} triangles, {:.2} x {:.2}, heights {:.2} to {:.2} {unit}{offset})",
        path.display(),
        mesh.vertices.len(),
        mesh.triangles.len(),
        size.x,
        size.y,
        lo.z,
        hi.z,
    ));
    console.say(&format!("           {}", placement(path, mesh)));
    let flat = flattened(path, mesh);
    if flat > 0 {
        console.say(&format!(
            "           {flat} narrow triangles are flat in the single precision of .glb; .ply and .obj are exact"
        ));
    }
}
