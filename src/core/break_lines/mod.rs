//! Break lines: lines along which the ground bends sharply, such as the edges of ditches, embankments and terraces.
//!
//! The contours have priority. The steps:
//!
//! 1. A walk through the triangulation gives the contours that each line crosses and the sub-domains between
//!    ([`Course`](crate::subdomains)).
//! 2. On a contour, the line has the level of the contour. Between contours it has its own heights, kept inside the band
//!    of the sub-domain. Where it has none, equation (1) gives them.
//! 3. The smooth surface passes through heights that the line gives, and may bend sharply across the line. Where the line
//!    gives none, it follows the surface.
//!
//! Heights that contradict the contours, and pieces outside the frame or in water, are findings.

mod line;
mod settle;
mod spacing;

pub use line::{Bend, BreakLine, FittedBreakLine};
pub(crate) use settle::settle;
pub(crate) use spacing::spacing;
