//! `tokosen check`: contour lines in, their faults out.

use std::path::{Path, PathBuf};

use clap::Args;
use tokosen::Options;
use tokosen::base::error::Finding;
use tokosen::contour::ContourMap;
use tokosen::io::layer::{FINDINGS_LAYER, REPAIRED_LAYERS, holds_spots, of_findings, of_repaired};
use tokosen::io::{PlannedOutput, StagedOutput, VectorFormat, write_layers_back};
use tokosen::terrain::{all_right, check_json, is_repair};

use super::console::Console;
use super::failure::Failure;
use super::features::{self, BreakLineArgs, Sources, StreamArgs, WaterArgs, paths};
use super::map::{MapArgs, RepairArg};
use super::part::PartArgs;
use super::plane::ToCrsArgs;
use super::summary;
use super::surface::FrameArgs;
use super::unit::{ToUnitArgs, in_units};

/// Faults in contour lines, their places and proposed repairs
///
/// Faults of the lines themselves: repeated points, spikes, duplicates, crossings, gaps, sudden changes of elevation.
/// Faults between neighbouring lines: contradicting elevations, missing contours, contours that end inside the map,
/// spot heights outside their band, depression marks. Lakes, streams and break lines that contradict the contours. Each finding has a code, a severity, a place, its features and
/// elevations, a message and, where possible, a proposal. An error makes the ground near it wrong, a warning may do so,
/// a note does not.
///
/// Findings have their elevations in metres. --to-unit is for the repaired contours.
///
/// The exit status is 0 even if faults are found. With --strict it is 1 if there is an error or a warning.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct CheckArgs {
    #[command(flatten)]
    map: MapArgs,
    #[command(flatten, next_help_heading = "Part of the map")]
    frame: FrameArgs,
    #[command(flatten, next_help_heading = "Part of the map")]
    part: PartArgs,
    #[command(flatten, next_help_heading = "Lines and water to compare")]
    water: WaterArgs,
    #[command(flatten, next_help_heading = "Lines and water to compare")]
    streams: StreamArgs,
    #[command(flatten, next_help_heading = "Lines and water to compare")]
    break_lines: BreakLineArgs,
    /// Findings to write, as points: .gpkg, .geojson or .parquet. With --repair: the repaired contours, as .geojson, .gpkg, .fgb,
    /// .dxf, .shp, .kml or .kmz; only a GeoPackage also holds the spot heights
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    output: Option<PathBuf>,
    /// Print the findings as JSON
    #[arg(long, help_heading = "Output")]
    json: bool,
    #[command(flatten, next_help_heading = "Output")]
    to_crs: ToCrsArgs,
    #[command(flatten, next_help_heading = "Output")]
    to_unit: ToUnitArgs,
}

const EXAMPLES: &str = "\
Examples:
  tokosen check contours.gpkg
  tokosen check district.gpkg --frame district_area.gpkg
  tokosen check contours.gpkg --streams rivers.gpkg --water lakes.gpkg
  tokosen check contours.shp -a ELEV -o findings.gpkg
  tokosen check contours.gpkg --json --strict
  tokosen check contours.gpkg --repair safe -o fixed.gpkg
  tokosen check contours.gpkg --repair all -o fixed.gpkg";

