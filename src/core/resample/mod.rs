//! New vertices for contours (Zhang, Konno and Tokuyama 2005, section 3.1): smooth curves within a tolerance
//! ([`fit`](fn@fit)), and spacing as dense as nearby contours require ([`sample`](fn@sample)).

pub mod fit;
pub mod sample;

pub use fit::{FitParams, Fitted, fit};
pub use sample::{SampleParams, Sampled, sample};
