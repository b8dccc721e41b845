//! `tokosen densify`: contour lines in, denser contour lines out.

use std::path::{Path, PathBuf};

use clap::Args;
use tokosen::bands::bands_of_surface;
use tokosen::base::error::{Error, Finding};
use tokosen::base::{ElevationUnit, Units};
use tokosen::cartography::slope_between;
use tokosen::contour::Target;
use tokosen::contour::{ContourLayer, Source};
use tokosen::crs::FromWorking;
use tokosen::draw::Scene;
use tokosen::io::tiles::TileFormat;
use tokosen::io::{Content, PlannedOutput, StagedOutput, content, write_layers_back};
use tokosen::layers::{LayerParams, are_given};
use tokosen::surface::{SurfaceKind, Triangles, working_pits};
use tokosen::terrain::{HtmlParams, MeasureOptions, Pair, Side, measure};
use tokosen::{Input, Options, Terrain};

use super::compare::{draw, open_page, summarise};
use super::console::Console;
use super::diagnostics::DiagnosticsArgs;
use super::failure::Failure;
use super::flags::Flags;
use super::for_map::{self, ForMapArgs, SCALE_HELP};
use super::height_map::{ABOUT_HEIGHT_MAP, HeightMapArgs};
use super::input::{InputArgs, Scope};
use super::job::Job;
use super::levels::{LevelsArgs, output_layers};
use super::output::DemOutput;
use super::part::PartArgs;
use super::picture::{Asked, Drawing, PictureArgs, scale_of_lines};
use super::summary;
use super::surface::{ABOUT_PITS, KindArg, SurfaceArgs};
use super::terrain_page;
use super::terrain_tiles::ABOUT_TILES;
use super::tiles;
use super::unit::in_units;
use super::viewer::ViewerArgs;

/// Contour lines at a finer interval
///
/// All contours of the input are written unchanged, vertex for vertex, with new lines between them. If the interval is
/// coarser than theirs, only the lines at its levels are written. Each line has the
/// attributes elev, source (input or interpolated), is_index, depression (lower ground inside) and closed. Higher
/// ground is on the right of its direction. --uncertainty adds err_v and err_h (expected errors of height and position,
/// in metres and in units of the working CRS) and inferred (the input says little about the ground there: a top, a pit,
/// a wide flat, the strip along the frame). Heights (elev, err_v, z, the height map) are in metres, or in the unit of
/// --to-unit. In a DXF, layers show source and index contours (CONTOUR-INPUT-INDEX); it holds no other attributes and
/// no coordinate reference system.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES, mut_arg("scale", |_| scale_of_lines(SCALE_HELP).help_heading("Output")))]
pub struct DensifyArgs {
    #[command(flatten)]
    input: InputArgs,
    /// Contour lines to write: .geojson, .gpkg, .fgb, .parquet, .dxf, .shp, .kml or .kmz. With several intervals, a GeoPackage gets one layer
    /// per interval; other formats get one file per interval. Or map tiles: .pmtiles, .mbtiles or 'FOLDER/{z}/{x}/{y}.pbf'
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    output: PathBuf,
    #[command(flatten)]
    levels: LevelsArgs,
    #[command(flatten, next_help_heading = "Output")]
    for_map: ForMapArgs,
    /// Keep all contours of the input also where the interval is coarser than theirs
    #[arg(long, help_heading = "Output", hide_short_help = true)]
    keep_input: bool,
    /// Leave out vertices of new contours where a straight piece stays within this distance of the line; 0 keeps all. No
    /// lines cross by it [units of the working CRS; default: 1 % of the mean spacing of the contours]
    #[arg(long, value_name = "TOLERANCE", help_heading = "Output", hide_short_help = true)]
    simplify: Option<f64>,
    /// Also write a height map: .tif, .exr, .png, .asc or .xyz (needs --cell, --cell-degrees or --like), or terrain tiles,
    /// as 'tokosen dem' does. It is in the CRS of --to-crs too, unless --like names another grid. 'tokosen dem --base' also
    /// covers the ground outside the frame
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    dem: Option<PathBuf>,
    #[command(flatten, next_help_heading = "Output")]
    height_map: HeightMapArgs,
    /// Also compare the surface with this height map, at the centres of its cells; see 'tokosen compare --help'
    #[arg(long, value_name = "RASTER", help_heading = "Output", hide_short_help = true)]
    compare: Option<PathBuf>,
    /// Also write a report of that comparison, with maps, charts and tables: .html
    #[arg(long, value_name = "FILE", requires = "compare", help_heading = "Output", hide_short_help = true)]
    report: Option<PathBuf>,
    /// Also write a page that shows the terrain and the finest of these lines in 3-D, as 'tokosen mesh' does: .html
    #[arg(long, value_name = "FILE", help_heading = "Output", hide_short_help = true)]
    page: Option<PathBuf>,
    #[command(flatten, next_help_heading = "Output")]
    picture: PictureArgs,
    #[command(flatten, next_help_heading = "Output")]
    viewer: ViewerArgs,
    #[command(flatten, next_help_heading = "Part of the map")]
    part: PartArgs,
    #[command(flatten, next_help_heading = "Output")]
    diagnostics: DiagnosticsArgs,
    #[command(flatten)]
    surface: SurfaceArgs,
}

