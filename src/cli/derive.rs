//! `tokosen derive`: a height map or contour lines in; slope, aspect, hillshade, steep places, the flow of water and floods out.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::Args;
use tokosen::Options;
use tokosen::base::error::{Error, Finding, FindingKind};
use tokosen::base::{ElevationUnit, Units};
use tokosen::contour::find_interval;
use tokosen::dem::derive::{Derivative, Derived, HeightsFrom, SteepParams, Steeps, check, steep, steep_note};
use tokosen::io::layer::{STEEP_LAYER, steep_areas};
use tokosen::io::raster::{Quantity, RasterParams, open_dem};
use tokosen::io::{Content, PlannedOutput, StagedOutput, write_layers};
use tokosen::raster::{GroundScale, RasterRows, WithCrs, in_plane_unit, metres_per_unit};
use tokosen::surface::Triangles;
use tokosen::terrain::all_right;

use super::base::{self, BaseArgs};
use super::console::Console;
use super::extensions::{check_vector, open_raster};
use super::failure::Failure;
use super::flow::{FlowArgs, FlowOutputs};
use super::height_map::{ABOUT_GRID, CogArgs, GridArgs};
use super::input::{InputArgs, Scope};
use super::job::build;
use super::light::LightArgs;
use super::output::write_if_asked;
use super::part::PartArgs;
use super::plane::CellsCrsArgs;
use super::surface::{SurfaceArgs, about_surface};
use super::unit::UnitArg;
use super::vertical_shift::{Shift, ShiftArgs};
use super::{memory, summary};

/// Slope, aspect, hillshade, steep places, flow of water, catchments, streams and floods
///
/// The input is a height map, or contour lines, from which a height map is made first (with --cell or --like). Slope
/// and aspect are computed over 3 x 3 cells (Horn's method); at the border and beside cells without data, heights are
/// extrapolated linearly. Heights in feet become metres first; all results are in metres. For a height map in degrees
/// or Web Mercator, distances are converted to metres on the ground.
///
/// Steep places are areas of cells with a slope of at least --steep-angle that span a height of at least
/// --steep-height. The defaults of 30 degrees and 5 m are those of Japanese law for steep slopes that may fail (急傾斜地).
/// Attributes of layer steep: area_id, area_m2 (on the map), height_m, slope_mean, slope_max, note. Parts of an area
/// that touch at a corner have the same area_id. The result is no survey: 10 m contours cannot show slopes 5 m high.
///
/// Water flows from each cell to one of the eight cells around it, along the steepest descent. Pits are flooded, so that
/// all water reaches an outlet at the border of the height map or beside cells without data, where the ground falls outwards.
/// Attributes of layer catchments: catchment, area_m2 (on the map), outlet_x, outlet_y; with --outlet also above_m2 (all ground
/// above the outlet), moved_m. Of layer stream_lines: line, into (the line that it runs into), strahler, length_m, fall_m,
/// above_m2. Of layer flood: area_m2, volume_m3, depth_max.
#[derive(Debug, Args)]
#[command(
    after_help = EXAMPLES,
    mut_arg("contours", |arg| arg.value_name("INPUT").help(INPUT_HELP)),
    mut_arg("cell", |arg| arg.help("For contours: cell size of the height map [units of the working CRS, or of --to-crs; those of a drawing without a CRS that is in feet]; cells lie on multiples of it")),
    mut_arg("to_crs", |arg| arg.help(TO_CRS_HELP)),
    mut_arg("like", |arg| arg.help("For contours: use the grid of this height map (.tif, .asc, .exr, .png, .xyz, LandXML triangles)")),
)]
pub struct DeriveArgs {
    #[command(flatten)]
    input: InputArgs,
    /// Slope in degrees: .tif, .exr, .png (16 bit), .asc or .xyz
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    slope: Option<PathBuf>,
    /// Direction that slopes face, degrees clockwise from north; level ground has no data: .tif, .exr, .png (16 bit),
    /// .asc or .xyz
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    aspect: Option<PathBuf>,
    /// Hillshade, 1 to 255: .png (8-bit grey), .tif (8 bits), .exr, .asc or .xyz
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    hillshade: Option<PathBuf>,
    #[command(flatten, next_help_heading = "Output")]
    light: LightArgs,
    #[command(flatten, next_help_heading = "Output")]
    flow: FlowArgs,
    #[command(flatten, next_help_heading = "Output")]
    cog: CogArgs,
    /// Steep places as areas: .gpkg, .geojson, .shp, .kml or .kmz
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    steep: Option<PathBuf>,
    /// Minimum slope of a steep place [degrees]
    #[arg(
        long,
        value_name = "DEGREES",
        default_value_t = 30.0,
        requires = "steep",
        help_heading = "Output",
        hide_short_help = true
    )]
    steep_angle: f64,
    /// Minimum height of a steep place [metres]
    #[arg(
        long,
        value_name = "METRES",
        default_value_t = 5.0,
        requires = "steep",
        help_heading = "Output",
        hide_short_help = true
    )]
    steep_height: f64,
    #[command(flatten, next_help_heading = "Output")]
    grid: GridArgs,
    #[command(flatten, next_help_heading = "Output")]
    base: BaseArgs,
    #[command(flatten, next_help_heading = "Input")]
    shift: ShiftArgs,
    #[command(flatten, next_help_heading = "Output")]
    to_crs: CellsCrsArgs,
    #[command(flatten, next_help_heading = "Part of the map")]
    part: PartArgs,
    #[command(flatten)]
    surface: SurfaceArgs,
}

