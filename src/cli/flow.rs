//! The arguments about the flow of water, and the files that they ask for.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use tokosen::base::error::Finding;
use tokosen::crs::Crs;
use tokosen::dem::derive::{
    Accumulated, Flood, FlowDirections, FlowLine, catchment_parts, catchments, flow_accumulation, flow_directions,
    flow_lines,
};
use tokosen::io::layer::{CATCHMENTS_LAYER, FLOOD_LAYER, STREAM_LINES_LAYER, of_catchments, of_flow_lines, of_outlets};
use tokosen::io::raster::{Quantity, RasterParams, TiffLayout};
use tokosen::io::{PlannedOutput, StagedOutput, write_layers};
use tokosen::raster::{Dem, GroundScale, RasterRows};
use tokosen::terrain::Outlets;

use super::console::Console;
use super::extensions::{check_vector, is_raster, open_raster};
use super::failure::Failure;
use super::flood::{FloodArgs, Streams};
use super::outlets::{self, OutletArgs};
use super::output::write_if_asked;
use super::{memory, places};

#[derive(Debug, Clone, Args)]
pub struct FlowArgs {
    /// Direction of flow: 1 east, 2 south-east, 4 south, 8 south-west, 16 west, 32 north-west, 64 north, 128 north-east,
    /// 0 outlet: .tif, .exr, .png (16 bit), .asc or .xyz
    #[arg(long, value_name = "FILE")]
    pub flow_direction: Option<PathBuf>,
    /// How much ground drains through each cell, including itself, see --accumulation-unit: .tif, .exr, .png (16 bit), .asc
    /// or .xyz
    #[arg(long, value_name = "FILE")]
    pub flow_accumulation: Option<PathBuf>,
    /// Whether --flow-accumulation counts cells or adds up their areas
    #[arg(
        long,
        value_enum,
        value_name = "UNIT",
        default_value_t = UnitOfArea::Cells,
        requires = "flow_accumulation",
        hide_short_help = true
    )]
    pub accumulation_unit: UnitOfArea,
    /// Catchments, one for each outlet: polygons (.gpkg, .geojson, .shp, .kml or .kmz), or their numbers (.tif, .exr, .png, .asc or
    /// .xyz)
    #[arg(long, value_name = "FILE")]
    pub catchments: Option<PathBuf>,
    #[command(flatten)]
    pub outlets: OutletArgs,
    /// Streams as lines with heights, where at least --threshold drains through a cell, with Strahler order, length, fall and
    /// upstream area: .gpkg, .geojson, .shp, .fgb, .parquet, .dxf, .kml or .kmz
    #[arg(long, value_name = "FILE", requires = "threshold")]
    pub stream_lines: Option<PathBuf>,
    /// Upstream area from which on there is a stream, for --stream-lines and --flood-level +H [square metres]
    #[arg(long, value_name = "AREA")]
    pub threshold: Option<f64>,
    #[command(flatten)]
    pub flood: FloodArgs,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum UnitOfArea {
    /// Number of cells
    Cells,
    /// Square metres
    M2,
}

/// The files, opened before the work.
pub struct FlowOutputs {
    pub directions: Option<StagedOutput>,
    pub accumulation: Option<StagedOutput>,
    catchments: Option<StagedOutput>,
    lines: Option<StagedOutput>,
    flood: Option<StagedOutput>,
}

/// What was found.
#[derive(Default)]
pub struct Found {
    catchments: Option<CatchmentsFound>,
    lines: Vec<FlowLine>,
    flood: Option<Flood>,
}

/// The catchments in a file.
struct CatchmentsFound {
    count: usize,
    /// The number of polygons, if they are polygons.
    polygons: Option<usize>,
    /// The outlets that were asked for.
    outlets: Option<Outlets>,
}

/// The height map that water flows over.
struct Ground<'a> {
    dem: &'a Dem,
    scale: &'a GroundScale,
    params: RasterParams,
    console: &'a Console,
}

