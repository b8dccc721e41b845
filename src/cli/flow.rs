//! The arguments about the flow of water, and the files that they ask for.

use std::path::{Path, PathBuf};

use clap::Args;
use tokosen::dem::derive::{Catchments, catchment_parts, catchments, flow_accumulation, flow_directions};
use tokosen::io::layer::of_catchments;
use tokosen::io::raster::{DEM_EXTENSIONS, Quantity, RasterParams, TiffLayout};
use tokosen::io::{StagedOutput, write_layers};
use tokosen::raster::{GroundScale, RasterRows};

use super::console::Console;
use super::failure::Failure;
use super::memory;
use super::output::{check_vector, extension, open_raster, write_if_asked};

#[derive(Debug, Clone, Args)]
pub struct FlowArgs {
    /// Direction of flow: 1 east, 2 south-east, 4 south, 8 south-west, 16 west, 32 north-west, 64 north, 128 north-east,
    /// 0 outlet: .tif, .exr, .png (16 bit), .asc or .xyz
    #[arg(long, value_name = "FILE")]
    pub flow_direction: Option<PathBuf>,
    /// Number of cells that drain through each cell, including itself: .tif, .exr, .png (16 bit), .asc or .xyz
    #[arg(long, value_name = "FILE")]
    pub flow_accumulation: Option<PathBuf>,
    /// Catchments, one for each outlet: polygons (.gpkg, .geojson or .shp), or their numbers (.tif, .exr, .png, .asc or
    /// .xyz)
    #[arg(long, value_name = "FILE")]
    pub catchments: Option<PathBuf>,
}

/// The files, opened before the work.
pub struct FlowOutputs {
    pub directions: Option<StagedOutput>,
    pub accumulation: Option<StagedOutput>,
    pub catchments: Option<StagedOutput>,
}

/// The catchments in a file.
pub struct Written {
    catchments: usize,
    /// The number of polygons, if they are polygons.
    polygons: Option<usize>,
}

/// Whether catchments go into a raster.
fn is_raster(path: &Path) -> bool {
    DEM_EXTENSIONS.contains(&extension(path).as_str())
}

impl FlowArgs {
    /// Refuses catchments in a file that holds neither polygons nor a raster.
    pub fn check(&self) -> Result<(), Failure> {
        let kinds = "catchments are written as .gpkg, .geojson or .shp, or as a raster: .tif, .exr, .png, .asc or .xyz";
        self.areas().map_or(Ok(()), |path| check_vector(path, kinds))
    }

    /// The rasters.
    pub fn rasters(&self) -> impl Iterator<Item = &Path> {
        let catchments = self.catchments.as_ref().filter(|path| is_raster(path));
        let files = [self.flow_direction.as_ref(), self.flow_accumulation.as_ref(), catchments];
        files.into_iter().flatten().map(PathBuf::as_path)
    }

    /// The file of polygons.
    pub fn areas(&self) -> Option<&Path> {
        self.catchments.as_deref().filter(|path| !is_raster(path))
    }

    /// Opens the files.
    pub fn open(&self) -> Result<FlowOutputs, Failure> {
        let raster = |path: &Option<PathBuf>| path.as_deref().map(open_raster).transpose();
        Ok(FlowOutputs {
            directions: raster(&self.flow_direction)?,
            accumulation: raster(&self.flow_accumulation)?,
            catchments: self.catchments.as_deref().map(StagedOutput::create).transpose()?,
        })
    }
}

impl FlowOutputs {
    /// Computes what is asked for and writes it, still under temporary names.
    pub fn write(
        &self,
        heights: &dyn RasterRows,
        scale: &GroundScale,
        tiff: TiffLayout,
        console: &Console,
    ) -> Result<Option<Written>, Failure> {
        if [&self.directions, &self.accumulation, &self.catchments].into_iter().all(Option::is_none) {
            return Ok(None);
        }
        let params = |quantity| RasterParams { quantity, tiff, ..RasterParams::default() };
        let dem = &*console.step("reading", || heights.whole())?;
        let directions = console.step("flow direction", || flow_directions(dem, scale, memory::available()))?;
        if self.directions.is_some() {
            let raster = directions.raster();
            write_if_asked(self.directions.as_ref(), &params(Quantity::FlowDirection), &raster, console)?;
        }
        if self.accumulation.is_some() {
            let raster = console.step(Quantity::FlowAccumulation.name(), || flow_accumulation(&directions));
            write_if_asked(self.accumulation.as_ref(), &params(Quantity::FlowAccumulation), &raster, console)?;
        }
        let Some(staged) = &self.catchments else { return Ok(None) };
        let found: Catchments = console.step("catchments", || catchments(&directions));
        let polygons = if is_raster(&staged.path()) {
            let raster = found.raster()?;
            write_if_asked(Some(staged), &params(Quantity::Catchment), &raster, console)?;
            None
        } else {
            let parts = console.step("catchments", || catchment_parts(&found, scale));
            console.step("writing", || write_layers(staged, &[of_catchments(&parts)], dem.crs.as_ref()))?;
            Some(parts.len())
        };
        Ok(Some(Written { catchments: found.count(), polygons }))
    }
}

impl Written {
    /// The line of the summary.
    pub fn describe(&self, path: &Path, console: &Console) {
        let polygons = self.polygons.map(|count| format!(", layer catchments ({count} polygons)")).unwrap_or_default();
        console.say(&format!("written    {}{polygons}, {} catchments", path.display(), self.catchments));
    }
}
