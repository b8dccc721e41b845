//! The coordinate reference system that travels from the input to every output.
//!
//! A system is named by an EPSG code, by well-known text (WKT 1, WKT 2 or Esri's flavour), or by both. Nothing may be
//! triangulated in degrees, nor sloped in feet, so [`working_crs`] finds a metric system for such data, [`Transform`]
//! goes there and back, and [`Reprojection`] remembers where the input's vertices were, bit for bit.

mod definition;
mod esri;
mod reprojection;
mod system;
mod transform;
mod wkt;
mod working;

pub use reprojection::{FromWorking, Reprojection, ToWorking};
pub use system::{Crs, CrsKind, LengthUnit};
pub use transform::Transform;
pub use working::working_crs;