impl FlowArgs {
    /// Refuses files of kinds that do not fit, and arguments that contradict each other.
    pub fn check(&self) -> Result<(), Failure> {
        let kinds = "catchments are written as .gpkg, .geojson, .shp, .kml or .kmz, or as a raster: .tif, .exr, .png, .asc or .xyz";
        let areas = self.catchments.as_deref().filter(|path| !is_raster(path));
        areas.map_or(Ok(()), |path| check_vector(path, kinds))?;
        if let Some(path) = &self.stream_lines {
            check_vector(path, "streams are written as .gpkg, .geojson, .shp, .fgb, .parquet, .dxf, .kml or .kmz")?;
        }
        self.outlets.check()?;
        self.flood.check()?;
        let uses_threshold = self.stream_lines.is_some() || self.flood.is_above_streams();
        match self.threshold {
            Some(area) if !(area.is_finite() && area > 0.0) => {
                Err(Failure::Usage(format!("--threshold is {area}, it must be more than 0")))
            }
            Some(_) if !uses_threshold => {
                Err(Failure::Usage("--threshold goes with --stream-lines or --flood-level +H".into()))
            }
            None if uses_threshold => Err(Failure::Usage("--flood-level +H needs --threshold AREA".into())),
            _ => Ok(()),
        }
    }

    /// The rasters.
    pub fn rasters(&self) -> impl Iterator<Item = &Path> {
        let catchments = self.catchments.as_deref().filter(|path| is_raster(path));
        let files =
            [self.flow_direction.as_deref(), self.flow_accumulation.as_deref(), catchments, self.flood.raster()];
        files.into_iter().flatten()
    }

    /// The files of lines and areas, each with its layer.
    pub fn vectors(&self) -> impl Iterator<Item = PlannedOutput<'_>> {
        let catchments = self.catchments.as_deref().filter(|path| !is_raster(path));
        let files: [(Option<&Path>, &[&str]); 3] = [
            (catchments, &[CATCHMENTS_LAYER]),
            (self.stream_lines.as_deref(), &[STREAM_LINES_LAYER]),
            (self.flood.areas(), &[FLOOD_LAYER]),
        ];
        files.into_iter().filter_map(|(path, layers)| Some(PlannedOutput { path: path?, layers }))
    }

    /// The files that places are read from.
    pub fn inputs(&self) -> impl Iterator<Item = &Path> {
        places::files(&self.outlets.outlet).chain(places::files(&self.flood.flood_from))
    }

    /// Opens the files.
    pub fn open(&self) -> Result<FlowOutputs, Failure> {
        let raster = |path: &Option<PathBuf>| path.as_deref().map(open_raster).transpose();
        let any = |path: &Option<PathBuf>| path.as_deref().map(StagedOutput::create).transpose();
        Ok(FlowOutputs {
            directions: raster(&self.flow_direction)?,
            accumulation: raster(&self.flow_accumulation)?,
            catchments: any(&self.catchments)?,
            lines: any(&self.stream_lines)?,
            flood: any(&self.flood.flood)?,
        })
    }

    /// Computes what is asked for and writes it, still under temporary names. The findings are about outlets.
    pub fn write(
        &self,
        outputs: &FlowOutputs,
        (heights, scale): (&dyn RasterRows, &GroundScale),
        tiff: TiffLayout,
        (findings, console): (&mut Vec<Finding>, &Console),
    ) -> Result<Found, Failure> {
        let FlowOutputs { directions: to_directions, accumulation, catchments, lines, flood } = outputs;
        let needs_directions = self.flood.is_above_streams()
            || [to_directions, accumulation, catchments, lines].into_iter().any(Option::is_some);
        let mut found = Found::default();
        if !needs_directions && flood.is_none() {
            return Ok(found);
        }
        let dem = &*console.step("reading", || heights.whole())?;
        let ground = Ground { dem, scale, params: RasterParams { tiff, ..RasterParams::default() }, console };
        if !needs_directions {
            if let Some(staged) = flood {
                found.flood = Some(self.flood.write(staged, ground.parts(), None, (findings, console))?);
            }
            return Ok(found);
        }
        let directions = console.step("flow direction", || flow_directions(dem, scale, memory::available()))?;
        if to_directions.is_some() {
            ground.write(to_directions.as_ref(), Quantity::FlowDirection, &directions.raster())?;
        }
        if accumulation.is_some() && self.accumulation_unit == UnitOfArea::Cells {
            let cells = ground.accumulation(&directions, Accumulated::Cells);
            ground.write(accumulation.as_ref(), Quantity::FlowAccumulation, &cells)?;
        }
        let needs_areas = self.threshold.is_some()
            || !self.outlets.outlet.is_empty()
            || (accumulation.is_some() && self.accumulation_unit == UnitOfArea::M2);
        let areas = needs_areas.then(|| ground.accumulation(&directions, Accumulated::SquareMetres(scale)));
        if let (Some(areas), UnitOfArea::M2) = (&areas, self.accumulation_unit) {
            ground.write(accumulation.as_ref(), Quantity::UpstreamArea, areas)?;
        }
        let mut outlets = None;
        if let (Some(areas), false) = (&areas, self.outlets.outlet.is_empty()) {
            outlets = Some(self.outlets.find(areas, scale, findings)?);
        }
        if let (Some(areas), Some(threshold)) = (&areas, self.threshold) {
            if let Some(staged) = lines {
                let name = "streams";
                found.lines = console.step(name, || flow_lines(dem, &directions, areas, scale, threshold))?;
                let layer = of_flow_lines(&found.lines);
                console.step("writing", || write_layers(staged, &[layer], dem.crs.as_ref()))?;
            }
            if let (Some(staged), true) = (flood, self.flood.is_above_streams()) {
                let streams = Some(Streams { directions: &directions, areas, threshold });
                found.flood = Some(self.flood.write(staged, ground.parts(), streams, (&mut *findings, console))?);
            }
        }
        // The catchments need the memory.
        drop(areas);
        if let Some(staged) = catchments {
            found.catchments = Some(ground.write_catchments(staged, &directions, outlets, findings)?);
        }
        if let (Some(staged), None) = (flood, &found.flood) {
            found.flood = Some(self.flood.write(staged, ground.parts(), None, (findings, console))?);
        }
        Ok(found)
    }
}

