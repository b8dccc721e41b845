//! `tokosen contour`: a height map in, contour lines out.

use std::borrow::Cow;
use std::path::PathBuf;

use clap::Args;
use geo::MultiPolygon;
use tokosen::bands::bands_of_height_map;
use tokosen::base::error::{Error, FindingKind};
use tokosen::base::{ElevationUnit, Units};
use tokosen::cartography::{Ground, OfInput, mean_slope};
use tokosen::contour::{ContourLayer, Target};
use tokosen::crs::{Crs, HeightSystem, Reprojection};
use tokosen::dem::contour::{ContourParams, DemContours, contours};
use tokosen::draw::Scene;
use tokosen::io::raster::read_dem;
use tokosen::io::tiles::TileFormat;
use tokosen::io::{Content, PlannedOutput, VectorSource, content, write_layers_back};
use tokosen::raster::Dem;
use tokosen::terrain::read_area_on;

use super::console::Console;
use super::failure::Failure;
use super::for_map::{self, ForMapArgs, SCALE_HELP};
use super::levels::{LevelsArgs, output_layers};
use super::part::PartArgs;
use super::picture::{Asked, Drawing, PictureArgs, scale_of_lines};
use super::source::source;
use super::unit::in_units;
use super::vertical_shift::ShiftArgs;
use super::viewer::{ViewerArgs, title};
use super::{memory, plane, summary, tiles};

/// Contour lines of a height map
///
/// Heights are those at the centres of cells. Between four neighbouring centres, lines cross the sides where linear
/// interpolation gives the level. The written lines cross the same sides, within --tolerance. They run smoothly, have
/// few vertices, and never cross or touch each other. A height equal to a level is always above it. Lines are closed, or end at
/// the outermost cell centres, beside cells without data, and at the border of --extent and --clip. Rings around single
/// cells are kept.
///
/// Each line has the attributes elev, source (height_map), is_index, depression (lower ground inside) and closed. Higher
/// ground is on the right of its direction. Elevations are in metres, or in the unit of --to-unit, whatever the unit of
/// the height map is. In a DXF, layers show index contours (CONTOUR-HEIGHT_MAP-INDEX); it holds no other attributes and
/// no coordinate reference system.
#[derive(Debug, Args)]
#[command(
    after_help = EXAMPLES,
    mut_arg("scale", |_| scale_of_lines(SCALE_HELP).help_heading("Output")),
    mut_arg("extent", |arg| arg.help(EXTENT_HELP)),
    mut_arg("extent_crs", |arg| arg.help(EXTENT_CRS_HELP)),
    mut_arg("clip", |arg| arg.help(CLIP_HELP)),
)]
pub struct ContourArgs {
    /// Height map (.tif, .asc, .exr, .png, .xyz, LandXML triangles), or a .xml, .zip or folder of 基盤地図情報
    #[arg(help_heading = "Input")]
    dem: PathBuf,
    #[command(flatten, next_help_heading = "Input")]
    shift: ShiftArgs,
    /// Coordinate reference system of the height map, if the file names none or a wrong one: EPSG:6668, or a WKT
    #[arg(long, value_name = "CRS", value_parser = plane::crs, help_heading = "Input")]
    crs: Option<Crs>,
    /// Contour lines to write: .geojson, .gpkg, .fgb, .parquet, .dxf, .shp, .kml or .kmz. With several intervals, a GeoPackage gets one layer
    /// per interval; other formats get one file per interval. Or map tiles: .pmtiles, .mbtiles or 'FOLDER/{z}/{x}/{y}.pbf'
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    output: PathBuf,
    #[command(flatten)]
    levels: LevelsArgs,
    #[command(flatten, next_help_heading = "Output")]
    for_map: ForMapArgs,
    /// Largest horizontal distance between a line and the contour of the height map [units of the height map; default:
    /// half a cell, the smaller side]. At least a thousandth of a cell is used. Beyond about one cell, it has no more effect
    #[arg(long, value_name = "DISTANCE", help_heading = "Output")]
    tolerance: Option<f64>,
    /// Smooth the heights first, for noisy height maps: a Gaussian with this standard deviation, corrected so that even
    /// slopes and gentle tops stay [units of the height map; at most 50 cells]. --tolerance is then the distance to the
    /// contour of the smoothed heights. The summary states the changes of the heights
    #[arg(long, value_name = "DEVIATION", help_heading = "Output")]
    smooth: Option<f64>,
    #[command(flatten, next_help_heading = "Output")]
    picture: PictureArgs,
    #[command(flatten, next_help_heading = "Output")]
    viewer: ViewerArgs,
    #[command(flatten, next_help_heading = "Part of the map")]
    part: PartArgs,
    /// Outer border: a polygon in a vector file. Cells whose centres lie outside of it are no ground, so lines end beside them
    /// [default: all cells with heights]
    #[arg(long, value_name = "FILE", value_parser = source(), help_heading = "Part of the map")]
    frame: Option<VectorSource>,
}

