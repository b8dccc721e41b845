//! `tokosen compare`: how far a height map or a surface is from another, and where.

mod side;

use std::path::{Path, PathBuf};

use clap::Args;
use tokosen::base::error::Error;
use tokosen::dem::compare::{Comparison, difference};
use tokosen::draw::report::{page, sentences, table};
use tokosen::io::raster::{Quantity, RasterParams, write_raster};
use tokosen::io::{Content, StagedOutput, check_paths, content};
use tokosen::terrain::{MeasureOptions, Pair, comparison_json, measure, read_check_points};

use super::console::Console;
use super::input::InputArgs;
use super::job::{commit, told};
use super::output::{self, GridArgs};
use super::surface::SurfaceArgs;
use super::{Failure, memory, summary};

/// How far a height map or the surface of contours is from another
///
/// A is measured against B: differences are A − B. Each is a height map, or contours, whose surface is then evaluated at
/// the other's own cell centres. Of two height maps on different grids B stays as it is.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
#[command(mut_arg("contours", |arg| arg.index(1).value_name("A").help(
    "What is measured: a height map (.tif, .asc, .exr, .png) or contour lines (.gpkg, .geojson, .shp, .fgb, .dxf), or a .xml, .zip or \
     folder of 基盤地図情報")))]
#[command(mut_arg("points", |arg| arg.help(
    "Check points: points with an elevation, at which A and B are measured, too")))]
pub struct CompareArgs {
    #[command(flatten)]
    input: InputArgs,
    /// What it is measured against, the reference: a height map or contour lines
    #[arg(index = 2, value_name = "B", help_heading = "Input")]
    b: PathBuf,
    /// Stated accuracy of the height map that is measured against, as a standard deviation [m]; says how much of the
    /// difference is significant [default: that of a product of 基盤地図情報]
    #[arg(long, value_name = "METRES", help_heading = "Input", allow_negative_numbers = true)]
    sigma: Option<f64>,
    /// Contour interval at whose levels height maps are looked at for terraces [m] [default: that of the contours, else the
    /// usual ones are tried]
    #[arg(long, value_name = "METRES", help_heading = "Input", allow_negative_numbers = true)]
    interval: Option<f64>,
    /// Also write the differences A − B: GeoTIFF (.tif), OpenEXR (.exr), 16-bit PNG (.png) and others
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    output: Option<PathBuf>,
    /// Print the figures as JSON instead of a table
    #[arg(long, help_heading = "Output")]
    json: bool,
    /// Also write a page with maps, charts and tables: .html
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    report: Option<PathBuf>,
    #[command(flatten, next_help_heading = "Output")]
    grid: GridArgs,
    #[command(flatten)]
    surface: SurfaceArgs,
}

const EXAMPLES: &str = "\
Examples:
  tokosen compare contours.gpkg published_dem.tif --report compare.html
  tokosen compare mine.tif published_dem.tif --sigma 5 -o difference.tif
  tokosen compare old.gpkg new.gpkg --cell 10 --json

Figures, in metres: bias, the mean of the differences d; RMSE; RMSE-b, the same about the bias; MAE, the mean of |d|;
median; NMAD, 1.4826 times the median of |d - median|; LE90 and LE95, which 90 % and 95 % of |d| do not exceed.";

/// Runs the verb.
pub fn run(args: &CompareArgs, console: &Console) -> Result<(), Failure> {
    let contents = check(args)?;
    let staged = args.output.as_deref().map(output::open_raster).transpose()?;
    let page = args.report.as_deref().map(open_page).transpose()?;

    let mut findings = Vec::new();
    let pair = side::read(args, contents, &mut findings, console)?;
    let options = MeasureOptions { sigma: args.sigma, interval: args.interval };
    let measured = measure(&pair, &options, console).and_then(|mut found| {
        if let Some(path) = &args.input.map.points {
            let points = (path.as_path(), args.input.map.unit.unit());
            read_check_points(&mut found, &pair, points, memory::available(), &mut findings)?;
        }
        Ok(found)
    });
    let found = measured.map_err(|error| told(error, &side::placed(&findings), console))?;
    let (a, b) = (&pair.a_heights, &pair.b_heights);
    if let Some(staged) = &staged {
        let params = RasterParams { quantity: Quantity::Difference, ..RasterParams::default() };
        let written = console.step("writing", || write_raster(&staged.path(), &difference(a, b), &params));
        written.map_err(|e| staged.with_final_name(e))?;
    }
    if let Some(staged) = &page {
        draw(staged, &pair, &found, console)?;
    }

    summary::findings(&side::placed(&findings), console);
    if args.json {
        console.result(&comparison_json(&pair, &found, &findings)?);
    } else {
        tell(&pair, &found, console);
    }
    for staged in [staged, page].into_iter().flatten() {
        let path = commit(staged)?;
        if !args.json {
            console.say(&format!("written    {}", path.display()));
        }
    }
    if !args.json {
        summary::close(findings.len(), console);
    }
    Ok(())
}

