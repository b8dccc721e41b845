//! Reads and writes DXF as text: polylines and lines with their elevations.
//!
//! A DXF is a list of groups, each a code and a value. Contours need about twelve of the codes. They are read and
//! written here, not with the `dxf` crate, for two reasons. The crate rounds coordinates to twelve decimals when it
//! writes, which does not preserve vertices bit for bit. It also builds every entity of the drawing in memory, and one
//! invalid value in an unused part makes it refuse the file.
//!
//! Elevations are z coordinates, and the `layer` is the only attribute. The format has no other attributes that
//! programs agree on, and no coordinate reference system. Other attributes of a layer of features are not written.

mod arc;
mod blocks;
mod copies;
mod drawing;
mod entity;
mod groups;
mod layers;
mod names;
mod output;
mod placement;
mod read;
mod tables;
mod unit;
mod write;

pub(super) use drawing::{Drawing, write_level};
pub(super) use read::read;
pub(super) use tables::Look;
pub(super) use unit::code_of as unit_code;
pub(super) use write::write;
