//! `tokosen volume`: cut and fill, and what a reservoir holds.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use clap::{ArgAction, Args};
use tokosen::base::Units;
use tokosen::base::error::Finding;
use tokosen::dem::volume::{Heights, Volume};
use tokosen::draw::chart::{Chart, Panel, Series};
use tokosen::io::{Content, PlannedOutput, VectorSource};
use tokosen::surface::Uncertainty;
use tokosen::terrain::{Pair, VolumeSides, heights_of, read_area_on};

use super::compare::side::{self, ReadSides, Sides};
use super::console::Console;
use super::failure::Failure;
use super::height_map::{ABOUT_GRID, GridArgs};
use super::input::InputArgs;
use super::results::{Results, cell};
use super::source::source;
use super::surface::SurfaceArgs;
use super::unit::ToUnitArgs;
use super::vertical_shift::ShiftArgs;
use super::{memory, summary};

/// Most levels of --levels.
const MOST_LEVELS: f64 = 10_000.0;
/// So many levels are printed.
const PRINTED: usize = 6;

/// Volumes above and below a level, or between two surfaces
///
/// A and B are height maps or contours. With B, the cut is the volume where A is higher than B, and the fill where it is lower.
/// With --level, the cut is the ground of A above the level, and the fill is the space below it: what a reservoir holds. --levels gives
/// that for many levels. Each cell counts with the height at its centre; cells without a height do not count.
///
/// Errors come from the standard errors of the heights: those of contours are estimated by hiding levels, those of a
/// height map are those in its file ('dem --uncertainty' writes them) or what --sigma says. 'likely' is the standard error of the volume if errors are independent where they are further apart
/// than the contours around them; 'most' is the error if all heights are wrong by their standard error in the same direction.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
#[command(mut_arg("contours", |arg| arg.index(1).num_args(1).action(ArgAction::Set).value_name("A").help(
    "The ground: a height map (.tif, .asc, .exr, .png, .xyz, LandXML triangles) or contour lines (.gpkg, .geojson, .shp, .fgb, .parquet, .dxf, .kml, .gml, .csv and others), or a .xml, .zip or \
     folder of 基盤地図情報")))]
#[command(mut_arg("cell", |arg| arg.help("Cell size for contours [units of the working CRS]; cells lie on multiples of it")))]
pub struct VolumeArgs {
    #[command(flatten)]
    input: InputArgs,
    /// What A is compared with: a height map or contours
    #[arg(index = 2, value_name = "B", help_heading = "Input", value_parser = source(), conflicts_with_all = ["level", "levels"])]
    b: Option<VectorSource>,
    /// The level above and below which volumes are wanted [metres, or the unit of --to-unit]
    #[arg(long, value_name = "Z", help_heading = "Input")]
    level: Option<f64>,
    /// Many levels: the lowest, the highest and the step, such as 700:760:1, or a list [metres, or the unit of --to-unit]
    #[arg(long, value_name = "LOW:HIGH:STEP", value_parser = levels, help_heading = "Input", conflicts_with = "level")]
    levels: Option<Levels>,
    /// Only the ground inside the polygons of this file counts
    #[arg(long, value_name = "FILE", value_parser = source(), help_heading = "Input")]
    clip: Option<VectorSource>,
    /// Standard error of the heights of height maps [metres, or the unit of --to-unit] [default: the errors that the file has beside its heights, or that of a product of 基盤地図情報]
    #[arg(long, value_name = "METRES", help_heading = "Input")]
    sigma: Option<f64>,
    /// Also write a table (.csv), or the storage curve of --levels as a picture (.svg, .png); give it again for another file
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    output: Vec<PathBuf>,
    #[command(flatten)]
    to_unit: ToUnitArgs,
    #[command(flatten, next_help_heading = "Output")]
    grid: GridArgs,
    #[command(flatten, next_help_heading = "Input")]
    shift: ShiftArgs,
    #[command(flatten)]
    surface: SurfaceArgs,
}

