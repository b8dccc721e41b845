//! The type of spade's triangulation.

use spade::{ConstrainedDelaunayTriangulation, Point2};

/// A constrained Delaunay triangulation as spade builds it.
pub(super) type Cdt = ConstrainedDelaunayTriangulation<Point2<f64>>;
