//! `tokosen mesh`: contour lines or a height map in, a 3-D model of the terrain out.

mod height_map;

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use tokosen::base::ElevationUnit;
use tokosen::crs::Reprojection;
use tokosen::draw::preview::{Model, render_model};
use tokosen::io::mesh::{MESH_EXTENSIONS, PRINT_EXTENSIONS, SURFACE_EXTENSIONS, flattened, placement, write_mesh};
use tokosen::io::{Content, PLATE_EXTENSIONS, StagedOutput};
use tokosen::mesh::{Keep, Light, Mesh, MeshParams, PrintParams};
use tokosen::plates::PlateParams;
use tokosen::surface::{Triangles, Uncertainty};
use tokosen::terrain::HtmlParams;
use tokosen::{GridSpec, Interval, Terrain};

use super::console::Console;
use super::extensions::{check_extension, extension};
use super::failure::Failure;
use super::input::{InputArgs, Scope};
use super::job::Job;
use super::part::PartArgs;
use super::picture::{Asked, Drawing};
use super::plates::{PlateArgs, millimetres};
use super::surface::SurfaceArgs;
use super::terrain_page::PAGE_EXTENSIONS;
use super::{plates, summary, terrain_page};

/// A 3-D model (triangle mesh) from contour lines or a height map
///
/// The model of contours holds the triangles of the surface inside the frame; the contours are among their edges. That of a height
/// map has two triangles between the centres of each four neighbouring cells, or few triangles with --tolerance; cells without data
/// are no ground. Coordinates are relative to an offset, which is recorded in the file and printed; heights are not changed.
///
/// The model is in the working CRS, in metres, whatever the CRS of the input and the unit of its heights: the three axes of a model
/// have one unit. If the cells of a height map are not on a plane in metres, heights are interpolated in cells that are. The model
/// of a drawing in feet without a CRS is in feet, on all three axes; a .glb is always in metres.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES, mut_arg("contours", |arg| arg.value_name("INPUT").help(INPUT_HELP)))]
pub struct MeshArgs {
    #[command(flatten)]
    input: InputArgs,
    /// Model to write: a page to look at in a browser (.html); PLY (.ply), Wavefront OBJ (.obj) or binary glTF (.glb); a surface of
    /// triangles in map coordinates: LandXML 1.2 (.xml), or DXF with a 3DFACE for each triangle (.dxf); a solid to print: STL
    /// (.stl) or 3MF (.3mf); with --thickness, plates to cut with a laser: .svg or .dxf
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    output: PathBuf,
    /// Close the model to a solid, with walls and a flat bottom at this height, as 3-D printing needs [m] [default for
    /// .stl and .3mf: 2 mm of the print below the lowest ground]
    #[arg(long, alias = "base", value_name = "HEIGHT", help_heading = "Output")]
    base_height: Option<f64>,
    /// Few triangles, none further than this from the surface at the centre of a cell. Contours are edges of them with --keep [m]
    /// [default: all triangles of the surface or between cells; in a page, a twentieth of the interval, or without one a
    /// five-hundredth of the relief]
    #[arg(long, value_name = "DISTANCE", help_heading = "Output")]
    tolerance: Option<f64>,
    /// Lines that stay edges of the triangles of --tolerance, or chains of edges, with all their vertices
    #[arg(long, value_enum, default_value_t = KeepArg::None, value_name = "contours|breaklines|none", help_heading = "Output")]
    keep: KeepArg,
    /// Size of the cells of --tolerance and of a page; for a height map, of a page alone [m] [default: those that the surface is
    /// made on; those of the height map]
    #[arg(long, value_name = "SIZE", help_heading = "Output")]
    cell: Option<f64>,
    /// Interval of new contours in a page, or between plates [metres]
    #[arg(short, long, value_name = "STEP", help_heading = "Output")]
    interval: Option<f64>,
    /// Expected errors as colours in a page
    #[arg(long, help_heading = "Output")]
    uncertainty: bool,
    /// Length of the longer side of a model to print or to cut [mm] [default: 180]
    #[arg(long, value_name = "LENGTH", value_parser = millimetres, help_heading = "Output")]
    size: Option<f64>,
    /// Factor on heights of a model to print or to cut
    #[arg(long, alias = "exaggerate", value_name = "FACTOR", help_heading = "Output")]
    exaggeration: Option<f64>,
    #[command(flatten, next_help_heading = "Output")]
    plates: PlateArgs,
    /// Also draw an oblique view of the model with its contours, ridge and canyon lines: .png
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    preview: Option<PathBuf>,
    #[command(flatten, next_help_heading = "Part of the map")]
    part: PartArgs,
    #[command(flatten)]
    surface: SurfaceArgs,
}

const INPUT_HELP: &str = "Contour lines (.geojson, .json, .gpkg, .shp, .fgb, .parquet, .dxf, .kml, .gml, .csv and others), a height map \
                          (.tif, .asc, .exr, .png, .xyz, LandXML triangles), or a .xml, .zip or folder of 基盤地図情報";

