//! DXF, as text: polylines and lines with their elevations in and out.
//!
//! A DXF is a list of groups, a code and a value each, of which contours need a dozen codes. They are read and written here,
//! because the crate for drawings rounds coordinates to twelve decimals when it writes, so that vertices do not come back
//! bit for bit, and builds every entity of the drawing in memory, where one odd value in a part that nobody asks for
//! refuses the file.
//!
//! Elevations are z coordinates and the `layer` is the only attribute: the format has no others that programs agree on, and no
//! coordinate reference system. What else a layer of features has is left out when it is written.

mod arc;
mod entity;
mod groups;
mod layers;
mod names;
mod output;
mod read;
mod tables;
mod write;

pub(super) use read::read;
pub(super) use write::write;
