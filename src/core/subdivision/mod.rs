//! The subdivision of a map (paper, sections 3.2 and 3.3): its contours, triangulated in the frame, and the sub-domains
//! between them, with lakes and the sea. Wrong labels are found here too, from the bands of the sub-domains.

mod constraints;
mod frame_heights;
mod known;
mod prepare;
mod soft_spots;
mod spots;
mod subdivide;
mod trusted;
mod water;

pub(crate) use prepare::{Prepared, prepare};
pub use subdivide::{Subdivision, subdivide, subdivide_with_water};
pub use water::{SAME_LEVEL, Water};