const TO_CRS_HELP: &str = "For contours: coordinate reference system of the height map [default: the working CRS]";
const INPUT_HELP: &str = "Height map (.tif, .asc, .exr, .png, .xyz, LandXML triangles), or contour lines (.geojson, .json, .gpkg, .shp, .fgb, .parquet, .dxf, .kml, \
                          .gml, .csv and others), \
                          or a .xml, .zip or folder of 基盤地図情報";

const EXAMPLES: &str = "\
Examples:
  tokosen derive dem.tif --slope slope.tif --aspect aspect.tif --hillshade shade.png
  tokosen derive dem.tif --hillshade shade.tif --multidirectional --z-factor 2
  tokosen derive dem.asc --steep steep.gpkg
  tokosen derive contours.gpkg --cell 5 --steep steep.gpkg --slope slope.tif
  tokosen derive contours.gpkg --base published_dem.tif --cell 5 --flow-accumulation flow.tif
  tokosen derive dem.tif --flow-accumulation streams.tif --catchments catchments.gpkg
  tokosen derive dem.tif --outlet 1234,5678 --catchments above.gpkg --stream-lines streams.gpkg --threshold 100000
  tokosen derive dem.tif --flood depth.tif --flood-level 12.5
  tokosen derive dem.tif --steep very_steep.geojson --steep-angle 45 --steep-height 10";

/// Greatest height of a steep place that may be asked for, metres; no slope on Earth is higher.
const HIGHEST: f64 = 10_000.0;

/// The outputs that are asked for; their files are opened before the work.
struct Outputs {
    slope: Option<StagedOutput>,
    aspect: Option<StagedOutput>,
    shade: Option<StagedOutput>,
    steep: Option<StagedOutput>,
    flow: FlowOutputs,
}

/// The height map, what it was made from, and the findings about it.
struct SourceDem {
    heights: Arc<dyn RasterRows>,
    source: HeightsFrom,
    findings: Vec<Finding>,
    /// Number of findings outside of the part of the map that is written.
    outside: usize,
}