const EXAMPLES: &str = "\
Examples:
  tokosen mesh contours.gpkg -i 4 -o terrain.html
  tokosen mesh contours.gpkg --tolerance 0.5 -o terrain.glb
  tokosen mesh dem.tif --tolerance 0.5 -o terrain.glb
  tokosen mesh contours.gpkg --tolerance 0.5 --keep contours -o surface.xml
  tokosen mesh contours.shp -a ELEV -o print.ply --base-height 0
  tokosen mesh contours.gpkg --size 180mm --exaggeration 1.5 -o print.3mf
  tokosen mesh contours.gpkg --thickness 3mm -i 20 --size 300mm -o plates.svg
  tokosen mesh contours.gpkg --clip site.gpkg -o surface.xml
  tokosen mesh contours.geojson -o terrain.obj --frame bbox --preview look.png";

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum KeepArg {
    /// The contours of the input, and break lines
    Contours,
    /// Break lines
    Breaklines,
    /// No lines
    None,
}

/// What is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Form {
    Model,
    Surface,
    Print,
    Page,
    Plates,
}

impl MeshArgs {
    /// What the extension of the output asks for. Refuses flags that have no meaning for it.
    fn form(&self, console: &Console) -> Result<Form, Failure> {
        let forms: [(Form, &[&str]); 5] = [
            (Form::Page, &PAGE_EXTENSIONS),
            (Form::Model, &MESH_EXTENSIONS),
            (Form::Print, &PRINT_EXTENSIONS),
            (Form::Surface, &SURFACE_EXTENSIONS),
            (Form::Plates, &PLATE_EXTENSIONS),
        ];
        let mut known: Vec<&str> = forms.iter().flat_map(|(_, extensions)| *extensions).copied().collect();
        known.dedup();
        check_extension(&self.output, "models", &known)?;
        let kind = extension(&self.output);
        let is_own = |(form, own): &(Form, &[&str])| own.contains(&kind.as_str()).then_some(*form);
        let is_asked = |form: &Form| *form == Form::Plates || self.plates.thickness.is_none() || kind != "dxf";
        let form = forms.iter().filter_map(is_own).find(is_asked).unwrap_or(Form::Model);
        let usage = |message: String| Err(Failure::Usage(message));
        for (flags, meaning, fits) in [
            (
                &["--base-height"][..],
                "makes a solid: write .ply, .obj, .glb, .stl or .3mf",
                matches!(form, Form::Model | Form::Print),
            ),
            (&["--thickness", "--sheet"], "is for plates: write .svg or .dxf", form == Form::Plates),
            (
                &["--size", "--exaggeration"],
                "is for models to print or to cut: write .stl or .3mf, or plates with --thickness",
                matches!(form, Form::Print | Form::Plates),
            ),
            (
                &["--interval"],
                "is for pages and plates: write .html, or give --thickness",
                matches!(form, Form::Page | Form::Plates),
            ),
            (&["--uncertainty"], "is for pages: write .html", form == Form::Page),
            (&["--preview"], "is for models: a page shows the terrain itself", form != Form::Page),
            (&["--preview", "--tolerance", "--cell", "--keep"], "is not for plates", form != Form::Plates),
            (&["--keep"], "is for models: a page shows the lines themselves", form != Form::Page),
            (&["--keep"], "needs --tolerance: without it, all lines are edges", self.tolerance.is_some()),
            (&["--cell"], "needs --tolerance", form == Form::Page || self.tolerance.is_some()),
        ] {
            if let Some(flag) = console.flags.first(flags).filter(|_| !fits) {
                return usage(format!("{}: {flag} {meaning}", self.output.display()));
            }
        }
        if form == Form::Plates && self.plates.thickness.is_none() {
            return usage(format!("{}: plates need --thickness, such as 3mm", self.output.display()));
        }
        let lengths = [
            ("--tolerance", self.tolerance),
            ("--cell", self.cell),
            ("--interval", self.interval),
            ("--exaggeration", self.exaggeration),
        ];
        match lengths.into_iter().find(|(_, value)| value.is_some_and(|v| !(v.is_finite() && v > 0.0))) {
            Some((flag, value)) => usage(format!("{flag} is {}, it must be more than 0", value.unwrap_or_default())),
            None => Ok(form),
        }
    }

    /// The plates that are asked for.
    fn plates(&self) -> Result<Option<PlateParams>, Failure> {
        let PlateArgs { thickness, sheet } = self.plates;
        thickness
            .map(|thickness| plates::params(thickness, sheet, self.size, (self.interval, self.exaggeration)))
            .transpose()
    }

    /// How few triangles there are to be, and where.
    fn light(&self) -> Option<Light> {
        let keep = match self.keep {
            KeepArg::Contours => Keep::Contours,
            KeepArg::Breaklines => Keep::BreakLines,
            KeepArg::None => Keep::Nothing,
        };
        self.tolerance.map(|tolerance| Light { tolerance, cell: self.cell, keep })
    }

