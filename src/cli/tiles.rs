//! Contours as map tiles on the command line: `-o FILE.pmtiles`.

use std::path::{Path, PathBuf};

use tokosen::base::error::Error;
use tokosen::contour::{ContourLayer, Target};
use tokosen::crs::{Crs, Reprojection};
use tokosen::io::tiles::{ContourTiles, TileFormat, WrittenTiles, ZoomSummary, write_contour_tiles};
use tokosen::io::{StagedOutput, VectorFormat, contour_files};
use tokosen::tiles::{EXTENT, WEB_MERCATOR};

use super::console::Console;
use super::failure::Failure;
use super::levels::LevelsArgs;

/// The kinds of files for contours, for messages.
const KINDS: &str = "contours are written as .geojson, .gpkg, .fgb, .parquet, .dxf, .shp, .kml or .kmz, or as map tiles: .pmtiles, .mbtiles or \
                     FOLDER/{z}/{x}/{y}.pbf";

/// Refuses a file that contours are not written to, and options that do not apply to it.
pub fn check(output: &Path, levels: &LevelsArgs) -> Result<(), Failure> {
    let usage = |message: String| Err(Failure::Usage(message));
    let has_attributes = TileFormat::of(output).is_none() && super::extensions::extension(output) != "dxf";
    if levels.to_depths && !has_attributes {
        return usage("--to-depths adds attributes, which neither a DXF nor map tiles have".into());
    }
    if TileFormat::of(output).is_none() {
        if VectorFormat::from_path(output).is_err() {
            return usage(format!("{}: {KINDS}", output.display()));
        }
        if !levels.zooms.zooms.is_empty() {
            return usage("--zooms applies to map tiles: .pmtiles, .mbtiles or FOLDER/{z}/{x}/{y}.pbf".into());
        }
        levels.to_crs.check(output)?;
        return levels.labels.check(output, levels.which.index);
    }
    if !TileFormat::takes_contours(output) {
        return usage(format!("{}: vector tiles in a folder are .pbf or .mvt", output.display()));
    }
    if levels.labels.labels.is_some() {
        return usage("--labels: in map tiles, each line has its label as the attribute 'label'".into());
    }
    if levels.to_crs.to_crs.as_ref().is_some_and(|crs| crs.epsg != Some(WEB_MERCATOR)) {
        return usage("--to-crs: map tiles are in Web Mercator (EPSG:3857)".into());
    }
    match levels.targets()?.as_slice() {
        [_] => Ok(()),
        _ => usage("map tiles have one interval for each zoom: give one --interval, and --zooms for the others".into()),
    }
}

/// The files that are written for layers of these names.
pub fn files(output: &Path, names: &[&str]) -> Result<Vec<PathBuf>, Error> {
    match TileFormat::of(output) {
        Some(_) => Ok(vec![output.to_owned()]),
        None => contour_files(output, names),
    }
}

/// Writes the tiles, still under their temporary name. None if the output is no set of tiles.
pub fn write(
    staged: &StagedOutput,
    output: &Path,
    (levels, attribution): (&LevelsArgs, Option<&str>),
    (target, layer): (&Target, &ContourLayer),
    reprojection: &Reprojection,
    console: &Console,
) -> Result<Option<WrittenTiles>, Failure> {
    if TileFormat::of(output).is_none() {
        return Ok(None);
    }
    let back = reprojection.from_working(Some(&Crs::from_epsg(WEB_MERCATOR)))?.with_heights_in(levels.to_unit.unit());
    let (zooms, index_every) = (levels.zooms.zooms.as_slice(), levels.which.index);
    let tiles = ContourTiles { layer, target, index_every, zooms, back: &back, attribution };
    Ok(Some(write_contour_tiles(staged, output, &tiles, console)?))
}

/// Prints what is in the tiles.
pub fn describe(output: &Path, written: &WrittenTiles, unit: &str, console: &Console) {
    let (tiles, bytes) = written.zooms.iter().fold((0, 0), |(n, b), zoom| (n + zoom.tiles, b + zoom.bytes));
    let ends = [written.zooms.first(), written.zooms.last()].map(|zoom| zoom.map_or(0, |zoom| zoom.zoom));
    console.say(&format!(
        "written    {} (zooms {} to {}, {tiles} tiles with {})",
        TileFormat::target(output).display(),
        ends[0],
        ends[1],
        size(bytes)
    ));
    for zoom in &written.zooms {
        console.say(&format!("           {}", line(zoom, unit)));
    }
    if let Some(message) = written.gaps_in_words() {
        console.warn(&format!("warning: {message}"));
    }
}

/// What a zoom shows, in words.
fn line(zoom: &ZoomSummary, unit: &str) -> String {
    let what = zoom.interval.map_or_else(|| "all levels".to_owned(), |interval| format!("every {interval} {unit}"));
    let mut text =
        format!("zoom {}: {what}, {} tiles, the largest {}", zoom.zoom, zoom.tiles, size(zoom.largest as u64));
    if zoom.extent > EXTENT {
        text += &format!(", a grid of {} steps keeps close lines apart", zoom.extent);
    }
    if zoom.too_small > 0 {
        text += &format!("; {} rings and short lines too small to be seen are left out", zoom.too_small);
    }
    text
}

/// A number of bytes in words.
pub fn size(bytes: u64) -> String {
    if bytes < 1_000_000 { format!("{:.1} kB", bytes as f64 / 1e3) } else { format!("{:.1} MB", bytes as f64 / 1e6) }
}