/// Runs the verb.
pub fn run(args: &DeriveArgs, console: &Console) -> Result<(), Failure> {
    let is_raster = args.input.map.content()? == Content::HeightMap;
    args.check(is_raster, console)?;
    let light = args.light.params()?;
    let outputs = args.open()?;
    let shift = args.shift.read()?;
    let read = if is_raster { args.read_raster(console)? } else { args.read_contours(console)? };
    let SourceDem { heights, source, mut findings, outside } = read.shifted(shift.as_ref())?;
    let in_file = |error: Error| error.in_file(args.input.map.file());
    check(&*heights).map_err(in_file)?;

    let (grid, scale) = (heights.grid(), GroundScale::on(&heights.grid(), heights.crs()));
    let tiff = args.cog.layout();
    let rasters = [
        (&outputs.slope, Quantity::Slope, Derivative::Slope),
        (&outputs.aspect, Quantity::Aspect, Derivative::Aspect),
        (&outputs.shade, Quantity::Shade, Derivative::Shade(&light)),
    ];
    for (staged, quantity, derivative) in rasters {
        let derived = Derived { heights: &*heights, scale: &scale, derivative };
        let params = RasterParams { quantity, tiff, ..RasterParams::default() };
        write_if_asked(staged.as_ref(), &params, &derived, console)?;
    }
    let note = steep_note(source, args.steep_height);
    let steeps = match &outputs.steep {
        Some(staged) => {
            let memory = memory::available();
            let params = SteepParams { angle: args.steep_angle, height: args.steep_height, memory };
            let found = console.step("steep places", || steep(&*heights, &scale, &params)).map_err(in_file)?;
            console.step("writing", || write_layers(staged, &[steep_areas(&found, &note)], heights.crs()))?;
            Some(found)
        }
        None => None,
    };
    let found = args.flow.write(&outputs.flow, (&*heights, &scale), tiff, (&mut findings, console))?;
    findings.extend(heights.findings());
    // For contours, `--strict` was checked when they were read.
    if args.input.map.strict {
        let checked = all_right(&args.input.map.name(), &findings);
        checked.map_err(|error| summary::after_findings(error, &findings, console))?;
    }

    summary::findings(&findings, console);
    let mut flow = outputs.flow;
    let of_flow = [flow.directions.take(), flow.accumulation.take()];
    let rasters = [outputs.slope, outputs.aspect, outputs.shade].into_iter().chain(of_flow);
    for staged in rasters.flatten() {
        let path = staged.commit()?;
        console.say(&format!("written    {} ({} x {} cells)", path.display(), grid.cols, grid.rows));
    }
    if let (Some(staged), Some(steeps)) = (outputs.steep, &steeps) {
        describe(&staged.commit()?, steeps, args, console);
        console.say(&format!("note       {note}"));
    }
    flow.commit(&args.flow, &found, heights.crs(), console)?;
    summary::close_part(findings.len(), outside, console);
    Ok(())
}

impl SourceDem {
    /// The same in another height system, if one is asked for. The rows are then in memory.
    fn shifted(mut self, shift: Option<&Shift>) -> Result<Self, Failure> {
        if let Some(shift) = shift {
            let mut dem = self.heights.whole()?.into_owned();
            self.findings.extend(self.heights.findings());
            self.findings.extend(shift.apply(&mut dem)?);
            self.heights = Arc::new(dem);
        }
        Ok(self)
    }
}

impl DeriveArgs {
    /// Checks what can be checked before anything is read.
    fn check(&self, is_raster: bool, console: &Console) -> Result<(), Failure> {
        if self.outputs().next().is_none() {
            let flags = "--slope, --aspect, --hillshade, --steep, --flow-direction, --flow-accumulation, --catchments, \
                         --stream-lines or --flood";
            return Err(Failure::Usage(format!("choose an output: {flags} FILE")));
        }
        let crs = self.to_crs.to_crs.as_ref();
        let flags = &console.flags;
        let for_contours = flags
            .first(ABOUT_GRID.iter().chain(&["--to-crs", "--base", "--points"]))
            .or_else(|| InputArgs::about_contours(flags, &["--plane-unit"]))
            .or_else(|| flags.first(&["--extent", "--clip"]).or_else(|| about_surface(flags)));
        if let Some(flag) = for_contours.filter(|_| is_raster) {
            return Err(Failure::Usage(format!("{flag} applies to contours, but the input is a height map")));
        }
        if !is_raster {
            self.grid.check(crs)?;
            self.surface.check(flags)?;
        }
        if !(self.steep_angle > 0.0 && self.steep_angle < 90.0) {
            let message = format!("--steep-angle is {}, it must be more than 0 and less than 90", self.steep_angle);
            return Err(Failure::Usage(message));
        }
        if !(0.0..=HIGHEST).contains(&self.steep_height) {
            let message = format!("--steep-height is {}, it must be from 0 to {HIGHEST}", self.steep_height);
            return Err(Failure::Usage(message));
        }
        if let Some(path) = &self.steep {
            check_vector(path, "steep places are written as .gpkg, .geojson, .shp, .kml or .kmz")?;
        }
        self.flow.check()?;
        self.shift.check(true)?;
        self.cog.check(self.rasters())?;
        let files = self.input.map.files()?;
        let inputs = files.iter().map(PathBuf::as_path).chain(self.grid.like.as_deref()).chain(self.surface.files());
        let inputs =
            inputs.chain(self.part.file()).chain(self.base.file()).chain(self.flow.inputs()).chain(self.shift.file());
        let inputs: Vec<&Path> = inputs.collect();
        Ok(console.check_paths(&inputs, &self.outputs().collect::<Vec<_>>())?)
    }

