//! How far the surface is expected to be off, place by place.
//!
//! Every second level is hidden, a surface drawn from the others, and its errors at the hidden contours are set against
//! the distance between the contours on both sides ([`residuals`]). What that teaches is carried over to the map with all
//! its levels ([`model`]) and laid on the nodes of the working grid ([`field`]), with the distances that [`sides`] finds.

mod field;
mod model;
mod residuals;
mod sides;

pub(crate) use field::error_field;
pub use field::{ErrorField, line_error};
pub use model::{ErrorModel, Provenance};
