//! `tokosen compare`: how far a height map or a surface is from another, and where.

mod side;
mod table;

use std::path::{Path, PathBuf};

use clap::Args;
use glam::DVec2;
use rayon::prelude::*;
use serde::Serialize;
use tokosen::base::Grid;
use tokosen::base::error::{Error, Finding};
use tokosen::contour::{ElevationUnit, Interval};
use tokosen::crs::Transform;
use tokosen::dem::compare::{
    BandShare, CompareParams, Comparison, at_check_points, compare, contour_distances, difference, height_figures,
    outside_bands,
};
use tokosen::dem::locate;
use tokosen::draw::report::{ComparisonPage, HeightSource, comparison_page, remarks};
use tokosen::io::raster::{Quantity, RasterParams, write_raster};
use tokosen::io::{Content, ReadOptions, StagedOutput, content, read_spot_heights};
use tokosen::surface::Surface;
use tokosen::tin::{NONE, Tin};

use super::console::Console;
use super::input::InputArgs;
use super::output::{self, GridArgs};
use super::surface::SurfaceArgs;
use super::{Failure, summary};
use side::Kind;
pub use side::{Pair, Side};

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

/// What `--json` prints.
#[derive(Serialize)]
struct Json<'a> {
    /// What A and B are.
    sources: [&'a side::Source; 2],
    /// How they came onto one grid.
    notes: &'a [String],
    /// Columns and rows.
    size: [usize; 2],
    /// Cell width and height, map units.
    cell: DVec2,
    #[serde(flatten)]
    found: &'a Comparison,
    /// Findings about the inputs.
    findings: &'a [Finding],
}

/// Runs the verb.
pub fn run(args: &CompareArgs, console: &Console) -> Result<(), Failure> {
    let contents = check(args)?;
    let staged = args.output.as_deref().map(output::open_raster).transpose()?;
    let page = args.report.as_deref().map(open_page).transpose()?;

    let mut findings = Vec::new();
    let pair = side::read(args, contents, &mut findings, console)?;
    let options = Options {
        sigma: args.sigma,
        interval: args.interval,
        points: args.input.map.points.as_deref(),
        unit: args.input.map.unit.unit(),
    };
    let measured = measure(&pair, &options, &mut findings, console);
    if measured.is_err() {
        console.clear();
        summary::findings(&side::told(&findings), console);
    }
    let found = measured?;
    let (a, b) = (&pair.a_heights, &pair.b_heights);
    if let Some(staged) = &staged {
        let params = RasterParams { quantity: Quantity::Difference, ..RasterParams::default() };
        let written = console.step("writing", || write_raster(&staged.path(), &difference(a, b), &params));
        written.map_err(|e| staged.with_final_name(e))?;
    }
    if let Some(staged) = &page {
        draw(staged, &pair, &found, console)?;
    }

    summary::findings(&side::told(&findings), console);
    if args.json {
        let json = Json {
            sources: [&pair.a.source, &pair.b.source],
            notes: &pair.notes,
            size: [b.grid.cols, b.grid.rows],
            cell: b.grid.cell,
            found: &found,
            findings: &findings,
        };
        let text =
            serde_json::to_string_pretty(&json).map_err(|e| Error::Data(format!("cannot be told as JSON: {e}")))?;
        console.result(&text);
    } else {
        tell(&pair, &found, console);
    }
    for staged in [staged, page].into_iter().flatten() {
        let path = staged.target().to_owned();
        staged.commit()?;
        if !args.json {
            console.say(&format!("written    {}", path.display()));
        }
    }
    if !args.json {
        summary::close(findings.len(), console);
    }
    Ok(())
}

/// What a comparison may be told besides the two sides.
#[derive(Default)]
pub struct Options<'a> {
    /// Stated accuracy as a standard deviation, metres; that of the product if `None`.
    pub sigma: Option<f64>,
    /// Contour interval at whose levels terraces are looked for, metres.
    pub interval: Option<f64>,
    /// A file of check points.
    pub points: Option<&'a Path>,
    /// Unit of their heights.
    pub unit: ElevationUnit,
}

/// All figures of a comparison.
pub fn measure(
    pair: &Pair,
    options: &Options<'_>,
    findings: &mut Vec<Finding>,
    console: &Console,
) -> Result<Comparison, Failure> {
    let (a, b) = (&pair.a_heights, &pair.b_heights);
    let distances = match pair.surface() {
        Some(surface) => {
            let way = side::way(&pair.b.source.file, b.crs.as_ref(), surface.map.crs.as_ref())?;
            let to_map = |p: DVec2| side::along(way.as_ref(), p);
            let known = |i: usize| a.values[i].is_finite() && b.values[i].is_finite();
            let contours = &surface.map.contours;
            Some(console.step("measuring distances", || contour_distances(contours, &b.grid, &to_map, known)))
        }
        None => None,
    };
    let interval = options.interval.map(|step| Interval { step, base: 0.0 }).or(pair.interval());
    // The reference's own figure, else that of what is measured.
    let sigma = options.sigma.or(pair.b.sigma).or(pair.a.sigma);
    let params =
        CompareParams { metres_per_unit: pair.metres_per_unit(), sigma, interval, distances: distances.as_deref() };
    let compared = console.step("comparing", || compare(a, b, &params));
    let mut found = compared?;
    for (figures, side) in [(&mut found.a, &pair.a), (&mut found.b, &pair.b)] {
        // A height map that was interpolated has lost its decimals, and some of its terraces.
        if let Kind::Dem(dem) = &side.kind
            && (dem.grid != b.grid || dem.crs != b.crs)
        {
            *figures = height_figures(&dem.values, interval.as_ref());
        }
    }
    found.bands = bands(pair, console)?;
    if let Some(path) = options.points {
        let mut checks = read_spot_heights(path, &ReadOptions::default())?.collect(findings);
        checks.points.iter_mut().for_each(|point| point.z = options.unit.metres(point.z));
        for (figures, side) in [(&mut found.a, &pair.a), (&mut found.b, &pair.b)] {
            figures.points = at_check_points(&side.at(path, &checks)?, &checks.points);
        }
        if found.a.points.is_none() && found.b.points.is_none() {
            return Err(Failure::Work(Error::file(path, "no check point lies where A or B have heights")));
        }
    }
    Ok(found)
}