/// Runs the verb.
pub fn run(args: &CheckArgs, console: &Console) -> Result<(), Failure> {
    let preparation = args.map.preparation();
    preparation.check()?;
    let staged = args.open(console)?;
    let mut input = args.map.read(console)?;
    args.frame.add_to(&mut input)?;
    args.part.add_to(&mut input)?;
    let sea = args.water.sea_in_metres(args.to_unit.unit());
    sea.into_iter().for_each(|level| input.expect_level(level));
    let cleaned = input.clean(&preparation, console);
    cleaned.map_err(|error| summary::after_findings(error, &input.findings, console))?;
    let back = args.to_crs.way(args.output.as_deref(), &input.reprojection, args.to_unit.unit())?;
    let fixed = staged.is_some() && args.writes_map();
    let map = if fixed { Some(input.map.clone()) } else { None };
    args.water.check()?;
    features::add(args.sources(), &mut input)?;
    let options = Options { sea, stream_tolerance: args.streams.stream_tolerance, ..Options::default() };
    let judged = input.judge(&options, console);
    let judged = judged.map_err(|error| summary::after_findings(error, &input.findings, console))?;
    input.findings.sort_by(|a, b| (b.kind.severity(), a.kind).cmp(&(a.kind.severity(), b.kind)));
    let findings = &input.findings;

    if let Some(staged) = &staged {
        console.step("writing", || match &map {
            Some(map) => write_layers_back(staged, &of_repaired(map, staged.target()), &back),
            None => write_layers_back(staged, &[of_findings(findings, &back)], &back),
        })?;
    }
    if args.json {
        console.result(&format!("{:#}", check_json(&input, &judged)));
    } else {
        summary::findings_by_severity(findings, console);
        args.map.describe(&judged, console);
    }
    let written = staged.map(StagedOutput::commit).transpose()?;
    if !args.json {
        if let Some(path) = written {
            console.say(&format!(
                "written    {} ({}{})",
                path.display(),
                contents(map.as_ref(), findings, &path),
                in_units(&back)
            ));
        }
        summary::close_severities(findings, input.findings_outside, console);
    }
    if args.map.strict { Ok(all_right(&input.name(), findings)?) } else { Ok(()) }
}

impl CheckArgs {
    /// Whether the output is the map and not the findings.
    fn writes_map(&self) -> bool {
        self.map.repair.is_some()
    }

    /// The files of lines and polygons that are compared with the contours.
    fn sources(&self) -> Sources<'_> {
        [self.water.sources(), self.streams.sources(), self.break_lines.sources()].concat()
    }

    /// Opens the output, if there is one.
    fn open(&self, console: &Console) -> Result<Option<StagedOutput>, Failure> {
        let files = self.map.files()?;
        let area = self.frame.file().into_iter().chain(self.part.file());
        let others = area.chain(paths(self.sources()));
        let inputs: Vec<&Path> = files.iter().map(PathBuf::as_path).chain(others).collect();
        let Some(path) = &self.output else {
            console.check_paths(&inputs, &[])?;
            return match console.flags.first(&["--to-crs", "--to-unit"]) {
                Some(flag) => Err(Failure::Usage(format!("{flag} needs a file to write: add -o FILE"))),
                None => Ok(None),
            };
        };
        if self.to_unit.unit().is_foot() && !self.writes_map() {
            return Err(Failure::Usage("--to-unit is for repaired contours: add --repair safe or --repair all".into()));
        }
        if self.map.repair == Some(RepairArg::None) {
            return Err(Failure::Usage(
                "--repair none changes nothing, so -o has no map to write; use safe or all".into(),
            ));
        }
        let known = match VectorFormat::from_path(path) {
            Ok(VectorFormat::GeoPackage | VectorFormat::GeoJson | VectorFormat::GeoParquet) => true,
            Ok(_) => self.writes_map(),
            Err(_) => false,
        };
        if !known {
            let kinds = match self.writes_map() {
                true => "contours are written as .geojson, .gpkg, .fgb, .parquet, .dxf, .shp, .kml or .kmz",
                false => "findings are written as .gpkg, .geojson or .parquet",
            };
            return Err(Failure::Usage(format!("{}: {kinds}", path.display())));
        }
        self.to_crs.check(path)?;
        let layers: &[&str] = if self.writes_map() { &REPAIRED_LAYERS } else { &[FINDINGS_LAYER] };
        console.check_paths(&inputs, &[PlannedOutput { path, layers }])?;
        Ok(Some(StagedOutput::create(path)?))
    }
}

/// What the written file holds, in words.
fn contents(map: Option<&ContourMap>, findings: &[Finding], path: &Path) -> String {
    let Some(map) = map else { return format!("{} findings", findings.len()) };
    let repairs = findings.iter().filter(|finding| is_repair(finding)).count();
    let spots = match map.spots.len() {
        0 => String::new(),
        n if holds_spots(path) => format!(", {n} spot heights"),
        n => format!("; {n} spot heights not written, only a .gpkg holds them"),
    };
    format!("{} lines{spots}, {repairs} repairs", map.contours.len())
}