const EXTENT_HELP: &str =
    "Write this part of the map only; the heights around it still count [coordinates of the height map]";
const EXTENT_CRS_HELP: &str = "Coordinate reference system of --extent, if it is not that of the height map";
const CLIP_HELP: &str = "Write the part of the map inside the polygons of this file only; the heights around it still count. \
                         With --frame, the ground ends at the polygon";

const EXAMPLES: &str = "\
Examples:
  tokosen contour dem.tif -i 5 -o contours.gpkg
  tokosen contour dem.tif -i 5,2,1 -o contours.gpkg --preview look.png
  tokosen contour FG-GML-5437-45-DEM5A.zip -i 2 -o contours.geojson --to-crs EPSG:6677
  tokosen contour noisy.tif -i 1 --smooth 3 -o contours.shp
  tokosen contour dem.tif -i 5 --clip district.geojson -o district.gpkg
  tokosen contour dem.tif -i 10 --to-unit ft -o every_10_feet.dxf
  tokosen contour dem.asc --crs EPSG:6677 --levels 12.5,13 --tolerance 0.2 -o flood.fgb
  tokosen contour dem.tif -i 10 -o contours.pmtiles
  tokosen contour dem.tif -i 10 -o map/contours.pmtiles --viewer map/index.html";

/// Runs the verb.
pub fn run(args: &ContourArgs, console: &Console) -> Result<(), Failure> {
    let targets = args.levels.targets()?;
    let unit = args.levels.to_unit.unit();
    let plan = args.for_map.plan(&args.output, &args.levels, &targets, &args.picture)?;
    let names = args.levels.layer_names(&targets);
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let band_names = args.levels.bands.names(&targets, unit);
    let band_names: Vec<&str> = band_names.iter().map(String::as_str).collect();
    args.check(&names, &band_names, console)?;
    let shift = args.shift.read()?;
    let staged = TileFormat::open(&args.output)?;
    let band_output = args.levels.bands.open()?;
    let viewer = args.viewer.open(&[&args.output], &title(&[&args.dem]))?;
    let attribution = args.viewer.attribution.as_deref();
    let mut picture = Asked::MapOfLines(&args.picture).open(&console.flags)?;

    console.plan(["reading"]);
    console.plan(args.smooth.map(|_| "smoothing"));
    console.plan(["tracing"]);
    console.plan(plan.map(|_| "choosing"));
    console.plan(["writing"]);
    console.plan(picture.as_ref().map(|_| "drawing"));
    let read = console.step("reading", || read_dem(&args.dem))?;
    let (mut dem, mut height_system, mut findings) = (read.value.dem, read.value.height_system, read.findings);
    if let Some(crs) = &args.crs {
        dem.crs = Some(crs.clone());
        findings.retain(|finding| finding.kind != FindingKind::UnknownCrs);
    }
    if let Some(shift) = shift {
        findings.extend(shift.apply(&mut dem)?);
        height_system = dem.crs.as_ref().and_then(Crs::height_system);
    }
    let dem = match &args.frame {
        Some(source) => {
            let frame = read_area_on(&dem, source, memory::available())?;
            dem.inside(&frame).map_err(|error| error.in_file(&source.path))?
        }
        None => dem,
    };
    let part = args.part.on(&dem)?;
    let reprojection = Reprojection::unmoved(dem.crs.clone());
    let back = args.levels.way(&args.output, &reprojection)?;
    let map_params = for_map::settle(plan, args.levels.which.base_level, || mean_slope(&dem), console);
    let params = ContourParams {
        targets: for_map::traced(map_params.as_ref(), &targets),
        unit,
        index_every: args.levels.which.index,
        tolerance: args.tolerance,
        smooth: args.smooth,
        part: part.clone(),
        memory: memory::available(),
    };
    let mut found = contours(&dem, &params, console)?;
    let ground = Ground::of_dem(&dem, part.as_ref());
    let count =
        map_params.map(|map| for_map::apply(&map, (&mut found.layers[..], names[0]), OfInput::AsNew, &ground, console));
    // The picture and the labels are those of the part.
    let shown = part.as_ref().map_or(Cow::Borrowed(&dem), |part| Cow::Owned(shown(&dem, part)));
    let [low, high] = shown.corners();
    let height = for_map::label_height(map_params.as_ref(), &ground);
    let labels = args.levels.labels.place(&found.layers, height, (low, high), unit)?;
    let map_tiles = match found.layers.first() {
        Some(layer) => {
            let lines = (&params.targets[0], layer);
            tiles::write(&staged, &args.output, (&args.levels, attribution), lines, &reprojection, console)?
        }
        None => None,
    };
    let written = match &map_tiles {
        Some(_) => Vec::new(),
        None => console.step("writing", || {
            let all = output_layers(&found.layers, labels.as_deref(), &names, &back);
            write_layers_back(&staged, &all, &back)
        })?,
    };
    let bounds = for_map::bounds(map_params.as_ref(), &targets);
    let bands = match &band_output {
        Some(output) => {
            let layers = band_names.iter().zip(&bounds).zip(&found.layers);
            let layers: Vec<_> = layers.map(|((name, target), layer)| (*name, target, layer)).collect();
            let areas =
                |target: &Target, layer: &ContourLayer| bands_of_height_map(&dem, layer, target, unit, part.as_ref());
            output.write(&layers, areas, &back, (&mut findings, console))?
        }
        None => Vec::new(),
    };
    if let Some(picture) = &mut picture {
        let finest = bounds.iter().zip(&found.layers).max_by_key(|(_, layer)| layer.lines.len());
        let lines = finest.map_or(&[][..], |(_, layer)| &layer.lines);
        let scene = Scene::of_height_map(&shown, lines, Units::all(unit)).within(part.as_ref());
        let scene = args.levels.bands.tinted(scene, finest, unit);
        picture.draw(&Drawing::Map(scene), console)?;
    }

    summary::findings(&findings, console);
    args.describe(&dem, height_system.as_ref(), &found, console);
    staged.commit()?;
    if let Some(written) = &map_tiles {
        tiles::describe(&args.output, written, unit.symbol(), console);
    }
    for (k, layer) in found.layers.iter().enumerate().filter(|_| map_tiles.is_none()) {
        let path = written.get(k).or(written.first()).map(|path| path.display().to_string()).unwrap_or_default();
        let vertices: usize = layer.lines.iter().map(|line| line.points.len()).sum();
        let (name, lines) = (&layer.name, layer.lines.len());
        console
            .say(&format!("written    {path}, layer {name} ({lines} lines, {vertices} vertices{})", in_units(&back)));
        if let Some(labels) = &labels {
            console.say(&format!("           {} labels on index contours", labels[k].len()));
        }
        for_map::describe(map_params.as_ref(), &count.unwrap_or_default(), console);
        if layer.lines.is_empty() {
            let why = why_empty(&found.levels[k], found.heights, unit, part.is_some());
            console.warn(&format!("layer {name} has no line: {why}"));
        }
    }
    band_output.map(|output| output.commit(&bands, console)).transpose()?;
    viewer.map(|viewer| viewer.commit(console)).transpose()?;
    picture.map(|picture| picture.commit(console)).transpose()?;
    summary::close(findings.len(), console);
    Ok(())
}

