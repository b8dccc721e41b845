//! Products of height maps: [`contour`] draws their contours, [`derive`](mod@derive) slopes, [`compare`] compares two of
//! them, [`join`] fills one from another.

pub mod compare;
pub mod contour;
pub mod derive;
pub mod join;
pub mod profile;
pub mod shade;
pub mod smooth;
pub mod volume;
