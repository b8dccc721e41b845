//! Contours and heights on the grids of map tiles. Contours: for each zoom, fewer levels, fewer vertices, and whole numbers as
//! coordinates. No line touches another one there.
//!
//! Tile makers simplify each line alone and round afterwards. Both make contours of different levels cross. Here, all lines
//! of a zoom are simplified together, and each vertex is moved to the grid only if nothing is touched by that:
//!
//! 1. [`intervals()`]: which levels a zoom shows.
//! 2. [`Network::new`]: lines of one level that meet at their ends become one; places become units of the grid of the highest
//!    zoom.
//! 3. From the highest zoom to the lowest: [`Network::simplify`] leaves vertices out (`thin`), and [`Network::to_grid`] moves
//!    the others to the grid (`snap`). What comes out is the beginning of the next zoom. So lines keep their course from zoom to zoom.
//! 4. [`runs()`]: the parts of lines that a tile shows. Tiles take whole segments and cut none. So a line has the same vertices
//!    in all tiles that show it, and needs no rounding at their edges.
//!
//! [`zoom_heights`] has the heights of terrain tiles.
//!
//! A unit is a 4096th of a tile's side: an eighth of a pixel, as map libraries draw vector tiles.

mod cells;
mod chains;
mod heights;
mod intervals;
mod mercator;
mod moving;
mod network;
mod room;
mod runs;
mod snap;
mod thin;
mod zoom;

#[cfg(test)]
mod tests;

pub use heights::{ZoomHeights, zoom_heights};
pub use intervals::{ZoomInterval, given_intervals, intervals, is_shown, lowest_zoom};
pub use mercator::{HALF_WIDTH, TilePlace, WEB_MERCATOR, check_latitudes, check_meridian, tile_size, to_degrees};
pub use network::{LevelLine, LineOnGrid, Network};
pub use runs::{BUFFER, Run, runs};
pub(crate) use thin::kept_vertices;

/// Units of a tile's side.
pub const EXTENT: u32 = 4096;