const EXAMPLES: &str = "\
Examples:
  tokosen densify contours.gpkg -i 2 -o contours_2m.gpkg
  tokosen densify contours.shp -a ELEV -i 5,2,1 -o dense.gpkg
  tokosen densify contours.geojson -i 2 -o dense.shp --dem dem.tif --cell 5 --preview look.png
  tokosen densify contours.gpkg -i 2 --uncertainty -o contours_2m.gpkg --preview look.png
  tokosen densify degrees.geojson -i 2 -o metric.gpkg --to-crs EPSG:6677
  tokosen densify feet.gpkg --unit ft -i 2 --to-unit ft -o every_2_feet.gpkg
  tokosen densify contours.zip -i 1 -o dense.gpkg --compare published_dem.zip --report compared.html
  tokosen densify contours.gpkg -i 2 -o contours_2m.gpkg --page terrain.html
  tokosen densify contours.gpkg --levels 12.5,13,13.5 -o flood.geojson --points spots.gpkg
  tokosen densify contours.gpkg -i 5 --zooms 10:100,12:20,14:5 -o contours.pmtiles
  tokosen densify contours.gpkg -i 5 -o map/contours.pmtiles --dem map/terrain.pmtiles --max-zoom 13 --viewer map/index.html";

/// Runs the verb.
pub fn run(args: &DensifyArgs, console: &Console) -> Result<(), Failure> {
    args.check(&console.flags)?;
    let targets = args.levels.targets()?;
    let unit = args.levels.to_unit.unit();
    let plan = args.for_map.plan(&args.output, &args.levels, &targets, &args.picture)?;
    let names = args.levels.layer_names(&targets);
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let files = tiles::files(&args.output, &names)?;
    let band_names = args.levels.bands.names(&targets, unit);
    let band_names: Vec<&str> = band_names.iter().map(String::as_str).collect();
    let band_files = args.levels.bands.files(&band_names, &args.levels.to_crs)?;
    let mut job = args.start([(&files, &names), (&band_files, &band_names)], console)?;
    console.plan(["slicing"]);
    console.plan(plan.map(|_| "choosing"));
    console.plan(["writing"]);
    let staged = TileFormat::open(&args.output)?;
    let viewer = args.viewer.open(&args.maps(), &args.input.map.title())?;
    let attribution = args.viewer.attribution.as_deref();
    let dem_output = args
        .dem
        .as_deref()
        .map(|path| DemOutput::open(path, &args.height_map, args.levels.to_crs.to_crs.as_ref(), unit, attribution))
        .transpose()?;
    let page = args.page.as_deref().map(terrain_page::open).transpose()?;
    let diagnostics = args.diagnostics.open()?;
    let band_output = args.levels.bands.open()?;
    let mut findings = Vec::new();
    let reference = Reference::open(args, &mut findings, console)?;

    let sea = args.surface.water.sea_in_metres(unit);
    let grid = dem_output.as_ref().map(|output| &output.grid);
    let mut input = job.read(Scope { part: Some(&args.part), sea, grid, ..Scope::of(&args.surface.frame) })?;
    input.findings.append(&mut findings);
    let map_params = for_map::settle(plan, args.levels.which.base_level, || slope_between(&input.map), console);
    let traced = for_map::traced(map_params.as_ref(), &targets);
    let back = args.levels.way(&args.output, &input.reprojection)?;
    let options =
        Options { uncertainty: args.height_map.uncertainty(), ..args.surface.options(grid, Triangles::Smooth, unit)? };
    let params = LayerParams {
        targets: traced.clone(),
        unit,
        index_every: args.levels.which.index,
        simplify: args.simplify,
        keep_input: args.keep_input,
        memory: None,
    };
    let wants_pits = diagnostics.is_some() || console.flags.first(&ABOUT_PITS).is_some();
    let made = |input: &mut Input, options: Options| -> Result<(Terrain, Vec<ContourLayer>), Failure> {
        let terrain = job.build(input, &args.surface, options)?;
        let layers = terrain.contours_with(params.clone(), console)?;
        Ok((terrain, layers))
    };
    let linear = if !wants_pits && args.wants_lines_of_input(&input, &traced, unit)? {
        let options = Options { kind: SurfaceKind::Linear, ..options.clone() };
        Some(made(&mut input.clone(), options)?).filter(|(_, layers)| layers.iter().all(is_of_input))
    } else {
        None
    };
    let has_surface = linear.is_none();
    let (mut terrain, mut layers) = linear.map_or_else(|| made(&mut input, options), Ok)?;
    let ground = terrain.map_ground();
    let count = map_params.map(|params| {
        let of_input = terrain.of_input(params.kinds.interval, unit, args.keep_input);
        for_map::apply(&params, (&mut layers[..], names[0]), of_input, &ground, console)
    });
    let height = for_map::label_height(map_params.as_ref(), &ground);
    let labels = args.levels.labels.place(&layers, height, terrain.surface.frame.extent(), unit)?;
    let map_tiles = match layers.first() {
        Some(layer) => {
            let lines = (&traced[0], layer);
            let way = &input.reprojection;
            tiles::write(&staged, &args.output, (&args.levels, attribution), lines, way, console)?
        }
        None => None,
    };
    let written = match &map_tiles {
        Some(_) => Vec::new(),
        None => console.step("writing", || {
            let all = output_layers(&layers, labels.as_deref(), &names, &back);
            write_layers_back(&staged, &all, &back)
        })?,
    };
    let bounds = for_map::bounds(map_params.as_ref(), &targets);
    let bands = match &band_output {
        Some(output) => {
            let layers = band_names.iter().zip(&bounds).zip(&layers);
            let layers: Vec<_> = layers.map(|((name, target), layer)| (*name, target, layer)).collect();
            let areas = |target: &Target, layer: &ContourLayer| bands_of_surface(&terrain.surface, layer, target, unit);
            output.write(&layers, areas, &back, (&mut terrain.findings, console))?
        }
        None => Vec::new(),
    };
    let map = dem_output.as_ref().map(|output| output.write(&terrain, None, console)).transpose()?;
    let map = map.map(|map| map.collect(&mut terrain.findings));
    let pits = if wants_pits { working_pits(&terrain.surface) } else { None };
    diagnostics.iter().try_for_each(|file| file.write(&terrain, pits.as_deref().unwrap_or_default(), unit))?;
    // The layer with the most lines.
    let finest = bounds.iter().zip(&layers).max_by_key(|(_, layer)| layer.lines.len());
    let lines = finest.map_or(&[][..], |(_, layer)| &layer.lines);
    if let Some(page) = &page {
        let target = finest.map(|(target, _)| target.clone());
        let params = HtmlParams { title: args.input.map.title(), target, unit, ..HtmlParams::default() };
        terrain_page::write(page, &terrain, &params, console)?;
    }
    let scene = Scene::of_surface(&terrain.surface, lines, &terrain.reprojection, Units::all(unit));
    let scene = args.levels.bands.tinted(scene, finest, unit);
    job.draw(&Drawing::Map(scene.within(terrain.part())))?;

    let findings = std::mem::take(&mut terrain.findings);
    job.report(&findings, &terrain.surface.map);
    if has_surface {
        summary::surface(&terrain.surface, &terrain.findings, console);
    } else {
        console.say("surface    none: the input has contours at all levels that are asked for");
    }
    pits.iter().for_each(|pits| summary::pits(pits, "smooth surface", console));
    staged.commit()?;
    if let Some(written) = &map_tiles {
        tiles::describe(&args.output, written, unit.symbol(), console);
    }
    for (k, layer) in layers.iter().enumerate() {
        if map_tiles.is_none() {
            describe(written.get(k).or(written.first()), layer, &back, console);
        }
        if let Some(labels) = &labels {
            console.say(&format!("           {} labels on index contours", labels[k].len()));
        }
        for_map::describe(map_params.as_ref(), &count.unwrap_or_default(), console);
        args.explain_coarse(&traced[k], terrain.surface.interval.step, console);
    }
    band_output.map(|output| output.commit(&bands, console)).transpose()?;
    diagnostics.map(|file| file.commit(console)).transpose()?;
    if let (Some(output), Some(map)) = (dem_output, &map) {
        output.commit(map, console)?;
    }
    viewer.map(|viewer| viewer.commit(console)).transpose()?;
    page.map(|page| terrain_page::commit(page, console)).transpose()?;
    job.commit_picture()?;
    let outside = terrain.findings_outside;
    if let Some(reference) = reference {
        reference.compare(args, terrain, console)?;
    }
    summary::close_part(findings.len(), outside, console);
    Ok(())
}

