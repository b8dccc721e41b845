//! The sub-domains between contours (paper, section 3.2): their bands, the frame around them, their nesting, and lakes.

mod frame;
mod gates;
mod kept;
mod landforms;
mod links;
mod local;
mod orient;
mod outline;
mod regions;
mod sheet;
mod touch;
mod waters;

pub use frame::{Frame, FrameRing, frame_ring};
pub use gates::{Gaps, close_gaps};
pub use kept::KeptBands;
pub use landforms::{Border, BorderKind, Landform, LandformClass, Mixture, Ring, landforms};
pub use links::{Link, OpenEnd, link_open_ends};
pub(crate) use links::{Sight, links_at};
pub use local::local_bands;
pub use orient::{ascends_right, signed_area};
pub(crate) use orient::{line_at, line_starts, piece_of};
pub use outline::Outline;
pub use regions::{Band, Region, Regions, Side, regions, sub_domains};
pub(crate) use sheet::Sheet;
pub use touch::agreeing_at_corners;
pub use waters::{contradicted_lakes, with_water};
