//! Heights as pictures in tiles: terrain tiles.

use std::path::Path;

use glam::DVec2;
use image_webp::{ColorType as WebpColor, WebPEncoder};
use png::{BitDepth, ColorType, Encoder};
use serde_json::Map;

use super::archive::{About, Archive, Kind, name_of, tile_number};
use super::format::TileFormat;
use crate::raster::{ColourCode, PngEncoding};
use crate::staged::StagedOutput;
use tokosen_core::base::error::{Error, Finding, FindingKind, Result};
use tokosen_core::base::parallel;
use tokosen_core::base::progress::{Progress, step};
use tokosen_core::raster::Dem;
use tokosen_core::tiles::{TilePlace, ZoomHeights, check_latitudes, lowest_zoom, tile_size, to_degrees, zoom_heights};

/// The highest zoom of terrain tiles: pixels of 7 cm at the equator.
pub const HIGHEST_ZOOM: u8 = 20;
/// Tiles that are made before they are written.
const BATCH: usize = 256;

/// How a tile is stored. Both lose nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TileImage {
    /// PNG.
    #[default]
    Png,
    /// WebP without losses.
    Webp,
}

impl TileImage {
    /// How the tiles of a path are stored if this is asked for: in a folder, its extension says it. None if no tile has it.
    pub fn in_path(self, path: &Path) -> Option<Self> {
        match TileFormat::folder(path).map(|(_, extension)| extension) {
            None => Some(self),
            Some("png") => Some(Self::Png),
            Some("webp") => Some(Self::Webp),
            Some(_) => None,
        }
    }
}

/// How to write terrain tiles.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TerrainTiles {
    /// The highest zoom.
    pub zoom: u8,
    /// Pixels of a tile's side.
    pub side: usize,
    /// How heights become colours.
    pub encoding: PngEncoding,
    /// How a tile is stored.
    pub image: TileImage,
    /// The source of the data, which maps must show.
    pub attribution: Option<String>,
}

/// What was written.
#[derive(Debug, Clone, PartialEq)]
pub struct WrittenTerrain {
    /// Each zoom, in order.
    pub zooms: Vec<TerrainZoom>,
    /// Pixels of the highest zoom without a height of the height map, in tiles that have some.
    pub filled: usize,
}

/// Tiles of which more than this share lies beyond the height map are a finding.
const BEYOND: f64 = 0.9;

impl WrittenTerrain {
    /// The finding about tiles that lie nearly all beyond the height map.
    pub fn beyond_map(&self, tiles: &TerrainTiles) -> Option<Finding> {
        let count = self.zooms.last().filter(|zoom| zoom.zoom == tiles.zoom)?.tiles;
        let share = self.filled as f64 / (count * tiles.side * tiles.side) as f64;
        let message = format!(
            "{:.0} % of the pixels of zoom {} lie beyond the map, which is small beside a tile; choose a higher --max-zoom",
            100.0 * share,
            tiles.zoom
        );
        (share > BEYOND).then(|| Finding::general(FindingKind::TilesBeyondMap, message))
    }
}

/// The tiles of a zoom.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TerrainZoom {
    /// The zoom.
    pub zoom: u8,
    /// Number of its tiles.
    pub tiles: usize,
    /// Bytes of all its tiles.
    pub bytes: u64,
}

/// The size of a pixel in Web Mercator metres.
pub fn pixel_size(zoom: u8, side: usize) -> f64 {
    tile_size(zoom) / side as f64
}

