//! The triangulation ([`Tin`]), the sub-domains in it ([`Regions`](crate::subdomains::Regions)) and the kinds of its
//! triangles ([`TriangleKind`]).
//!
//! A [`Tin`] is a few flat arrays, built once and never changed: corner indices, neighbours and constraint flags per
//! triangle, position and height per vertex. Further data (sub-domain, kind) are flat arrays indexed by triangle.

mod blocks;
mod build;
mod faces;
mod input;
mod insertion;
mod kinds;
mod locate;
mod network;
mod refine;
mod split;

pub(crate) use build::crossing_edges;
pub use build::triangulate;
pub use input::TinInput;
pub use kinds::{TriangleKind, triangle_kinds};
pub(crate) use network::EDGE_FLAGS;
pub use network::{NONE, Tin, VertexKind};
pub use refine::{InnerPoint, PartedEdge};
pub use split::{Split, SplitPoint};
