//! What the integration tests share: a check that lines do not cross, random terrain, and a contour tracer, a folder.
//!
//! Nothing here calls the product's own code, so that an error in it cannot hide itself.
#![allow(dead_code, unused_imports, reason = "every integration test uses its own part of this module")]

mod crossings;
mod distance;
mod draws;
mod folder;
mod random;
mod terrain;
mod tracer;

pub use crossings::{crossings, same_level_crossings};
pub use distance::Course;
pub use draws::draws;
pub use folder::Folder;
pub use random::Random;
pub use terrain::{
    Terrain, all_kinds, cliffs, fractal, hills, meanders, plane, plateaus, saddles, spiral_valley, volcano,
};
pub use tracer::{contours_of, traces_of};
