//! Triangles of the smooth surface.

use super::tuned;

tuned! {
    /// Which nodes become vertices of the triangles for new contours and meshes. Height maps do not depend on them.
    NodeTuning {
        /// Least distance of a vertex from an edge that the triangulation must hold, in steps between nodes. Nearer
        /// ones make slivers.
        ///
        /// Refit: contours.
        clearance: f64 = 0.6,
        /// The same where the nodes are the cells that the contours were cut from. Their heights are known as well as
        /// the contours.
        ///
        /// Refit: contours, on contours that were cut from a raster.
        clearance_of_source: f64 = 0.1,
        /// Vertices per spacing that are enough.
        ///
        /// Refit: contours and time.
        vertices_per_spacing: f64 = 12.0,
        /// A node is left out where flat triangles between its neighbours are off by at most this share of the contour
        /// interval.
        ///
        /// Refit: contours and time.
        tolerance: f64 = 0.01,
    }
}