impl ContourArgs {
    /// Checks what can be checked before anything is read.
    fn check(&self, layers: &[&str], bands: &[&str], console: &Console) -> Result<(), Failure> {
        if let Some(bad) = self.tolerance.filter(|t| !(t.is_finite() && *t >= 0.0)) {
            return Err(Failure::Usage(format!("--tolerance is {bad}, it must be 0 or more")));
        }
        if let Some(bad) = self.smooth.filter(|s| !(s.is_finite() && *s > 0.0)) {
            return Err(Failure::Usage(format!("--smooth is {bad}, it must be more than 0")));
        }
        self.shift.check(true)?;
        tiles::check(&self.output, &self.levels)?;
        self.viewer.check(&[&self.output])?;
        let files = tiles::files(&self.output, layers)?;
        let contours = files.iter().map(|path| PlannedOutput { path, layers });
        let files = self.levels.bands.files(bands, &self.levels.to_crs)?;
        let contours = contours.chain(files.iter().map(|path| PlannedOutput { path, layers: bands }));
        let others = [&self.picture.preview, &self.viewer.viewer].into_iter().flatten();
        let outputs: Vec<PlannedOutput<'_>> = contours.chain(others.map(|path| path.as_path().into())).collect();
        let areas = self.part.file().into_iter().chain(self.frame.iter().map(|source| source.path.as_path()));
        let areas = areas.chain(Asked::Map(&self.picture).font()).chain(self.shift.file());
        console.check_paths(&[self.dem.as_path()].into_iter().chain(areas).collect::<Vec<_>>(), &outputs)?;
        if content(&self.dem)? == Content::Contours {
            let message = "holds contour lines, not heights; 'tokosen densify' makes denser contours of them, 'tokosen dem' a \
                           height map";
            return Err(Failure::Work(Error::file(&self.dem, message)));
        }
        Ok(())
    }