/// Writes heights as terrain tiles: into a `.pmtiles`, a `.mbtiles`, or a folder (see [`TileFormat`](super::TileFormat)).
///
/// The height map is in Web Mercator, and its cells are the pixels of the highest zoom ([`pixel_size`]). Each pixel of a lower
/// zoom is the mean of four heights. Heights are rounded to the nearest step of the encoding. Pixels without a height get one
/// from the heights around them, and tiles without any height are left out: map libraries show a pixel without a height as a
/// hole of ten kilometres.
///
/// # Errors
/// One of these is the case:
/// - The cells of the height map are other ones, or none has a height.
/// - The encoding is grey, or a height is beyond those of the encoding.
/// - The operating system reports an error.
pub fn write_terrain_tiles(
    out: &StagedOutput,
    path: &Path,
    dem: &Dem,
    tiles: &TerrainTiles,
    progress: &dyn Progress,
) -> Result<WrittenTerrain> {
    let Some(code) = tiles.encoding.colours() else {
        return Err(Error::Parameter("terrain tiles hold heights as colours, not as grey".into()));
    };
    let size = DVec2::new(dem.grid.cols as f64, dem.grid.rows as f64) * dem.grid.cell;
    check_latitudes(dem.grid.corner - DVec2::new(0.0, size.y), dem.grid.corner)?;
    let lowest = lowest_zoom(size, tiles.zoom);
    let all = step(progress, "overviews", || zoom_heights(dem, tiles.zoom, lowest, tiles.side))?;
    let about = about(path, dem, size, tiles, [lowest, tiles.zoom], code);
    let mut written = WrittenTerrain { zooms: Vec::new(), filled: 0 };
    let work = || -> Result<()> {
        let mut archive = Archive::create(out, path, &about)?;
        for heights in &all {
            let mut places = heights.tiles();
            places.sort_by_key(|tile| tile_number(*tile));
            let mut zoom = TerrainZoom { zoom: heights.zoom, tiles: places.len(), bytes: 0 };
            for batch in places.chunks(BATCH) {
                let encoded = parallel::map_each(batch, |tile| encode(heights, *tile, tiles, code, path));
                for (tile, bytes) in batch.iter().zip(encoded) {
                    let bytes = bytes?;
                    zoom.bytes += bytes.len() as u64;
                    archive.add(*tile, &bytes)?;
                }
            }
            written.zooms.push(zoom);
            if heights.zoom == tiles.zoom {
                let unknown = |tile: &TilePlace| heights.pixels(*tile).filter(|(_, is_known)| !is_known).count();
                written.filled = parallel::map_each(&places, unknown).into_iter().sum();
            }
        }
        archive.finish()
    };
    step(progress, "tiles", work).map_err(|e| out.with_final_name(e))?;
    Ok(written)
}

/// A tile as it is stored.
fn encode(
    heights: &ZoomHeights,
    tile: TilePlace,
    tiles: &TerrainTiles,
    code: ColourCode,
    path: &Path,
) -> Result<Vec<u8>> {
    let side = tiles.side as u32;
    let mut pixels = Vec::with_capacity(3 * tiles.side * tiles.side);
    for (height, _) in heights.pixels(tile) {
        let Some(colour) = code.colour(f64::from(height)) else {
            let TilePlace { zoom, x, y } = tile;
            let message =
                format!("the height {height} m in tile {zoom}/{x}/{y} is beyond those of the encoding {}", code.name());
            return Err(Error::file(path, message));
        };
        pixels.extend(colour);
    }
    let mut bytes = Vec::new();
    match tiles.image {
        TileImage::Png => {
            let mut encoder = Encoder::new(&mut bytes, side, side);
            encoder.set_color(ColorType::Rgb);
            encoder.set_depth(BitDepth::Eight);
            let written = encoder.write_header().and_then(|mut writer| {
                writer.write_image_data(&pixels)?;
                writer.finish()
            });
            written.map_err(|e| Error::file_cause(path, "cannot be written", e))?;
        }
        TileImage::Webp => {
            let written = WebPEncoder::new(&mut bytes).encode(&pixels, side, side, WebpColor::Rgb8);
            written.map_err(|e| Error::file_cause(path, "cannot be written", e))?;
        }
    }
    Ok(bytes)
}

fn about(path: &Path, dem: &Dem, size: DVec2, tiles: &TerrainTiles, zooms: [u8; 2], code: ColourCode) -> About {
    let corner = dem.grid.corner;
    let south_west = to_degrees(DVec2::new(corner.x, corner.y - size.y));
    let north_east = to_degrees(DVec2::new(corner.x + size.x, corner.y));
    let mut more = Map::new();
    more.insert("encoding".into(), code.name().into());
    more.insert("tile_size".into(), tiles.side.to_string().into());
    more.extend(tiles.attribution.iter().map(|text| ("attribution".into(), text.clone().into())));
    About {
        name: name_of(path),
        kind: match tiles.image {
            TileImage::Png => Kind::Png,
            TileImage::Webp => Kind::Webp,
        },
        min_zoom: zooms[0],
        max_zoom: zooms[1],
        bounds: [south_west.x, south_west.y, north_east.x, north_east.y],
        more,
    }
}
