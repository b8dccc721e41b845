//! `tokosen compare`: differences between two height maps or surfaces.

mod args;
pub mod side;

pub use args::CompareArgs;

use std::path::{Path, PathBuf};

use tokosen::base::ElevationUnit;
use tokosen::base::error::{Error, Finding};
use tokosen::dem::compare::{Comparison, Difference};
use tokosen::draw::paper::{Fonts, Page};
use tokosen::draw::report::table;
use tokosen::io::raster::{Quantity, RasterParams, write_rows};
use tokosen::io::{Content, PlannedOutput, StagedOutput, content};
use tokosen::surface::Uncertainty;
use tokosen::terrain::{
    MeasureOptions, Pair, comparison_json, difference_map, difference_page, measure, page, read_check_points, sentences,
};

use side::{ReadSides, Sides};

use super::console::Console;
use super::extensions::open_raster;
use super::failure::Failure;
use super::height_map::ABOUT_GRID;
use super::input::InputArgs;
use super::picture::{Asked, Drawing, Picture};
use super::surface::about_surface;
use super::unit::UnitArg;
use super::{memory, summary, terrain_page};

/// Runs the verb.
pub fn run(args: &CompareArgs, console: &Console) -> Result<(), Failure> {
    let contents = check(args, console)?;
    let staged = args.output.as_deref().map(open_raster).transpose()?;
    let report = args.report.as_deref().map(open_page).transpose()?;
    let page = args.page.as_deref().map(terrain_page::open).transpose()?;
    let files = args.input.map.files()?;
    let asked =
        Asked::Differences(&args.picture, [files.first().map_or(Path::new(""), PathBuf::as_path), &args.b.path]);
    let mut picture = asked.open(&console.flags)?;

    let mut findings = Vec::new();
    let pair = pair(args, contents, &mut findings, console)?;
    // Programs that read JSON expect metres.
    let unit = if args.json { ElevationUnit::Metre } else { pair.unit() };
    let options = MeasureOptions { sigma: args.sigma, interval: args.interval, unit };
    let measured = measure(&pair, &options, console).and_then(|mut found| {
        if let Some(source) = &args.input.map.points {
            let points = (source, args.input.map.unit.map(UnitArg::unit));
            read_check_points(&mut found, &pair, points, memory::available(), &mut findings)?;
        }
        Ok(found)
    });
    for (letter, side) in [("A", &pair.a), ("B", &pair.b)] {
        let told = |finding: Finding| Finding { message: format!("{letter}: {}", finding.message), ..finding };
        findings.extend(side.late_findings().into_iter().map(told));
    }
    let placed: Vec<Finding> = findings.iter().map(Finding::with_place_in_words).collect();
    let found = measured.map_err(|error| summary::after_findings(error, &placed, console))?;
    let (a, b) = (&*pair.a_heights, &*pair.b_heights);
    if let Some(staged) = &staged {
        let params = RasterParams { quantity: Quantity::Difference, ..RasterParams::default() };
        let written = console.step("writing", || write_rows(&staged.path(), &Difference { a, b }, &params));
        written.map_err(|e| staged.with_final_name(e))?;
    }
    if let Some(staged) = &report {
        draw(staged, &pair, &found, console)?;
    }
    if let Some(picture) = &mut picture {
        let sheet = |page: &Page, fonts: &Fonts| difference_map(&pair, &found, page, fonts);
        picture.draw(&Drawing::Sheet(&sheet), console)?;
    }
    if let Some(staged) = &page {
        terrain_page::put(staged, &difference_page(&pair, &found, console)?, console)?;
    }

    summary::findings(&placed, console);
    if args.json {
        console.result(&comparison_json(&pair, &found, &findings)?);
    } else {
        summarise(&pair, &found, console);
    }
    for staged in [staged, report, page].into_iter().flatten() {
        let path = staged.commit()?;
        if !args.json {
            console.say(&format!("written    {}", path.display()));
        }
    }
    let drawn = picture.map(Picture::put).transpose()?;
    if !args.json {
        drawn.iter().for_each(|line| console.say(line));
        summary::close(findings.len(), console);
    }
    Ok(())
}