    fn describe(&self, dem: &Dem, heights: Option<&HeightSystem>, found: &DemContours, console: &Console) {
        let crs = dem.crs.as_ref().and_then(|crs| crs.name()).unwrap_or_else(|| "unknown".into());
        console.say(&format!("input      {} ({} x {} cells)", self.dem.display(), dem.grid.cols, dem.grid.rows));
        console.say(&format!("crs        {crs}"));
        let heights = heights.map_or("the input does not name their system", |system| system.name.as_str());
        console.say(&format!("heights    {heights}"));
        let units = Units::all(self.levels.to_unit.unit());
        if let (Some(change), Some(deviation)) = (&found.smoothing, self.smooth) {
            console.say(&format!(
                "smoothed   Gaussian with a standard deviation of {deviation}; largest change of a height {}, RMS {}",
                units.rough_height(change.largest),
                units.rough_height(change.rms)
            ));
        }
        let kind = if self.tolerance.is_some() { "" } else { " (half a cell)" };
        let of = if self.smooth.is_some() { "smoothed heights" } else { "height map" };
        console.say(&format!(
            "tolerance  {}{kind}: lines are within it of the contour of the {of}, which crosses {} sides of cells",
            found.tolerance, found.crossings
        ));
        if let Some(why) = self.tolerance.and_then(|asked| found.raised_from(asked)) {
            console.warn(&format!("--tolerance {why}"));
        }
        let lowest = found.levels.iter().flatten().find(|level| **level as f32 == found.heights[0]);
        if let Some(level) = lowest.filter(|_| found.layers.iter().any(|layer| !layer.lines.is_empty())) {
            console.say(&format!(
                "           no line at {}, the lowest height: a height equal to a level is above it",
                in_unit(*level, self.levels.to_unit.unit())
            ));
        }
    }
}

/// The part of a height map that a picture shows. A part that holds no centre of a cell is shown with what is around it.
fn shown(dem: &Dem, part: &MultiPolygon<f64>) -> Dem {
    let around = dem.around(part);
    around.clone().inside(part).unwrap_or(around)
}

/// Why a layer has no line. `levels` are those from the lowest to the highest height.
fn why_empty(levels: &[f64], [low, high]: [f32; 2], unit: ElevationUnit, is_part: bool) -> String {
    let is_crossed = |level: &f64| low < *level as f32 && *level as f32 <= high;
    if is_part {
        return "the height map crosses none of its levels in this part".into();
    }
    if levels.iter().any(is_crossed) {
        return "no four neighbouring cells with heights lie on both sides of one of its levels".into();
    }
    match levels.iter().find(|level| **level as f32 == low) {
        Some(level) => format!(
            "the level {} is the lowest height, and a height equal to a level is above it",
            in_unit(*level, unit)
        ),
        None => format!(
            "none of its levels is between the lowest and the highest height, {} and {}",
            Units::all(unit).height(f64::from(low)),
            Units::all(unit).height(f64::from(high))
        ),
    }
}

fn in_unit(level: f64, unit: ElevationUnit) -> String {
    Units::all(unit).height(level)
}