/// A height map that the surface is compared with, and the file of the report.
struct Reference {
    side: Side,
    page: Option<StagedOutput>,
}

impl Reference {
    /// Opens the report and reads the height map, if one is asked for.
    fn open(args: &DensifyArgs, findings: &mut Vec<Finding>, console: &Console) -> Result<Option<Self>, Failure> {
        let Some(path) = &args.compare else { return Ok(None) };
        if content(path)? == Content::Contours {
            let message = "holds contours; --compare takes a height map ('tokosen compare' takes both)";
            return Err(Failure::Work(Error::file(path, message)));
        }
        let page = args.report.as_deref().map(open_page).transpose()?;
        let side = Side::read_height_map(path, console)?.collect(findings);
        Ok(Some(Self { side, page }))
    }

    /// Compares the surface with it, and prints the figures.
    fn compare(self, args: &DensifyArgs, terrain: Terrain, console: &Console) -> Result<(), Failure> {
        let Some(nodes) = self.side.nodes() else { return Ok(()) };
        console.say("");
        let side = Side::of_terrain(Path::new(&args.input.map.name()), args.surface.surface.kind(), terrain);
        let pair = Pair::on(side, self.side, nodes, console)?;
        let found = measure(&pair, &MeasureOptions { unit: pair.unit(), ..MeasureOptions::default() }, console)?;
        if let Some(page) = self.page {
            draw(&page, &pair, &found, console)?;
            console.say(&format!("written    {}", page.commit()?.display()));
        }
        summarise(&pair, &found, console);
        Ok(())
    }
}