/// Writes the page, still under its temporary name.
pub fn draw(staged: &StagedOutput, pair: &Pair, found: &Comparison, console: &Console) -> Result<(), Failure> {
    let path = staged.path();
    let written =
        console.step("drawing", || std::fs::write(&path, page(pair, found)?).map_err(|e| Error::io("write", &path, e)));
    Ok(written.map_err(|e| staged.with_final_name(e))?)
}

/// Checks what can be checked before anything is read, and tells what A and B are.
fn check(args: &CompareArgs) -> Result<[Content; 2], Failure> {
    let contents = [content(&args.input.map.contours)?, content(&args.b)?];
    for (name, value) in [("sigma", args.sigma), ("interval", args.interval)] {
        if let Some(value) = value.filter(|v| !(v.is_finite() && *v > 0.0)) {
            return Err(Failure::Usage(format!("--{name} is {value}, it must be more than 0")));
        }
    }
    if contents == [Content::HeightMap; 2] {
        // Check points have a unit, too.
        let about_contours =
            args.input.about_contours().filter(|flag| !(*flag == "--unit" && args.input.map.points.is_some()));
        if let Some(flag) = about_contours.or_else(|| args.surface.given()) {
            return Err(Failure::Usage(format!("{flag} is about contours, and both inputs are height maps")));
        }
    }
    if contents == [Content::Contours; 2] {
        if !args.grid.is_given() {
            return Err(Failure::Usage(
                "two surfaces are compared on a grid: give --cell SIZE or --like RASTER".into(),
            ));
        }
        args.grid.check()?;
    } else if args.grid.is_given() {
        return Err(Failure::Usage(
            "heights are compared at the cells of the height map: leave out --cell and --like".into(),
        ));
    }
    if contents != [Content::HeightMap; 2] {
        args.surface.check()?;
    }
    let inputs: Vec<&Path> = args
        .input
        .map
        .files()
        .chain([args.b.as_path()])
        .chain(args.grid.like.as_deref())
        .chain(args.surface.files())
        .collect();
    let outputs: Vec<&Path> = args.output.iter().chain(&args.report).map(PathBuf::as_path).collect();
    check_paths(&inputs, &outputs)?;
    Ok(contents)
}

/// Opens the page's file.
pub fn open_page(path: &Path) -> Result<StagedOutput, Failure> {
    if !path.extension().is_some_and(|e| e.eq_ignore_ascii_case("html") || e.eq_ignore_ascii_case("htm")) {
        return Err(Failure::Usage(format!("{}: the report is written as .html", path.display())));
    }
    Ok(StagedOutput::create(path)?)
}

/// The summary: what was compared, the table, what it means.
pub fn tell(pair: &Pair, found: &Comparison, console: &Console) {
    console.say(&format!("A          {}", pair.a.source.title()));
    console.say(&format!("B          {}", pair.b.source.title()));
    let grid = &pair.b_heights.grid;
    console.say(&format!(
        "compared   {} cells of {} x {} ({:.1} %), differences A − B in metres",
        found.overall.cells,
        grid.cols,
        grid.rows,
        100.0 * found.overall.cells as f64 / grid.len().max(1) as f64
    ));
    console.say("");
    table(found).iter().for_each(|line| console.say(line));
    console.say("");
    sentences(pair, found).iter().for_each(|sentence| console.say(sentence));
    console.say("");
}
