//! `tokosen profile`: heights along a line.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use clap::{ArgAction, Args};
use tokosen::base::Units;
use tokosen::base::error::Finding;
use tokosen::draw::chart::{Chart, MOST_PANELS, Panel, Series};
use tokosen::io::{Content, PlannedOutput, VectorSource};
use tokosen::surface::Uncertainty;
use tokosen::terrain::{Pair, Profile, ProfileParams, ProfileRun, Side, read_profile};

use super::compare::side::{self, ReadSides, Sides};
use super::console::Console;
use super::failure::Failure;
use super::input::InputArgs;
use super::results::{Results, cell};
use super::source::source;
use super::surface::SurfaceArgs;
use super::unit::ToUnitArgs;
use super::vertical_shift::ShiftArgs;
use super::{memory, summary};

/// Heights along a line, as a table and as a picture
///
/// A and B are height maps or contours; the surface between contours is evaluated at each place itself. Places are at round
/// distances along the line, and at its vertices. With --sections, they lie on sections across the line instead.
///
/// The table has a row for each place: feature, the number of the line; section, the distance of the section from the start of
/// the line; distance, from the start of the line, or from the middle of the section (left of the line below 0); x and y in
/// the coordinates of the line; z, and the standard error of z. With B, each side has its z and its error. The standard
/// errors of contours are estimated by hiding levels, those of a height map are those in its file ('dem --uncertainty' writes them) or what --sigma says.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
#[command(mut_arg("contours", |arg| arg.index(1).num_args(1).action(ArgAction::Set).value_name("A").help(
    "A height map (.tif, .asc, .exr, .png, .xyz, LandXML triangles) or contour lines (.gpkg, .geojson, .shp, .fgb, .parquet, .dxf, .kml, .gml, .csv and others), or a .xml, .zip or \
     folder of 基盤地図情報")))]
pub struct ProfileArgs {
    #[command(flatten)]
    input: InputArgs,
    /// Another height map or contours, in the same picture
    #[arg(index = 2, value_name = "B", help_heading = "Input", value_parser = source())]
    b: Option<VectorSource>,
    /// The line, or several: lines of a vector file
    #[arg(long, value_name = "FILE", value_parser = source(), help_heading = "Input")]
    line: VectorSource,
    /// Standard error of the heights of height maps [metres, or the unit of --to-unit] [default: the errors that the file has beside its heights, or that of a product of 基盤地図情報]
    #[arg(long, value_name = "METRES", help_heading = "Input")]
    sigma: Option<f64>,
    /// Greatest distance between places [metres, or the unit of --to-unit; default: a 500th of the line, or a 100th of --width]
    #[arg(long, value_name = "DISTANCE", help_heading = "Output")]
    step: Option<f64>,
    /// Sections across the line, this far apart [metres, or the unit of --to-unit]
    #[arg(long, value_name = "DISTANCE", help_heading = "Output", requires = "width")]
    sections: Option<f64>,
    /// Width of the sections [metres, or the unit of --to-unit]
    #[arg(long, value_name = "DISTANCE", help_heading = "Output", requires = "sections")]
    width: Option<f64>,
    /// How much larger heights are drawn than distances [default: so that the picture has a usual shape]
    #[arg(long, value_name = "FACTOR", help_heading = "Output")]
    exaggeration: Option<f64>,
    /// A table (.csv) or a picture (.svg, .png); give it again for another file
    #[arg(short, long, value_name = "FILE", help_heading = "Output", required = true)]
    output: Vec<PathBuf>,
    #[command(flatten)]
    to_unit: ToUnitArgs,
    #[command(flatten, next_help_heading = "Input")]
    shift: ShiftArgs,
    #[command(flatten)]
    surface: SurfaceArgs,
}

const EXAMPLES: &str = "\
Examples:
  tokosen profile contours.gpkg --line road.gpkg -o profile.csv -o profile.svg
  tokosen profile before.tif after.tif --line dam.geojson --sigma 0.3 -o dam.png --exaggeration 2
  tokosen profile contours.gpkg --line road.gpkg --sections 20 --width 50 -o sections.csv";

/// Features that the summary names.
const SHOWN: usize = 5;

