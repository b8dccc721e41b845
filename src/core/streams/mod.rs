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
//! 7. Between contours, heights follow the smooth surface (`follow`). They are made to fall by isotonic regression on the
//!    network (`pool`).
//! 8. The banks of river areas get the heights of the streams between them (`areas`).
//! 9. On a grid, the cells along streams come near to the heights of the streams (`on_grid`).
//!
//! What was changed, cut or left out is a finding.

mod along;
mod areas;
mod beside;
mod chords;
mod climbs;
mod descend;
mod direction;
mod elsewhere;
mod fall;
mod follow;
mod line;
mod longest;
mod middle;
mod network;
mod on_grid;
mod parting;
mod pool;
mod profile;
mod settle;
mod shift;

pub(crate) use areas::banks;
pub(crate) use climbs::without_climbs;
pub(crate) use follow::follow;
pub use line::{RiverArea, Stream, StreamLine, Streams};
pub(crate) use on_grid::{AreaLevels, Ways};
pub(crate) use settle::settle;
