//! Height maps as map tiles on the command line: `-o FILE.pmtiles --max-zoom Z`.

use std::path::Path;

use clap::{Args, ValueEnum};
use tokosen::GridSpec;
use tokosen::base::ElevationUnit;
use tokosen::crs::Crs;
use tokosen::io::raster::PngEncoding;
use tokosen::io::tiles::{HIGHEST_ZOOM, TerrainTiles, TileFormat, TileImage, WrittenTerrain, pixel_size};
use tokosen::tiles::WEB_MERCATOR;

use super::console::Console;
use super::failure::Failure;
use super::tiles::size;

/// The flags about terrain tiles.
pub const ABOUT_TILES: [&str; 3] = ["--max-zoom", "--tile-size", "--tile-image"];

#[derive(Debug, Clone, Args)]
pub struct TerrainTileArgs {
    /// Highest zoom of terrain tiles. Their pixels are the cells: with 512 pixels, those of zoom 12 are 19 m wide at the
    /// equator and 14 m at 45 degrees, and each further zoom halves them
    #[arg(
        long,
        value_name = "Z",
        value_parser = clap::value_parser!(u8).range(0..=i64::from(HIGHEST_ZOOM)),
        conflicts_with_all = ["cell", "cell_degrees", "like"],
        hide_short_help = true
    )]
    pub max_zoom: Option<u8>,
    /// Pixels of a terrain tile's side [default: 512]
    #[arg(long, value_enum, hide_short_help = true)]
    pub tile_size: Option<SideArg>,
    /// How terrain tiles are stored in a .pmtiles or .mbtiles; both lose nothing [default: png]
    #[arg(long, value_enum, hide_short_help = true)]
    pub tile_image: Option<ImageArg>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SideArg {
    /// 256 pixels
    #[value(name = "256")]
    Small,
    /// 512 pixels
    #[value(name = "512")]
    Large,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ImageArg {
    /// PNG, which all libraries read
    Png,
    /// WebP without losses, which is smaller
    Webp,
}

impl TerrainTileArgs {
    /// The tiles that a path asks for; none if it is another file. `crs` is the system that the cells are to be in, if it is
    /// named, and `png` how a PNG stores heights.
    pub fn tiles(
        &self,
        path: &Path,
        crs: Option<&Crs>,
        unit: ElevationUnit,
        png: Option<PngEncoding>,
    ) -> Result<Option<TerrainTiles>, Failure> {
        let usage = |message: &str| Err(Failure::Usage(format!("{}: {message}", path.display())));
        if TileFormat::of(path).is_none() {
            let Self { max_zoom, tile_size, tile_image } = self;
            let mut given =
                ABOUT_TILES.into_iter().zip([max_zoom.is_some(), tile_size.is_some(), tile_image.is_some()]);
            return match given.find(|(_, is_given)| *is_given) {
                Some((flag, _)) => usage(&format!(
                    "{flag} applies to terrain tiles: .pmtiles, .mbtiles or FOLDER/{{z}}/{{x}}/{{y}}.png"
                )),
                None => Ok(None),
            };
        }
        let Some(zoom) = self.max_zoom else {
            return usage(
                "terrain tiles need their highest zoom, which is also the size of their cells: --max-zoom 13",
            );
        };
        if crs.is_some_and(|crs| crs.epsg != Some(WEB_MERCATOR)) {
            return usage("terrain tiles are in Web Mercator (EPSG:3857), so --to-crs cannot be another one");
        }
        if unit.is_foot() {
            return usage("terrain tiles hold metres only, so --to-unit cannot be feet");
        }
        let asked = if self.tile_image == Some(ImageArg::Webp) { TileImage::Webp } else { TileImage::Png };
        let Some(image) = asked.in_path(path) else { return usage("terrain tiles in a folder are .png or .webp") };
        let side = match self.tile_size.unwrap_or(SideArg::Large) {
            SideArg::Small => 256,
            SideArg::Large => 512,
        };
        let encoding = match png {
            None => PngEncoding::Terrarium,
            Some(PngEncoding::Gray16) => {
                return usage("map libraries read no grey terrain tiles: --png-encoding terrarium, mapbox or gsi");
            }
            Some(colours) => colours,
        };
        Ok(Some(TerrainTiles { zoom, side, encoding, image, attribution: None }))
    }
}

/// The cells that are the pixels of tiles.
pub fn grid(tiles: &TerrainTiles) -> GridSpec {
    GridSpec::CellIn { size: pixel_size(tiles.zoom, tiles.side), crs: Crs::from_epsg(WEB_MERCATOR) }
}

/// Prints what is in the tiles.
pub fn describe(path: &Path, tiles: &TerrainTiles, written: &WrittenTerrain, console: &Console) {
    let (count, bytes) = written.zooms.iter().fold((0, 0), |(n, b), zoom| (n + zoom.tiles, b + zoom.bytes));
    let lowest = written.zooms.first().map_or(tiles.zoom, |zoom| zoom.zoom);
    let name = match tiles.encoding {
        PngEncoding::Mapbox => "mapbox, steps of 0.1 m",
        PngEncoding::Gsi => "gsi, steps of 0.01 m",
        PngEncoding::Terrarium | PngEncoding::Gray16 => "terrarium, steps of 1/256 m",
    };
    console.say(&format!(
        "written    {} (zooms {lowest} to {}, {count} tiles of {} pixels with {}, {name})",
        TileFormat::target(path).display(),
        tiles.zoom,
        tiles.side,
        size(bytes)
    ));
    if written.filled > 0 {
        console.say(&format!(
            "           {} pixels of zoom {} beyond the height map have heights continued from it, because map libraries \
             show no data as a hole; tiles without any height are left out",
            written.filled, tiles.zoom
        ));
    }
}
