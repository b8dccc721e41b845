//! 3-D models of height maps.

use std::path::Path;

use geo::MultiPolygon;
use tokosen::base::error::{Error, Finding, FindingKind};
use tokosen::draw::preview::{Model, render_model};
use tokosen::io::StagedOutput;
use tokosen::io::raster::read_dem;
use tokosen::plates::PlateParams;
use tokosen::raster::{Dem, in_plane_unit, metres_per_unit};
use tokosen::terrain::{DemModel, all_right};

use super::{Form, MeshArgs, Written};
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::input::InputArgs;
use crate::cli::picture::{Asked, Drawing};
use crate::cli::surface::about_surface;
use crate::cli::unit::UnitArg;
use crate::cli::{memory, plates, summary, terrain_page};

/// Makes a model of a height map.
pub fn run(args: &MeshArgs, form: Form, plates: Option<PlateParams>, console: &Console) -> Result<(), Failure> {
    let path = args.input.map.file();
    check(args, form, console)?;
    let asked = Asked::Model(args.preview.as_deref());
    let outputs: Vec<_> = [args.output.as_path()].into_iter().chain(asked.file()).map(Into::into).collect();
    console.check_paths(&[path].into_iter().chain(args.part.file()).collect::<Vec<_>>(), &outputs)?;
    let mut picture = asked.open(&console.flags)?;
    let staged = StagedOutput::create(&args.output)?;
    console.plan(["reading"]);
    console.plan((form == Form::Plates).then_some("plates"));
    console.plan((form != Form::Plates).then_some("triangles"));
    console.plan(["writing"]);
    console.plan(picture.as_ref().map(|_| "drawing"));

    let (dem, mut findings) = read(args, console)?;
    let about = format!("input      {} ({} x {} cells)", path.display(), dem.grid.cols, dem.grid.rows);
    let part = args.part.on(&dem)?;
    let model = model(dem, part, path)?;
    let written = match (form, plates) {
        (Form::Page, _) => {
            terrain_page::put(&staged, &model.to_html(&args.page(), console)?, console)?;
            Written::Page
        }
        (_, Some(params)) => {
            let made = model.plates(&params, console)?.collect(&mut findings);
            let made = (made, params, model.plate_scale(&params)?);
            Written::Plates(plates::write(made, &staged, &args.input.map.files()?, console)?)
        }
        _ => {
            let shell = console.step("triangles", || model.mesh(args.tolerance))?;
            let base = args.base_height.filter(|_| form != Form::Print);
            let mesh = if let Some(base) = base { shell.closed(base)? } else { shell };
            let written = args.write_model(form, &mesh, (&model.reprojection, &staged), console)?;
            if let Some(picture) = &mut picture {
                let shown =
                    Model { mesh: &mesh, contours: &[], skeleton_lines: &[], units: console.units(), title: None };
                picture.draw(&Drawing::Image(render_model(&shown)?), console)?;
            }
            Written::Model(written)
        }
    };
    if args.input.map.strict {
        let checked = all_right(&args.input.map.name(), &findings);
        checked.map_err(|error| summary::after_findings(error, &findings, console))?;
    }

    summary::findings(&findings, console);
    console.say(&about);
    describe(&model, console);
    written.commit(form, staged, console)?;
    picture.map(|picture| picture.commit(console)).transpose()?;
    summary::close(findings.len(), console);
    Ok(())
}

/// Refuses flags that apply to contours.
fn check(args: &MeshArgs, form: Form, console: &Console) -> Result<(), Failure> {
    let flags = &console.flags;
    let own = ["--points", "--uncertainty", "--keep"];
    let for_contours = InputArgs::about_contours(flags, &["--crs", "--plane-unit"])
        .or_else(|| flags.first(&own))
        .or_else(|| about_surface(flags));
    if let Some(flag) = for_contours {
        return Err(Failure::Usage(format!("{flag} applies to contours, but the input is a height map")));
    }
    match args.cell.filter(|_| form != Form::Page) {
        Some(_) => Err(Failure::Usage("--cell applies to contours and pages: a height map has its own cells".into())),
        None => Ok(()),
    }
}

/// The height map, in the coordinate reference system and with the unit of x and y that are asked for.
fn read(args: &MeshArgs, console: &Console) -> Result<(Dem, Vec<Finding>), Failure> {
    let path = args.input.map.file();
    let read = console.step("reading", || read_dem(path))?;
    let (mut dem, mut findings) = (read.value.dem, read.findings);
    if let Some(crs) = &args.input.map.crs {
        dem.crs = Some(crs.clone());
        findings.retain(|finding| finding.kind != FindingKind::UnknownCrs);
    }
    let unit = args.input.map.plane_unit.map(UnitArg::unit);
    dem.crs = in_plane_unit(dem.crs, unit).map_err(|error| error.in_file(path))?;
    // The finding says that heights were in feet. Then x and y may be so too.
    if metres_per_unit(&dem.grid, dem.crs.as_ref()).is_none()
        && findings.iter().any(|finding| finding.kind == FindingKind::HeightUnit)
    {
        return Err(Error::PlaneUnitUnknown.in_file(path).into());
    }
    Ok((dem, findings))
}

fn model(dem: Dem, part: Option<MultiPolygon<f64>>, path: &Path) -> Result<DemModel, Failure> {
    Ok(DemModel::new(dem, part, memory::available()).map_err(|error| error.in_file(path))?)
}

/// The plane that the model is on.
fn describe(model: &DemModel, console: &Console) {
    let heights = model.heights();
    let name = heights.crs.as_ref().and_then(|crs| crs.name()).unwrap_or_else(|| "unknown".into());
    console.say(&format!("crs        {name}"));
    if model.is_interpolated() {
        console.say(&format!(
            "           heights are interpolated in cells of {:.3} m on this plane",
            heights.grid.cell.x
        ));
    }
}
