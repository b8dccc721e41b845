//! Contours as vector tiles.

use std::collections::HashMap;
use std::path::Path;

use glam::DVec2;
use serde_json::{Map, Value as Json, json};

use super::archive::{About, Archive, Kind, compressed, name_of, tile_number, vector_layer};
use super::format::TileFormat;
use super::mvt::{self, Feature, Value};
use super::spool::Spool;
use crate::staged::StagedOutput;
use tokosen_core::base::ElevationUnit;
use tokosen_core::base::error::{Error, Result};
use tokosen_core::base::parallel;
use tokosen_core::base::progress::{Progress, step};
use tokosen_core::contour::{ContourLayer, ContourLine, Target};
use tokosen_core::crs::FromWorking;
use tokosen_core::tiles::{
    LevelLine, Network, Run, TilePlace, ZoomInterval, check_latitudes, check_meridian, given_intervals, intervals,
    is_shown, runs, to_degrees,
};

/// The layer of the tiles.
const LAYER: &str = "contours";
/// Bytes that a tile may have, as it is stored. Map libraries get slow beyond.
const MOST_BYTES: usize = 500_000;
/// Vertices that a tile may have. Each takes more than a byte.
const MOST_VERTICES: usize = 400_000;
/// Tiles that are made before they are written.
const BATCH: usize = 2048;

/// Contours for tiles.
#[derive(Debug, Clone, Copy)]
pub struct ContourTiles<'a> {
    /// The lines.
    pub layer: &'a ContourLayer,
    /// Their levels, in the unit of `back`.
    pub target: &'a Target,
    /// One level in so many is an index contour at each zoom; 0 for none. Of a list of levels, those of the layer are.
    pub index_every: u32,
    /// Zooms and their intervals, each until the next; empty for the default.
    pub zooms: &'a [(u8, f64)],
    /// The way to Web Mercator, and to the unit of heights in the tiles.
    pub back: &'a FromWorking,
    /// The source of the data, which maps must show.
    pub attribution: Option<&'a str>,
}

/// What was written.
#[derive(Debug, Clone, PartialEq)]
pub struct WrittenTiles {
    /// Each zoom, in order.
    pub zooms: Vec<ZoomSummary>,
}

impl WrittenTiles {
    /// Says that lines have gaps, if they have.
    pub fn gaps_in_words(&self) -> Option<String> {
        let gaps: usize = self.zooms.iter().map(|zoom| zoom.gaps).sum();
        let why = "where they lie closer to another level than the finest grid shows";
        (gaps > 0).then(|| format!("lines have {gaps} gaps in the tiles, {why}"))
    }
}

/// What a zoom shows.
#[derive(Debug, Clone, PartialEq)]
pub struct ZoomSummary {
    /// The zoom.
    pub zoom: u8,
    /// Its interval in the unit of the tiles; none if it shows a list of levels.
    pub interval: Option<f64>,
    /// Number of its tiles.
    pub tiles: usize,
    /// Bytes of all its tiles.
    pub bytes: u64,
    /// Bytes of the largest.
    pub largest: usize,
    /// Steps of the grid along a tile's side.
    pub extent: u32,
    /// Rings and short lines that are too small to be seen.
    pub too_small: usize,
    /// Gaps in lines that lie closer to another level than any grid shows.
    pub gaps: usize,
}

/// A level, as tiles show it.
struct Level {
    /// The elevation in the unit of the tiles.
    value: f64,
    /// Intervals from the base to it.
    steps: f64,
    /// Whether the lines of the layer say that it is an index contour.
    is_index: bool,
}

