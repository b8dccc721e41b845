//! The coordinate reference system, which goes from the input to each output.
//!
//! A system is named by an EPSG code, by well-known text (WKT 1, WKT 2 or Esri's flavour), or by both. A surface needs
//! plane coordinates, in the same unit as the heights. So [`working_crs`] finds a metric system for data in degrees or
//! feet, also for the plane of a drawing of which the unit alone is known ([`Crs::of_plane`]). [`Transform`] goes there
//! and back, and [`Reprojection`] keeps the original coordinates of the input's vertices, bit for bit.

mod definition;
mod esri;
mod local;
mod named;
#[cfg(feature = "io")]
mod parts;
mod proj_string;
mod reprojection;
mod system;
mod transform;
mod vertical;
mod wkt;
mod working;

pub(crate) use definition::label;
#[cfg(feature = "io")]
pub(crate) use parts::{number_of_part, part_of_table};
pub use reprojection::{FromWorking, Reprojection, ToWorking};
pub use system::{Crs, CrsKind, LengthUnit};
pub use transform::Transform;
pub(crate) use transform::converted;
#[cfg(feature = "io")]
pub(crate) use vertical::{epsg_name, vertical_unit};
pub use working::working_crs;
