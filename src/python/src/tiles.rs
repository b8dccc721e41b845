//! Map tiles: contours as vector tiles, heights as terrain tiles, and the page that shows them.

use std::path::{Path, PathBuf};

use pyo3::prelude::*;
use tokosen::base::ElevationUnit;
use tokosen::base::error::Severity;
use tokosen::cli::write_viewer;
use tokosen::contour::{ContourLayer, Interval, Target};
use tokosen::crs::{Crs, Reprojection};
use tokosen::io::raster::PngEncoding;
use tokosen::io::tiles::{
    ContourTiles, HIGHEST_ZOOM, TerrainTiles, TileFormat, TileImage, pixel_size, write_contour_tiles,
    write_terrain_tiles,
};
use tokosen::io::{StagedOutput, check_paths};
use tokosen::raster::Dem;
use tokosen::tiles::WEB_MERCATOR;
use tokosen::{Error, Result};

use crate::error::Warned;
use crate::error::exception;

/// What tiles show of contours by zoom.
#[derive(Debug, Clone, Copy)]
pub struct Shown {
    /// The interval of the lines, in their unit; none if they are at a list of levels.
    pub interval: Option<Interval>,
    /// One level in so many is an index contour.
    pub index: u32,
    pub unit: ElevationUnit,
}

/// How tiles are written.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Tiling {
    zooms: Vec<(u8, f64)>,
    attribution: Option<String>,
    pub overwrite: bool,
}

impl Tiling {
    /// Refuses what applies to tiles alone.
    pub fn check_no_tiles(&self, path: &Path) -> Result<()> {
        match self.zooms.is_empty() && self.attribution.is_none() {
            true => Ok(()),
            false => Err(Error::Parameter(format!(
                "{}: zooms and attribution apply to map tiles: .pmtiles, .mbtiles or FOLDER/{{z}}/{{x}}/{{y}}.pbf",
                path.display()
            ))),
        }
    }
}

/// Opens tiles at a path.
fn open(path: &Path, overwrite: bool) -> Result<StagedOutput> {
    check_paths(&[], &[path.into()], overwrite)?;
    TileFormat::open(path)
}

/// Writes contours in the system `crs` as vector tiles. Gives what to warn of.
pub fn contour_tiles(
    layer: &ContourLayer,
    crs: Option<&Crs>,
    shown: Shown,
    path: &Path,
    tiling: &Tiling,
    progress: &dyn tokosen::base::progress::Progress,
) -> Result<Option<Warned>> {
    if !TileFormat::takes_contours(path) {
        return Err(Error::Parameter(format!("{}: vector tiles in a folder are .pbf or .mvt", path.display())));
    }
    let Shown { interval, index, unit } = shown;
    let target = interval.map_or(Target::Levels(Vec::new()), Into::into);
    let way = Reprojection::unmoved(crs.cloned()).from_working(Some(&Crs::from_epsg(WEB_MERCATOR)))?;
    let tiles = ContourTiles {
        layer,
        target: &target,
        index_every: index,
        zooms: &tiling.zooms,
        back: &way.with_heights_in(unit),
        attribution: tiling.attribution.as_deref(),
    };
    let staged = open(path, tiling.overwrite)?;
    let written = write_contour_tiles(&staged, path, &tiles, progress)?;
    staged.commit()?;
    Ok(written.gaps_in_words().map(|message| (Severity::Warning.name(), "tile-gaps", message)))
}

/// Writes heights as terrain tiles, whose side has `side` pixels. Gives what to warn of.
pub fn terrain_tiles(
    dem: &Dem,
    path: &Path,
    (side, image): (usize, TileImage),
    encoding: PngEncoding,
    tiling: Tiling,
    progress: &dyn tokosen::base::progress::Progress,
) -> Result<Option<Warned>> {
    let refused = |message: &str| Err(Error::Parameter(format!("{}: {message}", path.display())));
    let Some(image) = image.in_path(path) else { return refused("terrain tiles in a folder are .png or .webp") };
    let is_mercator = dem.crs.as_ref().is_some_and(|crs| crs.epsg == Some(WEB_MERCATOR));
    let Some(zoom) =
        (0..=HIGHEST_ZOOM).find(|&zoom| is_mercator && (dem.grid.cell.x / pixel_size(zoom, side)).log2().abs() < 0.5)
    else {
        return refused("the cells are not the pixels of tiles; make the height map with max_zoom=13 or another zoom");
    };
    let tiles = TerrainTiles { zoom, side, encoding, image, attribution: tiling.attribution };
    let staged = open(path, tiling.overwrite)?;
    let written = write_terrain_tiles(&staged, path, dem, &tiles, progress)?;
    staged.commit()?;
    let finding = written.beyond_map(&tiles);
    Ok(finding.map(|finding| (finding.kind.severity().name(), finding.kind.code(), finding.message)))
}

/// Writes a page that shows the tiles in its folder. Gives their names.
#[pyfunction]
pub fn viewer(py: Python<'_>, path: PathBuf, title: &str, overwrite: bool) -> PyResult<Vec<String>> {
    let write = || -> Result<Vec<String>> {
        check_paths(&[], &[path.as_path().into()], overwrite)?;
        let staged = StagedOutput::create(&path)?;
        let names = write_viewer(&staged, title, &[])?;
        if names.is_empty() {
            return Err(Error::Parameter(format!("{}: its folder has no map tiles that tokosen made", path.display())));
        }
        staged.commit()?;
        Ok(names)
    };
    py.detach(write).map_err(|error| exception(py, &error))
}
