//! New contours: [`slice()`] traces levels on a surface. [`contour_layers`] makes map layers of them and of the input
//! contours. [`place_labels`] chooses where their elevations are written.

mod edge;
mod labels;
mod layer;
mod simplify;
mod target;
mod trace;

pub use crate::subdomains::{ascends_right, signed_area};
pub use edge::Bends;
pub use labels::{Label, LabelParams, LabelledLines, STRAIGHT, label_layers, label_text, place_labels};
pub(crate) use layer::is_index;
pub use layer::{LayerParams, SIMPLIFIED, contour_layers};
pub use simplify::Simplification;
pub(crate) use simplify::{simplified, window};
pub use target::Target;
pub(crate) use trace::end_of_batch;
pub use trace::{Traced, slice};
