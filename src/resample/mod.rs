//! New vertices for contours: smooth curves within a tolerance ([`fit`](fn@fit)), and spacing as dense as the contours around ask
//! ([`sample`](fn@sample)); paper, section 3.1.

pub mod fit;
pub mod sample;

pub use fit::{FitParams, Fitted, fit};
pub use sample::{SampleParams, Sampled, sample};
