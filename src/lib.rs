//! tokosen: terrain from contour lines.

pub mod contour;
pub mod crs;
pub mod dem;
pub mod error;
pub mod io;
pub mod preview;
pub mod progress;
pub mod skeleton;
pub mod slice;
pub mod surface;
pub mod tin;
