//! Streams: lines along which water runs, brought into agreement with the contours.
//!
//! A map draws streams and contours separately, and the two never fit exactly. The contours have priority. The steps:
//!
//! 1. River areas that no stream runs through get middle lines (`middle`). All lines become a network of reaches between
//!    sources, confluences and outlets (`network`).
//! 2. A walk through the triangulation gives the contours that each reach crosses and the sub-domains between
//!    ([`Course`](crate::subdomains)).
//! 3. The contours, and the network where they are silent, give the direction of flow (`direction`). The direction in
//!    which a line was drawn does not count.
//! 4. A reach that crosses a contour beside the tip of its bend is moved into the tip (`shift`). Tip and crossing are
//!    matched by dynamic programming along the reach.
//! 5. A reach that crosses a contour more than once is moved along this contour, or cut (`descend`).
//! 6. Heights fall along each reach from crossing to crossing (`profile`), by monotone cubic interpolation (Fritsch and
//!    Carlson 1980, SIAM J. Numer. Anal. 17).
//! 7. Where contours are far, heights follow a surface and are made to fall (`follow`). On a grid, the cells along a
//!    stream get a shallow bed (`bed`), and are made to fall (`fall`) and to hold water that flows from cell to cell
//!    (`hold`).
//! 8. The banks of river areas get the heights of the streams between them (`areas`). On a grid, the cells of the areas are
//!    level across (`area_levels`).
//!
//! What was changed, cut or left out is a finding.

mod along;
mod area_levels;
mod areas;
mod bed;
mod beside;
mod chords;
mod descend;
mod direction;
mod fall;
mod follow;
mod hold;
mod hollows;
mod line;
mod middle;
mod network;
mod profile;
mod settle;
mod shift;

pub(crate) use area_levels::AreaLevels;
pub(crate) use areas::banks;
pub(crate) use bed::lower_beds;
pub(crate) use fall::{fall_along, raise_to};
pub(crate) use follow::follow;
pub(crate) use hold::hold_along;
pub(crate) use hollows::fill_hollows;
pub use line::{RiverArea, Stream, StreamLine, Streams};
pub(crate) use settle::settle;
