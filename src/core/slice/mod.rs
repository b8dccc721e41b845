//! New contours: [`slice()`] traces levels on a surface. [`place_labels`] chooses where their elevations are written.

mod edge;
mod labels;
mod simplify;
mod trace;

pub use crate::subdomains::{ascends_right, signed_area};
pub use edge::Bends;
pub use labels::{Label, LabelParams, LabelledLines, STRAIGHT, label_layers, label_text, place_labels};
pub use simplify::Simplification;
pub(crate) use simplify::{simplified, window};
pub use trace::{Traced, slice};
pub(crate) use trace::{as_given, end_of_batch};