const EXAMPLES: &str = "\
Examples:
  tokosen volume before.tif after.tif --clip site.gpkg --sigma 0.1
  tokosen volume contours.gpkg --cell 5 --level 720 --clip pit.geojson
  tokosen volume valley.tif --levels 700:760:1 --clip above_the_dam.gpkg -o storage.csv -o storage.svg";

/// The levels that are asked for, in the unit of the output.
#[derive(Debug, Clone, PartialEq)]
struct Levels(Vec<f64>);

fn levels(text: &str) -> Result<Levels, String> {
    let numbers = |mark: char| -> Vec<f64> {
        let parts: Result<Vec<f64>, _> = text.split(mark).map(|part| part.trim().parse()).collect();
        parts.unwrap_or_default().into_iter().filter(|number| number.is_finite()).collect()
    };
    if !text.contains(':') {
        let levels = numbers(',');
        return match levels.len() == text.split(',').count() {
            true => Ok(Levels(levels)),
            false => Err("give levels such as 700,720,740, or the lowest, the highest and the step: 700:760:1".into()),
        };
    }
    let &[low, high, step] = numbers(':').as_slice() else {
        return Err("give the lowest level, the highest and the step, such as 700:760:1".into());
    };
    let steps = (high - low) / step;
    if !(step > 0.0 && steps.is_finite() && steps >= 0.0) {
        return Err("the highest level must not be below the lowest, and the step must be more than 0".into());
    }
    if steps > MOST_LEVELS {
        return Err(format!("these are {steps:.0} levels, there may be {MOST_LEVELS}: choose a larger step"));
    }
    // The highest level counts although the division may be rounded.
    let count = (steps + 1e-9).floor() as usize + 1;
    Ok(Levels((0..count).map(|k| low + k as f64 * step).collect()))
}

/// Runs the verb.
pub fn run(args: &VolumeArgs, console: &Console) -> Result<(), Failure> {
    let contents = args.check(console)?;
    let results = Results::open(&args.output)?;
    if results.have_chart() && args.levels.is_none() {
        return Err(Failure::Usage("a picture shows the curve of many levels: give --levels LOW:HIGH:STEP".into()));
    }
    let mut findings = Vec::new();
    let VolumeArgs { input, surface, grid, shift, .. } = args;
    let grid = Some(grid);
    let sides = Sides { input, b: args.b.as_ref(), grid, surface, shift, uncertainty: Uncertainty::Learnt };
    let ReadSides { mut a, mut b, nodes } = side::read(sides, &contents, &mut findings, console)?;
    side::state_sigma(args.sigma.map(|sigma| args.to_unit.unit().metres(sigma)), [Some(&mut a), b.as_mut()])?;
    let nodes = nodes.ok_or_else(|| Failure::Usage("contours need cells: give --cell SIZE or --like RASTER".into()))?;
    Pair::refuse_degrees(&nodes, args.input.map.file())?;
    let sides = VolumeSides { a: &a, b: b.as_ref() };
    let area = |dem: &_| {
        let read = |clip: &VectorSource| Ok((read_area_on(dem, clip, memory::available())?, clip.path.clone()));
        args.clip.as_ref().map(read).transpose()
    };
    let heights = heights_of(sides, &nodes, area, console).map_err(|error| error.in_file(args.input.map.file()))?;
    findings.extend([Some(&a), b.as_ref()].into_iter().flatten().flat_map(|side| side.late_findings()));

    let unit = args.to_unit.unit();
    let found: Vec<Volume> = match &args.levels {
        Some(Levels(levels)) => levels.iter().map(|level| heights.at(unit.metres(*level))).collect(),
        None => vec![heights.at(args.level.map_or(0.0, |level| unit.metres(level)))],
    };
    let units = Units::all(unit);
    results.write(&table(&found, units, args.b.as_ref()), || storage(&found, units), console)?;

    let placed: Vec<Finding> = findings.iter().map(Finding::with_place_in_words).collect();
    summary::findings(&placed, console);
    for (letter, side) in [("A", Some(&a)), ("B", b.as_ref())] {
        side.iter().for_each(|side| console.say(&format!("{letter}          {}", side.source.title())));
    }
    describe(&found, &heights, args, units, console);
    results.commit(console)?;
    summary::close(findings.len(), console);
    Ok(())
}

