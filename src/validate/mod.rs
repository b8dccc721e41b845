//! What hidden levels tell: the hyper-parameters of the smooth surface and how far it may be off.

mod builder;
mod choose;
mod roughness;
mod trial;
mod uncertainty;

pub(crate) use builder::{SurfaceBuilder, TrialParams};
pub(crate) use choose::choose;
pub use choose::{Accuracy, Chosen, Reason};
pub(crate) use uncertainty::error_field;
pub use uncertainty::{ErrorField, ErrorModel, Provenance, line_error};