impl DensifyArgs {
    /// Checks what can be checked before anything is read.
    fn check(&self, flags: &Flags) -> Result<(), Failure> {
        let about = ABOUT_HEIGHT_MAP.iter().chain(&ABOUT_TILES);
        if let Some(flag) = flags.first(about).filter(|_| self.dem.is_none()) {
            return Err(Failure::Usage(format!("{flag} needs --dem FILE")));
        }
        if let Some(bad) = self.simplify.filter(|t| !(t.is_finite() && *t >= 0.0)) {
            return Err(Failure::Usage(format!("--simplify is {bad}, it must be 0 or more")));
        }
        tiles::check(&self.output, &self.levels)?;
        self.viewer.check(&self.maps())?;
        self.surface.check(flags)
    }

    /// The outputs that may be map tiles.
    fn maps(&self) -> Vec<&Path> {
        [Some(&self.output), self.dem.as_ref()].into_iter().flatten().map(PathBuf::as_path).collect()
    }

    /// Whether only lines are asked for, and the input has its own at all their levels. Where it has no gaps, no surface is needed.
    fn wants_lines_of_input(&self, input: &Input, targets: &[Target], unit: ElevationUnit) -> Result<bool, Failure> {
        let Self { dem, compare, page, picture, surface, .. } = self;
        let wants_more = [dem, compare, page, &picture.preview].into_iter().any(Option::is_some);
        let has_features = surface.files().next().is_some() || surface.water.sea.is_some();
        let is_plain = !wants_more && !has_features && !self.height_map.uncertainty;
        Ok(is_plain && surface.surface == KindArg::Spline && are_given(&input.map, targets, unit)?)
    }

