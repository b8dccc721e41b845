//! Map tiles in Web Mercator: contours as vector tiles, and heights as pictures.
//!
//! Tiles go into one of three things ([`TileFormat`]): a PMTiles archive, which a web server gives out in parts; an MBTiles
//! database; or a folder of files. The tiles are the same in each.
//!
//! Contours are drawn from the highest zoom to the lowest (`tokosen_core::tiles`), but archives begin with the lowest. So the
//! tiles of each zoom wait in a temporary file (`spool`) until all are made. Memory holds the lines of one
//! zoom, and a place for each tile.
//!
//! The format of PMTiles comes from the crate `pmtiles`, and protocol buffers from `quick-protobuf`. Of vector tiles only four
//! messages are needed (`mvt`); a crate for them brings seven others, and joins parts of lines that must stay apart.

mod archive;
mod beside;
mod contours;
mod format;
mod mvt;
mod spool;
mod terrain;

pub use beside::{TileSet, tile_sets};
pub use contours::{ContourTiles, WrittenTiles, ZoomSummary, write_contour_tiles};
pub use format::TileFormat;
pub(super) use format::{foreign_entry, is_own_folder, is_own_mbtiles, is_own_pmtiles};
pub use terrain::{
    HIGHEST_ZOOM, TerrainTiles, TerrainZoom, TileImage, WrittenTerrain, pixel_size, write_terrain_tiles,
};
