//! Countries: a map too large for one run is cut into tiles, and the results of the tiles are joined.
//!
//! 1. [`plan`](fn@plan) reads the map, takes the figures that depend on the whole map ([`Whole`](tokosen_core::surface::Whole)), cuts it into
//!    tiles, and writes a folder: a manifest, and the lines around each tile.
//! 2. [`work`](fn@work) computes one tile. It reads the files of this tile alone, and writes whole files only. So tasks run in any order,
//!    on any machine that sees the folder, and again after a failure.
//! 3. [`joined_lines`] and [`Mosaic`] put the results together.
//!
//! A tile is computed with a window around it, so wide that contours beyond it hardly change the surface in the tile. A new line is
//! cut where it leaves a tile. Both tiles at a seam compute the place, and the two places differ by less than the heights do. The
//! line goes through the middle between them.

mod beside;
mod bytes;
mod chains;
mod cut;
mod divide;
mod ends;
mod findings;
mod folder;
mod joined;
mod manifest;
mod mosaic;
mod pieces;
mod plan;
mod result;
mod squares;
mod stored;
mod window;
mod work;

pub use divide::STEP;
pub use folder::Folder;
pub use joined::{Joined, joined_lines};
pub use manifest::{Levels, Manifest, Task};
pub use mosaic::Mosaic;
pub use plan::{Plan, PlanParams, plan};
pub use work::{Work, work};
