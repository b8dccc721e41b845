//! Cross-validation on hidden levels: the choice of hyper-parameters, and the expected error of the surface.

mod builder;
mod choose;
mod roughness;
mod trial;
mod uncertainty;

pub(crate) use builder::{SurfaceBuilder, TrialParams};
pub(crate) use choose::choose;
pub use choose::{Accuracy, Chosen, Reason};
pub(crate) use uncertainty::error_field;
pub use uncertainty::{ErrorField, ErrorGrid, ErrorModel, Provenance, line_error};
