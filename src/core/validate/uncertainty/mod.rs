//! The expected error of a surface, place by place.
//!
//! * Every second level is hidden, and a surface is built from the others. Its residuals at the hidden contours depend
//!   on the distance between the contours on both sides ([`residuals`]).
//! * A model of these residuals is carried over to the map with all its levels ([`model`]).
//! * The model gives the error at the nodes of the working grid ([`field`]), from the distances to contours
//!   ([`sides`]).

mod field;
mod model;
mod residuals;
mod sides;

pub(crate) use field::error_field;
pub use field::{ErrorField, ErrorGrid, line_error};
pub use model::{ErrorModel, Provenance};