/// Reads both sides and brings them onto one grid.
fn pair(
    args: &CompareArgs,
    contents: [Content; 2],
    findings: &mut Vec<Finding>,
    console: &Console,
) -> Result<Pair, Failure> {
    let CompareArgs { input, b, grid, surface, shift, .. } = args;
    let sides = Sides { input, b: Some(b), grid: Some(grid), surface, shift, uncertainty: Uncertainty::default() };
    match side::read(sides, &contents, findings, console)? {
        ReadSides { a, b: Some(b), nodes: Some(nodes) } => {
            Pair::refuse_degrees(&nodes, &args.b.path)?;
            Ok(Pair::on(a, b, nodes, console)?)
        }
        _ => Err(Failure::Usage("two surfaces need a common grid: give --cell SIZE or --like RASTER".into())),
    }
}

/// Writes the report, still under its temporary name.
pub fn draw(staged: &StagedOutput, pair: &Pair, found: &Comparison, console: &Console) -> Result<(), Failure> {
    let path = staged.path();
    let written =
        console.step("drawing", || std::fs::write(&path, page(pair, found)?).map_err(|e| Error::io("write", &path, e)));
    Ok(written.map_err(|e| staged.with_final_name(e))?)
}

/// Checks what can be checked before anything is read, and returns what A and B are.
fn check(args: &CompareArgs, console: &Console) -> Result<[Content; 2], Failure> {
    let flags = &console.flags;
    let contents = [args.input.map.content()?, content(&args.b.path)?];
    for (name, value) in [("sigma", args.sigma), ("interval", args.interval)] {
        if let Some(value) = value.filter(|v| !(v.is_finite() && *v > 0.0)) {
            return Err(Failure::Usage(format!("--{name} is {value}, it must be more than 0")));
        }
    }
    args.shift.check(contents.contains(&Content::HeightMap))?;
    if contents == [Content::HeightMap; 2] {
        // Check points have a unit too.
        let but: &[&str] = if args.input.map.points.is_some() { &["--unit"] } else { &[] };
        let about_contours = InputArgs::about_contours(flags, but);
        if let Some(flag) = about_contours.or_else(|| about_surface(flags)) {
            return Err(Failure::Usage(format!("{flag} applies to contours, but both inputs are height maps")));
        }
    }
    if contents == [Content::Contours; 2] {
        if flags.first(&ABOUT_GRID).is_none() {
            return Err(Failure::Usage("two surfaces need a common grid: give --cell SIZE or --like RASTER".into()));
        }
        args.grid.check(None)?;
    } else if flags.first(&ABOUT_GRID).is_some() {
        return Err(Failure::Usage("the grid is that of the height map: leave out --cell and --like".into()));
    }
    if contents != [Content::HeightMap; 2] {
        args.surface.check(flags)?;
    }
    let files = args.input.map.files()?;
    let files = files.iter().map(PathBuf::as_path).chain([args.b.path.as_path()]);
    let inputs: Vec<&Path> = files
        .chain(args.grid.like.as_deref())
        .chain(args.picture.font.as_deref())
        .chain(args.surface.files())
        .chain(args.shift.file())
        .collect();
    let outputs: Vec<PlannedOutput<'_>> = [&args.output, &args.report, &args.page, &args.picture.preview]
        .into_iter()
        .flatten()
        .map(|p| p.as_path().into())
        .collect();
    console.check_paths(&inputs, &outputs)?;
    Ok(contents)
}

/// Opens the file of the report.
pub fn open_page(path: &Path) -> Result<StagedOutput, Failure> {
    if !path.extension().is_some_and(|e| e.eq_ignore_ascii_case("html") || e.eq_ignore_ascii_case("htm")) {
        return Err(Failure::Usage(format!("{}: the report is written as .html", path.display())));
    }
    Ok(StagedOutput::create(path)?)
}

/// Prints the summary: what was compared, the table, what it means.
pub fn summarise(pair: &Pair, found: &Comparison, console: &Console) {
    console.say(&format!("A          {}", pair.a.source.title()));
    console.say(&format!("B          {}", pair.b.source.title()));
    let grid = pair.b_heights.grid();
    console.say(&format!(
        "compared   {} cells of {} x {} ({:.1} %), differences A − B in {}",
        found.overall.cells,
        grid.cols,
        grid.rows,
        100.0 * found.overall.cells as f64 / grid.len().max(1) as f64,
        found.unit.name()
    ));
    console.say("");
    table(found).iter().for_each(|line| console.say(line));
    console.say("");
    sentences(pair, found).iter().for_each(|sentence| console.say(sentence));
    console.say("");
}