    /// Writes the model, and draws its picture. Gives the model that was written.
    fn write(
        &self,
        form: Form,
        terrain: &Terrain,
        staged: &StagedOutput,
        job: &mut Job<'_>,
        console: &Console,
    ) -> Result<Mesh, Failure> {
        let base = self.base_height.filter(|_| form != Form::Print);
        let model = terrain.mesh(&MeshParams { base, light: self.light() })?;
        let written = self.write_model(form, &model, (&terrain.reprojection, staged), console)?;
        if job.draws() {
            let contours = &terrain.input_contours()?.lines;
            let skeleton_lines = &terrain.surface.skeleton_lines;
            let shown = Model { mesh: &model, contours, skeleton_lines, units: console.units(), title: None };
            job.draw(&Drawing::Image(render_model(&shown)?))?;
        }
        Ok(written)
    }

    /// Writes a model, which is in metres, as its file is to have it. Gives the model that was written.
    fn write_model(
        &self,
        form: Form,
        model: &Mesh,
        (reprojection, staged): (&Reprojection, &StagedOutput),
        console: &Console,
    ) -> Result<Mesh, Failure> {
        let written = match form {
            Form::Print => {
                let usual = PrintParams::default();
                let size = self.size.unwrap_or(usual.size);
                let exaggeration = self.exaggeration.unwrap_or(usual.exaggeration);
                model.printed(&PrintParams { size, exaggeration, base: self.base_height })?
            }
            _ => model.in_drawing(reprojection).unwrap_or_else(|| model.clone()),
        };
        console.step("writing", || write_mesh(&staged.path(), &written)).map_err(|e| staged.with_final_name(e))?;
        Ok(written)
    }

    /// What a page shows.
    fn page(&self) -> HtmlParams {
        HtmlParams {
            title: self.input.map.title(),
            target: self.interval.map(|step| Interval::every(step).into()),
            cell: self.cell,
            tolerance: self.tolerance,
            ..HtmlParams::default()
        }
    }
}

/// Runs the verb.
pub fn run(args: &MeshArgs, console: &Console) -> Result<(), Failure> {
    let form = args.form(console)?;
    let plates = args.plates()?;
    if args.input.map.content()? == Content::HeightMap {
        return height_map::run(args, form, plates, console);
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
    let grid = args.cell.map(GridSpec::Cell);
    let mut options = args.surface.options(grid.as_ref(), Triangles::Smooth, ElevationUnit::Metre)?;
    options.uncertainty = if args.uncertainty { Uncertainty::Learnt } else { Uncertainty::Unknown };
    let mut terrain = job.build(&mut input, &args.surface, options)?;
    let written = match (form, plates) {
        (Form::Page, _) => {
            terrain_page::write(&staged, &terrain, &args.page(), console)?;
            Written::Page
        }
        (_, Some(params)) => {
            let made = terrain.plates(&params, console)?.collect(&mut terrain.findings);
            let scale = terrain.plate_scale(&params);
            let made = plates::write((made, params, scale), &staged, &args.input.map.files()?, console)?;
            job.check_strict(&terrain.findings)?;
            Written::Plates(made)
        }
        _ => Written::Model(args.write(form, &terrain, &staged, &mut job, console)?),
    };

    job.report(&terrain.findings, &terrain.surface.map);
    summary::surface(&terrain.surface, &terrain.findings, console);
    written.commit(form, staged, console)?;
    job.close_part(terrain.findings.len(), terrain.findings_outside)
}

/// What was written, still under a temporary name.
enum Written {
    Model(Mesh),
    Page,
    Plates(plates::Made),
}

impl Written {
    /// Gives the files their names, and prints what is in them.
    fn commit(&self, form: Form, staged: StagedOutput, console: &Console) -> Result<(), Failure> {
        match self {
            Self::Model(mesh) => describe(&staged.commit()?, mesh, form, console),
            Self::Page => terrain_page::commit(staged, console)?,
            Self::Plates(made) => made.commit(staged, console)?,
        }
        Ok(())
    }
}

/// The lines of the summary about a model.
fn describe(path: &Path, mesh: &Mesh, form: Form, console: &Console) {
    let (lo, hi) = mesh.extent();
    let unit = mesh.unit.as_ref().map_or("m".to_owned(), |unit| match ElevationUnit::of_size(unit.metres) {
        Some(known) => known.name().to_owned(),
        None => unit.name.clone(),
    });
    let size = hi - lo;
    let unit = if form == Form::Print { "mm".to_owned() } else { unit };
    let offset = match form {
        Form::Model => format!(", offset {} {} {}", mesh.origin.x, mesh.origin.y, mesh.origin.z),
        _ => String::new(),
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
    if form != Form::Print {
        console.say(&format!("           {}", placement(path, mesh)));
    }
    let flat = flattened(path, mesh);
    if flat > 0 {
        console.say(&format!(
            "           {flat} narrow triangles are flat in the single precision of .glb; .ply and .obj are exact"
        ));
    }
}