impl VolumeArgs {
    /// Checks what can be checked before anything is read, and returns what the sides are.
    fn check(&self, console: &Console) -> Result<Vec<Content>, Failure> {
        if self.b.is_none() && self.level.is_none() && self.levels.is_none() {
            let message = "a volume has two sides: give a level with --level Z or --levels LOW:HIGH:STEP, or a second height \
                           map or contours";
            return Err(Failure::Usage(message.into()));
        }
        if let Some(level) = self.level.filter(|level| !level.is_finite()) {
            return Err(Failure::Usage(format!("--level is {level}, it must be a height")));
        }
        if let Some(sigma) = self.sigma.filter(|sigma| !(sigma.is_finite() && *sigma > 0.0)) {
            return Err(Failure::Usage(format!("--sigma is {sigma}, it must be more than 0")));
        }
        side::check(&self.input, self.b.as_ref(), (&self.surface, &self.shift), console)?;
        let contents = side::contents(&self.input, self.b.as_ref())?;
        let has_grid = console.flags.first(&ABOUT_GRID).is_some();
        if contents.contains(&Content::HeightMap) && has_grid {
            return Err(Failure::Usage("the grid is that of the height map: leave out --cell and --like".into()));
        }
        if !contents.contains(&Content::HeightMap) {
            self.grid.check(None)?;
        }
        let files = self.input.map.files()?;
        let files = files.iter().map(PathBuf::as_path).chain(self.b.iter().map(|b| b.path.as_path()));
        let others = self.clip.iter().map(|clip| clip.path.as_path()).chain(self.grid.like.as_deref());
        let inputs: Vec<&Path> = files.chain(others).chain(self.surface.files()).chain(self.shift.file()).collect();
        let outputs: Vec<PlannedOutput<'_>> = self.output.iter().map(|path| path.as_path().into()).collect();
        console.check_paths(&inputs, &outputs)?;
        Ok(contents)
    }
}

/// The lines of the summary.
fn describe(found: &[Volume], heights: &Heights, args: &VolumeArgs, units: Units, console: &Console) {
    let [low, high] = heights.range();
    let [low, high] = [low, high].map(|height| units.heights.about(height));
    let range = format!("{low:.2} to {high:.2} {}", units.heights.symbol());
    let area = found.first().map_or(0.0, Volume::area);
    let what = if args.b.is_some() { "differences A − B" } else { "heights" };
    console.say(&format!("area       {}, {what} from {range}", units.area(area)));
    for volume in found.iter().take(PRINTED) {
        let level = match args.b {
            Some(_) => String::new(),
            None => format!("level {}: ", units.height(volume.level)),
        };
        let (cut, fill) = (cubic(volume.cut, units), cubic(volume.fill, units));
        console.say(&format!(
            "volume     {level}cut {cut} on {}, fill {fill} on {}, net {}",
            units.area(volume.cut_area),
            units.area(volume.fill_area),
            cubic(volume.net(), units)
        ));
        let Some(errors) = volume.errors else { continue };
        let error = |name: &str, k: usize| {
            let likely = errors[k].likely.map_or(String::new(), |likely| format!("{}, ", cubic(likely, units)));
            format!("{name} ± {likely}at most {}", cubic(errors[k].most, units))
        };
        console.say(&format!("           errors: {}; {}; {}", error("cut", 0), error("fill", 1), error("net", 2)));
    }
    if found.len() > PRINTED {
        console.say(&format!("           and {} more levels; -o FILE.csv has all of them", found.len() - PRINTED));
    }
    if found.iter().any(|volume| volume.errors.is_none()) {
        console.say("           no error is known: --sigma states that of a height map");
    }
}