    fn outputs(&self) -> impl Iterator<Item = PlannedOutput<'_>> {
        let rasters = self.rasters().map(PlannedOutput::from);
        let steep = self.steep.as_deref().map(|path| PlannedOutput { path, layers: &[STEEP_LAYER] });
        rasters.chain(steep).chain(self.flow.vectors())
    }

    fn rasters(&self) -> impl Iterator<Item = &Path> {
        let own = [&self.slope, &self.aspect, &self.hillshade].into_iter().flatten().map(PathBuf::as_path);
        own.chain(self.flow.rasters())
    }

    fn open(&self) -> Result<Outputs, Failure> {
        let raster = |path: &Option<PathBuf>| path.as_deref().map(open_raster).transpose();
        Ok(Outputs {
            slope: raster(&self.slope)?,
            aspect: raster(&self.aspect)?,
            shade: raster(&self.hillshade)?,
            steep: self.steep.as_deref().map(StagedOutput::create).transpose()?,
            flow: self.flow.open()?,
        })
    }

    fn read_raster(&self, console: &Console) -> Result<SourceDem, Failure> {
        let path = self.input.map.file();
        let read = console.step("reading", || open_dem(path))?;
        let unit = self.input.map.plane_unit.map(UnitArg::unit);
        let rows = read.value.heights;
        let crs = in_plane_unit(rows.crs().cloned(), unit).map_err(|error| error.in_file(path))?;
        let grid = rows.grid();
        // The finding says that heights were in feet. Then x and y may be so too.
        if metres_per_unit(&grid, crs.as_ref()).is_none()
            && read.findings.iter().any(|finding| finding.kind == FindingKind::HeightUnit)
        {
            return Err(Error::PlaneUnitUnknown.in_file(path).into());
        }
        let name = crs.as_ref().and_then(|crs| crs.name()).unwrap_or_else(|| "unknown".into());
        console.say(&format!("input      {} ({} x {} cells)", path.display(), grid.cols, grid.rows));
        console.say(&format!("crs        {name}"));
        let heights = Arc::new(WithCrs { rows, crs });
        Ok(SourceDem { heights, source: HeightsFrom::HeightMap, findings: read.findings, outside: 0 })
    }

    fn read_contours(&self, console: &Console) -> Result<SourceDem, Failure> {
        let grid = self.grid.spec(self.to_crs.to_crs.as_ref())?;
        let sea = self.surface.water.sea;
        let scope = Scope { part: Some(&self.part), sea, grid: Some(&grid), ..Scope::of(&self.surface.frame) };
        let mut input = self.input.read(scope, console)?;
        input.check_plane_unit().map_err(|error| summary::after_findings(error, &input.findings, console))?;
        let source = HeightsFrom::Contours(find_interval(&input.map.contours).map(|interval| interval.step));
        self.base.add_to(&mut input, console)?;
        let options = Options {
            base_fade: self.base.base_fade,
            ..self.surface.options(Some(&grid), Triangles::Reference, ElevationUnit::Metre)?
        };
        let mut terrain = build(&mut input, &self.surface, &options, console)?;
        self.input.map.describe(&terrain.surface.map, console);
        summary::surface(&terrain.surface, &terrain.findings, console);
        let map = terrain.height_map(&grid, console)?.collect(&mut terrain.findings);
        map.base.iter().for_each(|base| base::describe(base, console));
        Ok(SourceDem {
            heights: Arc::new(map.dem),
            source,
            findings: terrain.findings,
            outside: terrain.findings_outside,
        })
    }
}

fn describe(path: &Path, steeps: &Steeps, args: &DeriveArgs, console: &Console) {
    let area: f64 = steeps.parts.iter().map(|part| part.area).sum();
    console.say(&format!(
        "steep      {} areas of at least {} degrees and {} m, {}; {} lower areas were not written",
        steeps.areas,
        args.steep_angle,
        args.steep_height,
        Units::METRES.area(area),
        steeps.too_low
    ));
    console.say(&format!("written    {}, layer steep ({} polygons)", path.display(), steeps.parts.len()));
}