impl Ground<'_> {
    fn parts(&self) -> (&Dem, &GroundScale, &RasterParams) {
        (self.dem, self.scale, &self.params)
    }

    fn accumulation(&self, directions: &FlowDirections, accumulated: Accumulated<'_>) -> Dem {
        self.console.step("flow accumulation", || flow_accumulation(directions, accumulated))
    }

    fn write(&self, staged: Option<&StagedOutput>, quantity: Quantity, raster: &Dem) -> Result<(), Failure> {
        write_if_asked(staged, &RasterParams { quantity, ..self.params }, raster, self.console)
    }

    fn write_catchments(
        &self,
        staged: &StagedOutput,
        directions: &FlowDirections,
        outlets: Option<Outlets>,
        findings: &mut Vec<Finding>,
    ) -> Result<CatchmentsFound, Failure> {
        let Self { console, scale, .. } = *self;
        let found = console.step("catchments", || match &outlets {
            Some(outlets) => outlets.catchments(directions).collect(findings),
            None => catchments(directions),
        });
        let polygons = if is_raster(&staged.path()) {
            self.write(Some(staged), Quantity::Catchment, &found.raster()?)?;
            None
        } else {
            let parts = console.step("catchments", || catchment_parts(&found, scale));
            let layer = match &outlets {
                Some(outlets) => of_outlets(&parts, &outlets.outlets),
                None => of_catchments(&parts),
            };
            console.step("writing", || write_layers(staged, &[layer], self.dem.crs.as_ref()))?;
            Some(parts.len())
        };
        Ok(CatchmentsFound { count: found.count(), polygons, outlets })
    }
}

impl FlowOutputs {
    /// Puts the files of catchments, streams and floods in their places, and prints what is in them.
    pub fn commit(self, args: &FlowArgs, found: &Found, crs: Option<&Crs>, console: &Console) -> Result<(), Failure> {
        if let (Some(staged), Some(CatchmentsFound { count, polygons, outlets })) = (self.catchments, &found.catchments)
        {
            let path = staged.commit()?;
            outlets.iter().for_each(|found| outlets::describe(found, crs, console));
            let polygons =
                polygons.map(|count| format!(", layer {CATCHMENTS_LAYER} ({count} polygons)")).unwrap_or_default();
            console.say(&format!("written    {}{polygons}, {count} catchments", path.display()));
        }
        if let Some(staged) = self.lines {
            let path = staged.commit()?;
            let length: f64 = found.lines.iter().map(|line| line.length).sum();
            let order = found.lines.iter().map(|line| line.strahler).max().unwrap_or(0);
            let (count, km) = (found.lines.len(), length / 1e3);
            console.say(&match count {
                0 => "streams    none: nowhere does so much ground as --threshold drain through a cell".into(),
                _ => format!("streams    {count} lines, {km:.2} km, up to Strahler order {order}"),
            });
            console.say(&format!("written    {}, layer {STREAM_LINES_LAYER}", path.display()));
        }
        if let (Some(staged), Some(flood)) = (self.flood, &found.flood) {
            args.flood.describe(flood, &staged.commit()?, console);
        }
        Ok(())
    }
}