/// Runs the verb.
pub fn run(args: &ProfileArgs, console: &Console) -> Result<(), Failure> {
    let contents = args.check(console)?;
    let results = Results::open(&args.output)?;
    let mut findings = Vec::new();
    let ProfileArgs { input, surface, shift, .. } = args;
    let sides = Sides { input, b: args.b.as_ref(), grid: None, surface, shift, uncertainty: Uncertainty::Learnt };
    let ReadSides { mut a, mut b, .. } = side::read(sides, &contents, &mut findings, console)?;
    side::state_sigma(args.sigma.map(|sigma| args.to_unit.unit().metres(sigma)), [Some(&mut a), b.as_mut()])?;
    if let Some(nodes) = a.nodes() {
        Pair::refuse_degrees(&nodes, input.map.file())?;
    }
    let sides: Vec<&Side> = [Some(&a), b.as_ref()].into_iter().flatten().collect();
    let metres = |length: Option<f64>| length.map(|length| args.to_unit.unit().metres(length));
    let sections = metres(args.sections).zip(metres(args.width)).map(|(every, width)| [every, width]);
    let params = ProfileParams { step: metres(args.step), sections };
    let found = console.step("profile", || read_profile(&sides, &args.line, &params, memory::available()))?;
    let found = found.collect(&mut findings);
    findings.extend(sides.iter().flat_map(|side| side.late_findings()));
    let units = Units::all(args.to_unit.unit());
    if results.have_chart() && found.runs.len() > MOST_PANELS {
        return Err(Failure::Usage(format!(
            "{} sections or lines are too many for a picture, which has {MOST_PANELS} at most: write a .csv, or take sections \
             further apart",
            found.runs.len()
        )));
    }
    results.write(&table(&found, units), || chart(&found, &sides, args.exaggeration, units), console)?;

    let placed: Vec<Finding> = findings.iter().map(Finding::with_place_in_words).collect();
    summary::findings(&placed, console);
    for (letter, side) in ["A", "B"].iter().zip(&sides) {
        console.say(&format!("{letter}          {}", side.source.title()));
    }
    let [all, known] = found.counts();
    let what = if args.sections.is_some() { "sections" } else { "lines" };
    console.say(&format!("profile    {all} places on {} {what}; {known} of them with a height", found.runs.len()));
    let bare = found.without_heights();
    if !bare.is_empty() {
        let shown: Vec<String> = bare.iter().take(SHOWN).map(u64::to_string).collect();
        let more = if bare.len() > SHOWN { format!(" and {} more", bare.len() - SHOWN) } else { String::new() };
        console
            .say(&format!("           no height along all of a line or section: feature {}{more}", shown.join(", ")));
    }
    results.commit(console)?;
    summary::close(findings.len(), console);
    Ok(())
}

impl ProfileArgs {
    /// Checks what can be checked before anything is read, and returns what the sides are.
    fn check(&self, console: &Console) -> Result<Vec<Content>, Failure> {
        for (name, value) in [
            ("sigma", self.sigma),
            ("step", self.step),
            ("sections", self.sections),
            ("width", self.width),
            ("exaggeration", self.exaggeration),
        ] {
            if let Some(value) = value.filter(|value| !(value.is_finite() && *value > 0.0)) {
                return Err(Failure::Usage(format!("--{name} is {value}, it must be more than 0")));
            }
        }
        side::check(&self.input, self.b.as_ref(), (&self.surface, &self.shift), console)?;
        let files = self.input.map.files()?;
        let files = files.iter().map(PathBuf::as_path).chain(self.b.iter().map(|b| b.path.as_path()));
        let inputs: Vec<&Path> =
            files.chain([self.line.path.as_path()]).chain(self.surface.files()).chain(self.shift.file()).collect();
        let outputs: Vec<PlannedOutput<'_>> = self.output.iter().map(|path| path.as_path().into()).collect();
        console.check_paths(&inputs, &outputs)?;
        side::contents(&self.input, self.b.as_ref())
    }
}

