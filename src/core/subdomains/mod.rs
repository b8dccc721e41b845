//! The sub-domains between contours (paper, section 3.2): their bands, the frame around them, their nesting, and lakes.

mod barriers;
mod carried;
mod coast;
mod course;
mod extensions;
mod extent;
mod frame;
mod land;
mod landforms;
mod local;
mod orient;
mod outline;
mod regions;
mod touch;
mod waters;

pub use barriers::{GapEdges, close_gaps};
pub use carried::{CarriedRegions, loose_frame_edges};
pub(crate) use coast::{seas_with_contours, with_coast, with_open_sea};
pub(crate) use course::{Course, Crossing, Stretch, band_of, is_above};
pub use extensions::{FrameExtension, OpenEnd, extend_open_ends};
pub(crate) use extensions::{Sight, extensions_at};
#[doc(hidden)]
pub use extent::MapExtent;
pub use frame::{Frame, FrameRing, frame_ring};
pub use landforms::{Border, BorderKind, Landform, LandformClass, Mixture, Ring, landforms};
pub(crate) use local::local_bands;
pub use orient::{ascends_right, signed_area};
pub(crate) use orient::{line_at, line_starts, piece_of};
#[doc(hidden)]
pub use outline::settled;
pub use regions::{Band, Region, Regions, Side, regions};
pub use touch::agreeing_at_corners;
pub use waters::{contradicted_lakes, with_water};