    /// Checks the paths of all files. `layers` are the files of contours and bands, with the layers in them.
    fn start<'a>(&'a self, layers: [(&Vec<PathBuf>, &Vec<&str>); 2], console: &'a Console) -> Result<Job<'a>, Failure> {
        let item = self.dem.as_deref().and_then(|path| self.height_map.stac_item(path));
        let others = [&self.height_map.grid.like, &self.compare].into_iter().flatten().map(PathBuf::as_path);
        let planned = layers.into_iter().flat_map(|(files, layers)| files.iter().map(move |path| (path, layers)));
        let outputs = planned.map(|(path, layers)| PlannedOutput { path, layers }).chain(
            [&self.dem, &self.report, &self.viewer.viewer, &self.page]
                .into_iter()
                .flatten()
                .map(|path| path.as_path().into()),
        );
        let outputs = outputs.chain(self.diagnostics.planned()).chain(item.as_deref().map(PlannedOutput::from));
        let inputs = others.chain(self.surface.files()).chain(self.part.file());
        Job::start(&self.input, inputs, outputs, Asked::MapOfLines(&self.picture), console)
    }

    /// Says that contours of the input are left out, if they are.
    fn explain_coarse(&self, target: &Target, interval: f64, console: &Console) {
        if !self.keep_input && target.is_coarser(self.levels.to_unit.unit(), interval) {
            console.say(&format!(
                "           the interval is coarser than the {} of the input: contours at other levels are left \
                 out (--keep-input keeps them)",
                console.units().height(interval)
            ));
        }
    }
}

/// Whether all lines of a layer are those of the input.
fn is_of_input(layer: &ContourLayer) -> bool {
    layer.lines.iter().all(|line| line.source == Source::Input) && layer.artefact_rings + layer.dead_ends == 0
}

/// One line of the summary about a layer.
pub fn describe(path: Option<&PathBuf>, layer: &ContourLayer, back: &FromWorking, console: &Console) {
    let new = layer.lines.iter().filter(|l| l.source == Source::Interpolated).count();
    let vertices: usize = layer.lines.iter().map(|l| l.points.len()).sum();
    let artefact_rings = match layer.artefact_rings {
        0 => String::new(),
        n => format!("; {n} tiny closed contours, each around one computed point, were not written"),
    };
    let dead_ends = match layer.dead_ends {
        0 => String::new(),
        n => format!("; {n} lines that end at a ring of their level, where contours are missing, were not written"),
    };
    let path = path.map(|p| p.display().to_string()).unwrap_or_default();
    console.say(&format!(
        "written    {path}, layer {} ({} input lines, {new} new lines, {vertices} vertices{artefact_rings}{dead_ends}{})",
        layer.name,
        layer.lines.len() - new,
        in_units(back)
    ));
}