/// Writes contours as vector tiles: into a `.pmtiles`, a `.mbtiles`, or a folder (see [`TileFormat`]).
///
/// All tiles have one layer, `contours`. All lines of a level are one feature of a tile, with the attributes
///
/// * `ele`: the elevation, a number,
/// * `idx`: whether it is an index contour,
/// * `level`: 1 for an index contour, otherwise 0,
/// * `label`: the elevation as text.
///
/// Lines do not touch each other at any zoom. Neighbouring tiles have the same vertices of a line that both show.
///
/// # Errors
/// One of these is the case:
/// - There is no line, or one has no place in Web Mercator.
/// - The zooms are not valid.
/// - A tile has more than 500 kB.
/// - The operating system reports an error.
pub fn write_contour_tiles(
    out: &StagedOutput,
    path: &Path,
    tiles: &ContourTiles<'_>,
    progress: &dyn Progress,
) -> Result<WrittenTiles> {
    let unit = tiles.back.unit();
    let (levels, numbers) = levels(tiles.layer, tiles.target, unit);
    let lines = step(progress, "to Web Mercator", || on_map(&tiles.layer.lines, &numbers, tiles.back))?;
    let [low, high] = bounds(&lines).ok_or_else(|| Error::file(path, "there is no contour to write"))?;
    check_latitudes(low, high)?;
    lines.iter().try_for_each(|line| check_meridian(&line.points))?;
    let zooms = zooms(tiles, &levels, low, high)?;
    let shows = |level: u32, multiple: u32| is_shown(levels[level as usize].steps, multiple);
    let is_needed = |level: u32, below: u8| zooms.iter().any(|z| z.zoom < below && shows(level, z.multiple));

    progress.start("tiles", zooms.len() as u64);
    let highest = zooms[zooms.len() - 1].zoom;
    let mut network = Network::new(lines, highest);
    let mut made: Vec<(Spool, ZoomSummary)> = Vec::new();
    for (k, zoom) in zooms.iter().enumerate().rev() {
        let shown = interval(tiles.target, zoom.multiple);
        let too_small = network.simplify(zoom.zoom == highest);
        // What is far too dense would also take long.
        if let Some((tile, count)) =
            network.fullest_tile(|level| shows(level, zoom.multiple)).filter(|f| f.1 > MOST_VERTICES)
        {
            let what = format!("{count} vertices, more than {MOST_VERTICES}");
            return Err(too_large(path, tile, &what, shown, unit));
        }
        let gaps = network.to_grid();
        let mut spool = Spool::new(out.folder())?;
        let mut summary = ZoomSummary {
            zoom: zoom.zoom,
            interval: shown,
            tiles: 0,
            bytes: 0,
            largest: 0,
            extent: network.extent(),
            too_small,
            gaps,
        };
        let attributes: Vec<_> = (0..levels.len()).map(|l| attributes(&levels, l, tiles, zoom.multiple)).collect();
        let runs = in_order(runs(&network, |level| shows(level, zoom.multiple)));
        let groups: Vec<&[Run]> = runs.chunk_by(|a, b| a.tile == b.tile).collect();
        for batch in groups.chunks(BATCH) {
            let encoded = parallel::map_each(batch, |group| encode(&network, group, &attributes, path));
            for (group, bytes) in batch.iter().zip(encoded) {
                let bytes = bytes?;
                if bytes.len() > MOST_BYTES {
                    let what = format!("{} kB, more than {} kB", bytes.len() / 1000, MOST_BYTES / 1000);
                    return Err(too_large(path, group[0].tile, &what, shown, unit));
                }
                summary.largest = summary.largest.max(bytes.len());
                summary.bytes += bytes.len() as u64;
                spool.add(group[0].tile, &bytes).map_err(|e| Error::io("write", path, e))?;
            }
        }
        summary.tiles = groups.len();
        made.push((spool, summary));
        progress.advance(1);
        if k > 0 {
            network = network.coarser(|level| is_needed(level, zoom.zoom));
        }
    }
    progress.finish();
    made.reverse();
    let about = about(path, tiles, &zooms, [low, high]);
    let summaries = made.iter().map(|(_, summary)| summary.clone()).collect();
    step(progress, "archive", || {
        let mut archive = Archive::create(out, path, &about)?;
        for (spool, _) in made {
            spool.read(|tile, bytes| archive.add(tile, bytes), |e| Error::io("read", out.folder(), e))?;
        }
        archive.finish()
    })
    .map_err(|e| out.with_final_name(e))?;
    Ok(WrittenTiles { zooms: summaries })
}