/// Writes the page, still under its temporary name.
pub fn draw(staged: &StagedOutput, pair: &Pair, found: &Comparison, console: &Console) -> Result<(), Failure> {
    let content = ComparisonPage {
        a_name: &pair.a.source.title(),
        b_name: &pair.b.source.title(),
        sources: pair.height_sources(),
        notes: &pair.notes,
        a: &pair.a_heights,
        b: &pair.b_heights,
        found,
        metres_per_unit: pair.metres_per_unit(),
    };
    let written = console.step("drawing", || {
        let html = comparison_page(&content)?;
        let path = staged.path();
        std::fs::write(&path, html).map_err(|e| Error::io("write", &path, e))
    });
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
    let inputs: Vec<&Path> = args
        .input
        .map
        .files()
        .chain([args.b.as_path()])
        .chain(args.grid.like.as_deref())
        .chain(args.surface.files())
        .collect();
    let outputs: Vec<&Path> = args.output.iter().chain(&args.report).map(PathBuf::as_path).collect();
    output::check_paths(&inputs, &outputs)?;
    Ok(contents)
}

/// Opens the page's file.
pub fn open_page(path: &Path) -> Result<StagedOutput, Failure> {
    if !path.extension().is_some_and(|e| e.eq_ignore_ascii_case("html") || e.eq_ignore_ascii_case("htm")) {
        return Err(Failure::Usage(format!("{}: the report is written as .html", path.display())));
    }
    output::open(path)
}

/// How much of the height map is outside the contours' bands; of two surfaces nothing is asked, both keep within theirs.
fn bands(pair: &Pair, console: &Console) -> Result<Option<BandShare>, Failure> {
    let (side, surface, dem) = match (&pair.a.kind, &pair.b.kind) {
        (Kind::Surface(surface), Kind::Dem(_)) => (&pair.a, surface, &pair.b_heights),
        (Kind::Dem(_), Kind::Surface(surface)) => (&pair.b, surface, &pair.a_heights),
        _ => return Ok(None),
    };
    let way = side::way(&side.source.file, dem.crs.as_ref(), side.crs())?;
    let triangles = match &way {
        None => locate(&surface.tin, &dem.grid, console),
        Some(way) => console.step("looking for bands", || triangles_at(&surface.tin, &dem.grid, way)),
    };
    // A height map that is a little off on water contradicts no contour.
    let band = |i: usize| {
        let t = Some(triangles[i]).filter(|&t| t != NONE)?;
        surface.regions.region(t).filter(|region| region.water.is_none()).map(|region| region.band)
    };
    Ok(outside_bands(dem, band))
}

/// The triangles of cell centres in another system, found by walking along each row.
fn triangles_at(tin: &Tin, grid: &Grid, way: &Transform) -> Vec<u32> {
    let row = |row: usize| {
        let mut near = 0;
        (0..grid.cols).map(move |col| {
            let Some(p) = way.forward(grid.center(col, row)) else { return NONE };
            let found = tin.walk(near, p - tin.origin);
            near = found.unwrap_or_else(|left| left);
            found.unwrap_or(NONE)
        })
    };
    if tin.is_empty() { vec![NONE; grid.len()] } else { (0..grid.rows).into_par_iter().flat_map_iter(row).collect() }
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
    table::lines(found).iter().for_each(|line| console.say(line));
    console.say("");
    for sentence in pair.notes.iter().cloned().chain(remarks(found, pair.height_sources())) {
        console.say(&sentence);
    }
    console.say("");
}

/// The two sides with their heights on one grid.
impl Pair {
    fn surface(&self) -> Option<&Surface> {
        [&self.b, &self.a].into_iter().find_map(Side::surface)
    }

    fn height_sources(&self) -> [HeightSource; 2] {
        [&self.a, &self.b].map(|side| match side.kind {
            Kind::Dem(_) => HeightSource::HeightMap,
            Kind::Surface(_) => HeightSource::Surface,
        })
    }

    fn metres_per_unit(&self) -> DVec2 {
        self.b_heights.metres_per_unit().unwrap_or(DVec2::ONE)
    }

    fn interval(&self) -> Option<Interval> {
        self.surface().map(|surface| surface.interval)
    }
}
