//! The coordinate reference system, which goes from the input to each output.
//!
//! A system is named by an EPSG code, by well-known text (WKT 1, WKT 2 or Esri's flavour), or by both. A surface needs
//! plane coordinates, in the same unit as the heights. So [`working_crs`] finds a metric system for data in degrees or
//! feet, also for the plane of a drawing of which the unit alone is known ([`Crs::of_plane`]). [`Transform`] goes there
//! and back, and [`Reprojection`] keeps the original coordinates of the input's vertices, bit for bit.

mod axes;
mod definition;
mod esri;
mod height_system;
mod local;
mod named;
mod originals;
mod parts;
mod proj_string;
mod projection_methods;
mod projjson;
mod reprojection;
mod system;
mod transform;
mod vertical;
mod wkt;
mod working;

#[doc(hidden)]
pub use axes::look_swapped;
#[doc(hidden)]
pub use definition::label;
#[doc(hidden)]
pub use height_system::vertical_unit;
pub use height_system::{HeightSystem, UsualDifference, mixed_heights};
#[doc(hidden)]
pub use parts::number_of_part;
#[doc(hidden)]
pub use parts::part_of_table;
pub use reprojection::{FromWorking, Reprojection, ToWorking};
pub use system::{Crs, CrsKind, LengthUnit};
pub use transform::Transform;
#[doc(hidden)]
pub use transform::converted;
#[doc(hidden)]
pub use vertical::epsg_name;
pub use working::working_crs;