/// A volume in the unit of the heights.
fn in_unit(cubic_metres: f64, units: Units) -> f64 {
    let unit = units.heights;
    unit.about(unit.about(unit.about(cubic_metres)))
}

/// Volumes from here on are in millions.
const MILLION: f64 = 1e6;

fn cubic(cubic_metres: f64, units: Units) -> String {
    let sign = if units.heights.is_foot() { "ft³" } else { "m³" };
    let volume = in_unit(cubic_metres, units);
    if volume.abs() < MILLION {
        return format!("{volume:.0} {sign}");
    }
    // Five digits are more than any volume of ground is known to.
    let millions = volume / MILLION;
    let decimals = (4.0 - millions.abs().log10().floor()).clamp(0.0, 4.0) as usize;
    format!("{millions:.decimals$} million {sign}")
}

/// The table, a row for each level. Between A and B there is no level.
fn table(found: &[Volume], units: Units, b: Option<&VectorSource>) -> String {
    let unit = units.heights.symbol().replace(' ', "_").to_lowercase();
    let square = |area: f64| cell(units.heights.about(units.heights.about(area)), 1);
    let volume = |volume: f64| cell(in_unit(volume, units), 1);
    let level = if b.is_some() { String::new() } else { format!("level_{unit},") };
    let mut text = format!("{level}cut_{unit}3,cut_area_{unit}2,fill_{unit}3,fill_area_{unit}2,net_{unit}3");
    for name in ["cut", "fill", "net"] {
        let _ = write!(text, ",{name}_error_likely_{unit}3,{name}_error_most_{unit}3");
    }
    text.push('\n');
    for found in found {
        if b.is_none() {
            let _ = write!(text, "{},", units.height_number(found.level));
        }
        let [cut, fill, net] = [found.cut, found.fill, found.net()].map(volume);
        let _ = write!(text, "{cut},{},{fill},{},{net}", square(found.cut_area), square(found.fill_area));
        for k in 0..3 {
            let error = found.errors.map(|errors| errors[k]);
            let likely = error.and_then(|error| error.likely).unwrap_or(f64::NAN);
            let _ = write!(text, ",{},{}", volume(likely), volume(error.map_or(f64::NAN, |error| error.most)));
        }
        text.push('\n');
    }
    text
}

/// The storage curve: the volume and the area below each level.
fn storage(found: &[Volume], units: Units) -> Chart {
    let unit = units.heights;
    let symbol = unit.symbol();
    let curve = |of: &dyn Fn(&Volume) -> f64, label: String| Panel {
        title: String::new(),
        labels: [label, format!("Level, {symbol}")],
        series: vec![Series {
            points: found.iter().map(|v| [of(v), unit.about(v.level)]).collect(),
            ..Series::default()
        }],
        exaggeration: None,
    };
    let volume = curve(&|v| in_unit(v.fill, units) / MILLION, format!("Volume below the level, million {symbol}³"));
    let area =
        curve(&|v| unit.about(unit.about(v.fill_area)) / MILLION, format!("Area below the level, million {symbol}²"));
    Chart { title: "Storage curve".into(), panels: vec![volume, area] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_include_both_ends() {
        let count = |text: &str| levels(text).map(|levels| levels.0.len());
        assert_eq!(levels("700:703:1"), Ok(Levels(vec![700.0, 701.0, 702.0, 703.0])));
        assert_eq!(count("0:0.3:0.1"), Ok(4));
        assert_eq!(count("-5:-5:1"), Ok(1));
        assert_eq!(levels("-12.5, 7"), Ok(Levels(vec![-12.5, 7.0])));
        for wrong in ["", "700,x", "700:760", "760:700:1", "0:1:0", "0:1:-1", "0:inf:1", "a:b:c", "0:1:1e-9"] {
            assert!(levels(wrong).is_err(), "{wrong}");
        }
    }
}