/// All levels in ascending order, and the number of each by the bits of its elevation.
fn levels(layer: &ContourLayer, target: &Target, unit: ElevationUnit) -> (Vec<Level>, HashMap<u64, u32>) {
    let mut heights: Vec<(f64, bool)> = layer.lines.iter().map(|line| (line.elevation, line.index)).collect();
    heights.sort_by(|a, b| a.0.total_cmp(&b.0));
    heights.dedup_by_key(|(elevation, _)| elevation.to_bits());
    let numbers = heights.iter().zip(0..).map(|((elevation, _), k)| (elevation.to_bits(), k)).collect();
    let level = |(elevation, is_index): (f64, bool)| {
        let value = unit.from_metres(elevation);
        let steps = match target {
            Target::Interval { step, base } => (value - base) / step,
            Target::Levels(_) => 0.0,
        };
        Level { value, steps, is_index }
    };
    (heights.into_iter().map(level).collect(), numbers)
}

/// The lines in Web Mercator.
fn on_map(lines: &[ContourLine], numbers: &HashMap<u64, u32>, back: &FromWorking) -> Result<Vec<LevelLine>> {
    let line = |line: &ContourLine| {
        let place = |p: &DVec2| {
            back.place(*p).filter(|p| p.is_finite()).ok_or_else(|| {
                Error::Data(format!(
                    "a contour at {} m: {:.3} {:.3} has no place in Web Mercator",
                    line.elevation, p.x, p.y
                ))
            })
        };
        let level = numbers.get(&line.elevation.to_bits()).copied().unwrap_or_default();
        Ok(LevelLine { level, points: line.points.iter().map(place).collect::<Result<_>>()? })
    };
    parallel::map_each(lines, line).into_iter().collect()
}

fn bounds(lines: &[LevelLine]) -> Option<[DVec2; 2]> {
    let points = || lines.iter().flat_map(|line| &line.points).copied();
    Some([points().reduce(DVec2::min)?, points().reduce(DVec2::max)?])
}

/// The intervals of all zooms.
fn zooms(tiles: &ContourTiles<'_>, levels: &[Level], low: DVec2, high: DVec2) -> Result<Vec<ZoomInterval>> {
    let metres = tiles.back.unit().metres(1.0);
    // Low zooms whose interval is larger than the relief show nothing.
    let is_used = |zoom: &ZoomInterval| levels.iter().any(|level| is_shown(level.steps, zoom.multiple));
    match tiles.target {
        Target::Interval { step, .. } if tiles.zooms.is_empty() => {
            Ok(intervals(*step, metres, low, high).into_iter().skip_while(|zoom| !is_used(zoom)).collect())
        }
        Target::Interval { step, .. } => given_intervals(tiles.zooms, *step),
        Target::Levels(_) if tiles.zooms.is_empty() => {
            // All of them are at all zooms. The highest is that of an interval as narrow as they are.
            let gap = levels.windows(2).map(|pair| pair[1].value - pair[0].value).fold(f64::INFINITY, f64::min);
            let all = intervals(if gap.is_finite() { gap } else { 10.0 / metres }, metres, low, high);
            Ok(all.into_iter().map(|zoom| ZoomInterval { multiple: 1, ..zoom }).collect())
        }
        Target::Levels(_) => Err(Error::Parameter("--zooms needs an interval, not a list of levels".into())),
    }
}

fn interval(target: &Target, multiple: u32) -> Option<f64> {
    match target {
        // 0.1 times 3 is written as 0.3.
        Target::Interval { step, .. } => Some((step * f64::from(multiple) * 1e9).round() / 1e9),
        Target::Levels(_) => None,
    }
}

/// The attributes of a level at a zoom. Elevations have one type in all tiles.
fn attributes(levels: &[Level], number: usize, tiles: &ContourTiles<'_>, multiple: u32) -> [(&'static str, Value); 4] {
    let level = &levels[number];
    let is_whole = levels.iter().all(|level| level.value.fract() == 0.0 && level.value.abs() < 1e9);
    let is_index = match tiles.target {
        Target::Interval { .. } => {
            let every = multiple.saturating_mul(tiles.index_every);
            every > 1 && is_shown(level.steps, every) || every == 1 && level.is_index
        }
        Target::Levels(_) => level.is_index,
    };
    [
        ("ele", if is_whole { Value::Whole(level.value as i64) } else { Value::Real(level.value) }),
        ("idx", Value::Bool(is_index)),
        ("level", Value::Whole(i64::from(is_index))),
        ("label", Value::Text(level.value.to_string())),
    ]
}