/// The table, a row for each place.
fn table(found: &Profile, units: Units) -> String {
    let unit = units.heights.symbol().replace(' ', "_").to_lowercase();
    let sides = found.runs.first().and_then(|run| run.points.first()).map_or(1, |point| point.samples.len());
    let has_sections = found.runs.iter().any(|run| run.section.is_some());
    let mut text =
        format!("feature,{}distance_{unit},x,y", if has_sections { format!("section_{unit},") } else { String::new() });
    for letter in ["_a", "_b"].iter().take(sides) {
        let letter = if sides > 1 { letter } else { "" };
        let _ = write!(text, ",z{letter}_{unit},error{letter}_{unit}");
    }
    text.push('\n');
    let length = |metres: f64| cell(units.heights.about(metres), 3);
    for run in &found.runs {
        for point in &run.points {
            let section = run.section.map_or(String::new(), |at| format!("{},", length(at)));
            let decimals = if point.place.abs().max_element() <= 360.0 { 8 } else { 3 };
            let [x, y] = [point.place.x, point.place.y].map(|c| cell(c, decimals));
            let _ = write!(text, "{},{section}{},{x},{y}", run.feature, length(point.distance));
            for sample in &point.samples {
                let _ = write!(text, ",{},{}", length(sample.height), length(sample.error));
            }
            text.push('\n');
        }
    }
    text
}

/// The picture, a panel for each line or section.
fn chart(found: &Profile, sides: &[&Side], exaggeration: Option<f64>, units: Units) -> Chart {
    let about = |metres: f64| units.heights.about(metres);
    let symbol = units.heights.symbol();
    let name = |side: &Side| side.source.file.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let exaggeration = Some(exaggeration.unwrap_or_else(|| usual_exaggeration(found)));
    let panel = |run: &ProfileRun| {
        let series = sides.iter().enumerate().map(|(k, side)| {
            let band: Vec<f64> = run.points.iter().map(|point| about(point.samples[k].error)).collect();
            Series {
                name: name(side),
                points: run
                    .points
                    .iter()
                    .map(|point| [about(point.distance), about(point.samples[k].height)])
                    .collect(),
                band: if band.iter().any(|error| error.is_finite()) { band } else { Vec::new() },
            }
        });
        let title = match run.section {
            Some(at) => format!("Section at {} {symbol}", cell(about(at), 1)),
            None if found.runs.len() > 1 => format!("Line {}", run.feature),
            None => String::new(),
        };
        let labels = [format!("Distance, {symbol}"), format!("Height, {symbol}")];
        Panel { title, labels, series: series.collect(), exaggeration }
    };
    Chart { title: String::new(), panels: found.runs.iter().map(panel).collect() }
}

/// Height of a usual picture, as a share of its width.
const SHAPE: f64 = 0.35;

/// The factor on heights that gives the picture a usual shape: 1, 2 or 5 times a power of ten.
fn usual_exaggeration(found: &Profile) -> f64 {
    let range = |values: &mut dyn Iterator<Item = f64>| {
        let known = values.filter(|value| value.is_finite());
        let [lo, hi] = known.fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], v| [lo.min(v), hi.max(v)]);
        hi - lo
    };
    let length = |run: &ProfileRun| range(&mut run.points.iter().map(|point| point.distance));
    let rise = |run: &ProfileRun| range(&mut run.points.iter().flat_map(|point| &point.samples).map(|s| s.height));
    let shapes = found.runs.iter().map(|run| SHAPE * length(run) / rise(run));
    let least = shapes.filter(|shape| shape.is_finite() && *shape > 0.0).fold(f64::INFINITY, f64::min);
    if !least.is_finite() {
        return 1.0;
    }
    let power = 10_f64.powf(least.log10().floor());
    // Nobody wants heights that are drawn too low.
    [5.0, 2.0].into_iter().map(|digit| digit * power).find(|round| *round <= least).unwrap_or(power).max(1.0)
}

#[cfg(test)]
mod tests {
    use tokosen::terrain::{ProfilePoint, Sample};

    use super::*;

    #[test]
    fn usual_pictures_are_neither_flat_nor_tall() {
        let point = |distance: f64, height: f64| {
            let samples = vec![Sample { height, error: f64::NAN }];
            ProfilePoint { distance, place: Default::default(), samples }
        };
        let run = |rise: f64| {
            let points = vec![point(0.0, 5.0), point(500.0, f64::NAN), point(1000.0, 5.0 + rise)];
            ProfileRun { feature: 0, section: None, points }
        };
        let factor = |rises: &[f64]| usual_exaggeration(&Profile { runs: rises.iter().map(|r| run(*r)).collect() });
        assert_eq!([factor(&[350.0]), factor(&[100.0]), factor(&[20.0]), factor(&[900.0])], [1.0, 2.0, 10.0, 1.0]);
        // The steepest section counts, and level ones do not.
        assert_eq!([factor(&[20.0, 100.0]), factor(&[0.0]), factor(&[])], [2.0, 1.0, 1.0]);
    }
}