/// The runs in the order of their tiles in archives.
fn in_order(runs: Vec<Run>) -> Vec<Run> {
    let mut numbered: Vec<(u64, Run)> = runs.into_iter().map(|run| (tile_number(run.tile), run)).collect();
    numbered.sort_by_key(|(number, run)| (*number, run.line, run.first));
    numbered.into_iter().map(|(_, run)| run).collect()
}

/// The bytes of a tile as they are stored.
fn encode(network: &Network, group: &[Run], attributes: &[[(&'static str, Value); 4]], path: &Path) -> Result<Vec<u8>> {
    let tile = group[0].tile;
    let corner = [tile.x, tile.y].map(|k| i64::from(k) * i64::from(network.extent()));
    let mut of_levels: Vec<&Run> = group.iter().collect();
    of_levels.sort_by_key(|run| network.line(run.line as usize).level);
    let level = |run: &Run| network.line(run.line as usize).level;
    let features: Vec<Feature<'_>> = of_levels
        .chunk_by(|a, b| level(a) == level(b))
        .map(|runs| {
            let mut feature = Feature::new(&attributes[level(runs[0]) as usize]);
            for run in runs {
                let line = network.line(run.line as usize);
                let vertex = |k: u32| {
                    let [x, y] = line.vertex((run.first + k) as usize);
                    [x - corner[0], y - corner[1]]
                };
                feature.add((0..run.segments + 1).map(vertex));
            }
            feature
        })
        .collect();
    let bytes =
        mvt::tile(LAYER, network.extent(), &features).map_err(|e| Error::file_cause(path, "cannot be written", e))?;
    match TileFormat::of(path) {
        // Web servers say of an archive that its tiles are compressed, but not of files.
        Some(TileFormat::Folder) => Ok(bytes),
        _ => compressed(&bytes).map_err(|e| Error::io("write", path, e)),
    }
}

/// The error about a tile that is too large: `what` it would have, and what to do.
fn too_large(path: &Path, tile: TilePlace, what: &str, interval: Option<f64>, unit: ElevationUnit) -> Error {
    let TilePlace { zoom, x, y } = tile;
    let remedy = match interval {
        Some(interval) => format!(
            "it shows every {interval} {}. State a larger interval for this zoom, or begin at a higher one, for example: \
             --zooms {zoom}:{},{}:{interval}",
            unit.symbol(),
            interval * 5.0,
            zoom + 2
        ),
        None => "write fewer levels".to_owned(),
    };
    Error::file(path, format!("the tile {zoom}/{x}/{y} would have {what}: {remedy}"))
}

fn about(path: &Path, tiles: &ContourTiles<'_>, zooms: &[ZoomInterval], bounds: [DVec2; 2]) -> About {
    let [south_west, north_east] = bounds.map(to_degrees);
    let ends = [zooms[0].zoom, zooms[zooms.len() - 1].zoom];
    let unit = tiles.back.unit().name();
    let fields = [("ele", "Number"), ("idx", "Boolean"), ("level", "Number"), ("label", "String")];
    let mut more = Map::new();
    more.insert("vector_layers".into(), vector_layer(LAYER, &format!("contour lines, ele in {unit}"), &fields, ends));
    let of_zooms = zooms.iter().filter_map(|z| Some((z.zoom.to_string(), json!(interval(tiles.target, z.multiple)?))));
    more.insert("intervals".into(), Json::Object(of_zooms.collect()));
    more.extend(tiles.attribution.map(|text| ("attribution".into(), text.into())));
    About {
        name: name_of(path),
        kind: Kind::Vector,
        min_zoom: ends[0],
        max_zoom: ends[1],
        bounds: [south_west.x, south_west.y, north_east.x, north_east.y],
        more,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tile_that_is_too_large_says_what_to_do() {
        let tile = TilePlace { zoom: 9, x: 136, y: 200 };
        let said = |interval| {
            too_large(Path::new("a.pmtiles"), tile, "700 kB, more than 500 kB", interval, ElevationUnit::Metre)
                .to_string()
        };
        assert!(said(Some(0.5)).contains("9/136/200 would have 700 kB"), "{}", said(Some(0.5)));
        assert!(said(Some(0.5)).ends_with("--zooms 9:2.5,11:0.5"), "{}", said(Some(0.5)));
        assert!(said(None).ends_with("write fewer levels"), "{}", said(None));
    }
}
